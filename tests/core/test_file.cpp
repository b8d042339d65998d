// Output files are whole or absent; what cannot be read or written is told in one sentence.
#include <filesystem>
#include <fstream>

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/core/file.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

namespace {

fs::path freshFolder(const std::string& name) {
    const fs::path folder = fixture::temporaryFolder() / name;
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

size_t filesIn(const fs::path& folder) {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

TEST_CASE("bytes come back as they were written") {
    const fs::path folder = freshFolder("roundtrip");
    std::string bytes;
    for (int i = 0; i < 70'000; ++i) bytes += static_cast<char>(i * 7 % 256);
    for (const std::string& text : {std::string(), std::string("\0\r\n\0", 4), bytes}) {
        const std::string path = (folder / "file.bin").string();
        REQUIRE(writeWholeFile(path, text));
        const auto read = readWholeFile(path);
        REQUIRE(read);
        CHECK(*read == text);
        CHECK(fs::file_size(path) == text.size());
        CHECK(filesIn(folder) == 1);
    }
}

TEST_CASE("an existing file is replaced, its neighbours stay") {
    const fs::path folder = freshFolder("replace");
    REQUIRE(writeWholeFile((folder / "a").string(), "a long first text"));
    REQUIRE(writeWholeFile((folder / "b").string(), "other"));
    REQUIRE(writeWholeFile((folder / "a").string(), "short"));
    CHECK(*readWholeFile((folder / "a").string()) == "short");
    CHECK(*readWholeFile((folder / "b").string()) == "other");
    CHECK(filesIn(folder) == 2);
}

TEST_CASE("missing folders of the path are made") {
    const fs::path path = freshFolder("deep") / "one" / "two" / "file.txt";
    REQUIRE(writeWholeFile(path.string(), "text"));
    CHECK(*readWholeFile(path.string()) == "text");
}

TEST_CASE("a path that cannot be a file is refused with its name, and nothing is left behind") {
    const fs::path folder = freshFolder("refused");
    REQUIRE(writeWholeFile((folder / "plain").string(), "text"));
    for (const std::string& path : {(folder / "plain" / "below").string(), folder.string(), std::string("/proc/x")}) {
        INFO(path);
        const auto written = writeWholeFile(path, "text");
        REQUIRE(!written);
        CHECK(written.error().text.starts_with(path + ": "));
        CHECK(written.error().text.find('\n') == std::string::npos);
    }
    CHECK(!writeWholeFile("", "text"));
    CHECK(filesIn(folder) == 1);
    CHECK(*readWholeFile((folder / "plain").string()) == "text");
}

TEST_CASE("a write that stops half-way leaves the old file as it was") {
    const fs::path folder = freshFolder("full");
    const std::string path = (folder / "file").string();
    REQUIRE(writeWholeFile(path, "old"));
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit small{4096, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    const auto written = writeWholeFile(path, std::string(100'000, 'x'));
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    REQUIRE(!written);
    CHECK_THAT(written.error().text, ContainsSubstring("cannot be written"));
    CHECK(*readWholeFile(path) == "old");
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("what cannot be read is told with its path") {
    const fs::path folder = freshFolder("unreadable");
    const std::string huge = (folder / "huge").string(), fifo = (folder / "fifo").string();
    std::ofstream(huge).put('x');
    fs::resize_file(huge, (uintmax_t{1} << 30) + 1);
    REQUIRE(mkfifo(fifo.c_str(), 0600) == 0);
    const std::vector<std::pair<std::string, const char*>> cases = {{(folder / "missing").string(), "No such file"},
                                                                    {folder.string(), "is a folder"},
                                                                    {huge, "larger than 1 GiB"},
                                                                    {fifo, ""},
                                                                    {"/dev/zero", ""},
                                                                    {"", ""}};
    for (const auto& [path, why] : cases) {
        INFO(path);
        const auto read = readWholeFile(path);
        REQUIRE(!read);
        CHECK(read.error().text.starts_with(path + ": "));
        CHECK_THAT(read.error().text, ContainsSubstring(why));
    }
}
