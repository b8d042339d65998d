// Where buffers may lie.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/scene/gltf/gltf_uri.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

// A folder with "tube.bin", "sub/a b.bin", and beside it "outside.bin".
struct UriFolder {
    fs::path outer = fixture::temporaryFolder() / "uris", inner = outer / "model";
    UriFolder() {
        fs::create_directories(inner / "sub");
        const auto bytes = fixture::small().bin;
        for (const fs::path& file : {inner / "tube.bin", inner / "sub" / "a b.bin", outer / "outside.bin"})
            std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    std::string refusal(const std::string& uri) const {
        const auto path = resolveUri(uri, inner);
        return path ? std::string() : path.error().text;
    }
};

std::string loadError(const UriFolder& folder, const std::string& uri) {
    fixture::Gltf g = fixture::small();
    g.tree["buffers"] = {{{"byteLength", g.bin.size()}, {"uri", uri}}};
    std::ofstream(folder.inner / "m.gltf") << g.asText();
    const auto scene = loadGltf((folder.inner / "m.gltf").string());
    return scene ? std::string() : scene.error().text;
}

}  // namespace

TEST_CASE("files at and below the glTF file's folder are read") {
    const UriFolder folder;
    for (const char* uri :
         {"tube.bin", "./tube.bin", "sub/a b.bin", "sub/a%20b.bin", "sub\\a b.bin", "sub/./a b.bin"}) {
        INFO(uri);
        CHECK(loadError(folder, uri).empty());
    }
    CHECK(resolveUri("./tube.bin", folder.inner).value() == resolveUri("tube.bin", folder.inner).value());
}

TEST_CASE("what leaves the folder is refused with the reason") {
    const UriFolder folder;
    for (const char* uri : {"../outside.bin", "%2e%2e/outside.bin", ".%2E/outside.bin", "..\\outside.bin",
                            "sub/../tube.bin", "sub%2f..%2f..%2foutside.bin", "..%5coutside.bin"}) {
        INFO(uri);
        CHECK_THAT(folder.refusal(uri), ContainsSubstring("holds \"..\""));
    }
    for (const char* uri : {"/etc/hostname", "%2Fetc/hostname", "\\etc\\hostname", "C:\\tube.bin", "c:tube.bin"}) {
        INFO(uri);
        CHECK_THAT(folder.refusal(uri), ContainsSubstring("is absolute"));
    }
    for (const char* uri : {"http://x/y.bin", "file:///etc/hostname", "FILE:tube.bin", "ftp:x"}) {
        INFO(uri);
        CHECK_THAT(folder.refusal(uri), ContainsSubstring("is no path of a local file"));
    }
    CHECK_THAT(folder.refusal(""), ContainsSubstring("is no path"));
    CHECK_THAT(folder.refusal("tube.bin%00"), ContainsSubstring("is no path"));
    CHECK_THAT(folder.refusal("none.bin"), ContainsSubstring("none.bin: there is no such file"));
    CHECK_THAT(loadError(folder, "../outside.bin"), ContainsSubstring("m.gltf: "));
}

TEST_CASE("links are followed within the folder only") {
    const UriFolder folder;
    fs::remove(folder.inner / "in.bin");
    fs::remove(folder.inner / "out.bin");
    fs::create_symlink("tube.bin", folder.inner / "in.bin");
    fs::create_symlink("../outside.bin", folder.inner / "out.bin");
    CHECK(loadError(folder, "in.bin").empty());
    CHECK_THAT(loadError(folder, "out.bin"), ContainsSubstring("is a link that leaves the glTF file's folder"));
}

TEST_CASE("data URIs in upper case are read") {
    const std::string data = fixture::base64(fixture::small().bin);
    const UriFolder folder;
    CHECK(loadError(folder, "DATA:application/octet-stream;BASE64," + data).empty());
    CHECK(loadError(folder, "data:;base64," + data).empty());
}

TEST_CASE("a Git LFS pointer is named as one") {
    const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n";
    const std::string path = fixture::writeText("pointer.glb", pointer);
    const auto scene = loadGltf(path);
    REQUIRE_FALSE(scene);
    CHECK(scene.error().text == path + ": is a Git LFS pointer, not the file itself; fetch it with git lfs pull");
    const UriFolder folder;
    std::ofstream(folder.inner / "lfs.bin") << pointer;
    CHECK_THAT(loadError(folder, "lfs.bin"), ContainsSubstring("lfs.bin: is a Git LFS pointer"));
}

TEST_CASE("a file name that is not UTF-8 becomes valid text") {
    const auto good = loadGltf(fixture::writeFile("caf\xE9.glb", fixture::small().asGlb()));
    REQUIRE(good);
    CHECK(good->name == "caf\xEF\xBF\xBD");
    const auto bad = loadGltf((fixture::temporaryFolder() / "n\xFF.glb").string());
    REQUIRE_FALSE(bad);
    CHECK(bad.error().text.ends_with("/n\xEF\xBF\xBD.glb: there is no such file"));
}

TEST_CASE("JSON that is not UTF-8 is named as such with its place") {
    std::string text = fixture::small().asText();
    const size_t place = text.find("bend");
    text[place + 1] = '\xE9';
    const auto scene = loadGltf(fixture::writeText("latin1.gltf", text));
    REQUIRE_FALSE(scene);
    CHECK_THAT(scene.error().text,
               ContainsSubstring("its JSON is not UTF-8: byte " + std::to_string(place + 1) + " of it, 0xe9"));
}
