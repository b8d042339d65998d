// Files that the program reads and writes: what is refused in one line, and what is never overwritten.
#include <sys/resource.h>

#include <functional>
#include <limits>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/core/file.h"
#include "tests/apps/program_call.h"

using namespace skinbench;
using namespace program;
using Catch::Matchers::ContainsSubstring;
using fixture::Gltf;
using fixture::json;
namespace fs = std::filesystem;

TEST_CASE("files that are no scene") {
    const std::vector<uint8_t> glb = fixture::small().asGlb();
    fixture::writeFile("empty.glb", {});
    fixture::writeFile("cut.glb", {glb.begin(), glb.begin() + 200});
    fixture::writeFile("noise.glb", {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13});
    fixture::writeText("notes.gltf", "dear diary\n");
    fixture::writeText("broken.gltf", "{\"asset\": {\"version\": \"2.0\"");
    fixture::writeText("scene.fbx", "Kaydara FBX Binary");
    fs::create_directories(pathOf("folder.glb"));
    const Words cpu = {"--routes", "cpu", "--copies", "1"};
    std::vector<BadCall> calls;
    for (const auto& [name, part] :
         std::vector<std::pair<std::string, const char*>>{{"missing.glb", "missing.glb: there is no such file"},
                                                          {"missing/deep.gltf", "there is no such file"},
                                                          {"folder.glb", "is a folder"},
                                                          {"empty.glb", "empty.glb: is empty"},
                                                          {"cut.glb", "cut.glb: "},
                                                          {"noise.glb", "noise.glb: is neither"},
                                                          {"notes.gltf", "notes.gltf: is neither"},
                                                          {"broken.gltf", "JSON is broken"},
                                                          {"scene.fbx", "scene.fbx"},
                                                          {"/dev/null", "null"},
                                                          {"", "the name of an input file is empty"},
                                                          {"builtin:", "builtin:"},
                                                          {"builtin:cat", "there is no built-in scene"},
                                                          {"builtin:biped:10", "from 2000 to 2000000"},
                                                          {"builtin:biped:0", "builtin:biped"},
                                                          {"builtin:biped:2000001", "from 2000 to 2000000"},
                                                          {"builtin:biped:99999999999999999999", "builtin:biped"},
                                                          {"builtin:biped:-2000", "builtin:biped"},
                                                          {"builtin:biped:many", "builtin:biped"},
                                                          {"builtin:biped:2000x", "builtin:biped"},
                                                          {"builtin:biped:", "builtin:biped"}}) {
        Words verify = {"verify", name};
        verify.insert(verify.end(), cpu.begin(), cpu.end());
        calls.push_back({verify, 2, part});
    }
    calls.push_back({{"scene", "export", "missing.glb", "y.glb"}, 2, "no such file"});
    calls.push_back({{"scene", "export", "cat", "y.glb"}, 2, "there is no built-in scene"});
    calls.push_back({{"scene", "export", "", "y.glb"}, 2, "the name of an input file is empty"});
    calls.push_back({{"partition", "missing.glb"}, 2, "no such file"});
    calls.push_back({{"render", "missing.glb", "--route", "vk", "-o", "y.png"}, 2, "no such file"});
    calls.push_back({{"reproduce", "torabi", "builtin:robot:2000", "missing.glb", "--out", "y"}, 2, "no such file"});
    calls.push_back({{"bench", "missing.glb", "--routes", "cpu", "--out", "y"}, 2, "no such file"});
    checkRefused(calls);
    for (const char* name : {"y.glb", "y.png", "y"}) CHECK(!fs::exists(pathOf(name)));
}

TEST_CASE("broken glTF files") {
    const std::vector<std::pair<const char*, std::function<void(Gltf&)>>> damages = {
        {"has no skin", [](Gltf& g) { g.tree["nodes"][0].erase("skin"); }},
        {"has no triangle", [](Gltf& g) { g.tree["meshes"][0]["primitives"] = json::array(); }},
        {"POSITION: vertex 1 is not finite",
         [](Gltf& g) { g.poke<float>(0, 4, std::numeric_limits<float>::quiet_NaN()); }},
        {"names joint 9, but skin 0 has 2 joints", [](Gltf& g) { g.poke<uint8_t>(3, 8, 9); }},
        {"index 3 names vertex 4", [](Gltf& g) { g.poke<uint16_t>(5, 3, 4); }},
        {"nodes form a cycle", [](Gltf& g) { g.tree["nodes"][2]["children"] = {1}; }},
        {"go past", [](Gltf& g) { g.tree["bufferViews"][0]["byteLength"] = 1'000'000; }},
        {"281474976710656 elements", [](Gltf& g) { g.tree["accessors"][0]["count"] = 281474976710656; }},
        {"POSITION has 4294967296",
         [](Gltf& g) {
             g.tree["accessors"][0]["count"] = 4294967296;
             g.tree["accessors"][0].erase("bufferView");
         }},
        {"has 2 components", [](Gltf& g) { g.tree["accessors"][0]["type"] = "VEC2"; }},
        {"unknown component type", [](Gltf& g) { g.tree["accessors"][0]["componentType"] = 5124; }},
        {"cannot hold indices", [](Gltf& g) { g.primitive()["attributes"]["JOINTS_0"] = 4; }},
        {"JOINTS_0 has no WEIGHTS_0", [](Gltf& g) { g.primitive()["attributes"].erase("WEIGHTS_0"); }},
        {"the key times do not ascend", [](Gltf& g) { g.poke<float>(7, 0, 2); }},
        {"buffer 0: missing.bin: there is no such file",
         [](Gltf& g) {
             g.tree["buffers"] = {{{"byteLength", 4}, {"uri", "missing.bin"}}};
         }},
        {"needs the extension", [](Gltf& g) { g.tree["extensionsRequired"] = {"FOO_bar"}; }},
    };
    for (const auto& [part, damage] : damages) {
        Gltf g = fixture::small();
        damage(g);
        fixture::writeText("bad.gltf", g.asText());
        INFO(part);
        checkRefused(call({"verify", "bad.gltf", "--routes", "cpu"}), 2, part);
    }
}

TEST_CASE("weights that are all zero are repaired with a warning") {
    Gltf g = fixture::small();
    for (size_t i = 0; i < 16; ++i) g.poke<float>(4, i, 0);
    fixture::writeText("weightless.gltf", g.asText());
    const Outcome verified = call({"verify", "weightless.gltf", "--routes", "cpu", "--copies", "2"});
    CHECK(verified.status == 0);
    CHECK_THAT(verified.err, ContainsSubstring("skinbench: warning: "));
    CHECK_THAT(verified.out, ContainsSubstring("cpu/cpu/"));
}

TEST_CASE("outputs that cannot be written") {
    fixture::writeText("plain", "x");
    const Words quick = {"bench", "builtin:robot:2000", "--routes", "cpu", "--preset", "quick", "--out"};
    for (const char* folder : {"plain/below", "/proc/x", "plain"}) {
        Words words = quick;
        words.push_back(folder);
        INFO(folder);
        checkRefused(call(words), 2, folder);
    }
    checkRefused({
        {{"scene", "export", "builtin:robot:2000", "plain/x.glb"}, 2, "plain/x.glb"},
        {{"scene", "export", "builtin:robot:2000", "/proc/x.glb"}, 2, "/proc/x.glb"},
        {{"scene", "export", "builtin:robot:2000", "."}, 2, "folder"},
        {{"render", "builtin:robot:2000", "--route", "cpu", "-o", "x.png"}, 1, "draws nothing"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--size", "64x64", "-o", "plain/x.png"}, 2, "plain/x.png"},
        {{"reproduce", "torabi", "builtin:robot:2000", "--out", "plain/below"}, 2, "plain/below"},
    });
    CHECK(*readWholeFile(pathOf("plain")) == "x");
    // Standard output on a full disk.
    for (const Words& words : {Words{"scene", "list"}, {"--help"}, {"--version"}, {"bench", "--help"}}) {
        const Outcome full = finish(start(words, {}, "/dev/full"));
        CHECK(full.status == 1);
        CHECK_THAT(full.err, ContainsSubstring("skinbench: standard output cannot be written"));
    }
}

namespace {

// The program where a file takes no more than `bytes`, as a full disk does.
Outcome callOnFullDisk(const Words& words, rlim_t bytes) {
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    const rlimit small{bytes, before.rlim_max};
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    const Running running = start(words);
    setrlimit(RLIMIT_FSIZE, &before);
    return finish(running);
}

}  // namespace

TEST_CASE("a disk that is full is a fault of the machine, and the files of a run before stay together") {
    const Words bench = {"bench", "builtin:robot:2000", "--routes", "cpu", "--preset", "quick", "--out", "room"};
    REQUIRE(call(bench).status == 0);
    std::vector<std::string> before;
    const std::vector<std::string> names = {"room/results.json", "room/results.csv", "room/report.html"};
    for (const std::string& name : names) before.push_back(*readWholeFile(pathOf(name)));
    REQUIRE(before[1].size() < 4096);
    // A software driver's own memory is a file, so it draws on a disk with room.
    const Words render = {"render", "builtin:robot:2000", "--route", "vk", "--size", "64x64", "-o", "/dev/full"};
    for (const Words& words : {bench,
                               render,
                               {"report", "room", "-o", "room/page.html"},
                               {"scene", "export", "builtin:robot:2000", "room/x.glb"}}) {
        const bool whole = words == render;
        const Outcome full = whole ? call(words) : callOnFullDisk(words, 4096);
        INFO(words[0] << ": " << full.err);
        if (full.err.contains("Vulkan: ")) continue;
        CHECK(full.status == 1);
        CHECK_THAT(full.err, ContainsSubstring(std::string("cannot be written: ") +
                                               (whole ? "No space left on device" : "File too large")));
    }
    for (size_t i = 0; i < names.size(); ++i) CHECK(*readWholeFile(pathOf(names[i])) == before[i]);
    for (const char* name : {"room/page.html", "room/x.glb"}) CHECK(!fs::exists(pathOf(name)));
    for (const auto& entry : fs::directory_iterator(pathOf("room"))) CHECK(entry.path().extension() != ".part");
}

TEST_CASE("outputs that would replace what is no file of their kind") {
    REQUIRE(call({"bench", "builtin:robot:2000", "--routes", "cpu", "--preset", "quick", "--out", "kinds"}).status ==
            0);
    const std::string results = "kinds/results.json";
    const std::string before = readWholeFile(pathOf(results)).value_or("none");
    fs::copy_file(pathOf(results), pathOf("kinds/page.html"));
    fs::create_symlink("results.json", pathOf("kinds/link.html"));
    checkRefused({
        {{"report", results, "-o", results}, 2, "is no .json file"},
        {{"report", results, "-o", "new.json"}, 2, "is no .json file"},
        {{"report", "kinds/page.html", "-o", "kinds/page.html"}, 2, "is an input"},
        {{"report", results, "-o", "kinds/link.html"}, 2, "is an input"},
        {{"render", "builtin:robot:2000", "--route", "vk", "-o", "x.glb"}, 2, "is no .glb file"},
    });
    CHECK(readWholeFile(pathOf(results)).value_or("") == before);
    CHECK(!fs::exists(pathOf("new.json")));
    CHECK(call({"report", results, "-o", "/dev/null"}).status == 0);
    CHECK(call({"report", results, "-o", "page.HTML"}).status == 0);
    CHECK(fs::is_character_file("/dev/null"));
    const Outcome page = call({"report", results, "-o", "/dev/stdout"});
    CHECK(page.status == 0);
    CHECK(page.out.starts_with("<!doctype html>"));
    fs::create_directories(pathOf("planted"));
    fs::create_symlink(pathOf("victim"), pathOf("planted/results.json"));
    checkRefused({{{"bench", "builtin:robot:2000", "--routes", "cpu", "--out", "planted"}, 2, "no regular file"}});
    CHECK(!fs::exists(pathOf("victim")));
}

TEST_CASE("names that are not UTF-8 lose nothing, and messages stay one line") {
    const std::string odd = "caf\xE9\n\x1b[31m.glb";
    REQUIRE(call({"scene", "export", "builtin:robot:2000", odd}).status == 0);
    for (const Words& words : {Words{"verify", odd, "--routes", "cpu", "--copies", "1", "--json", "--out", "odd"},
                               {"inspect", odd, "--json"},
                               {"partition", odd, "--json"}}) {
        const Outcome outcome = call(words);
        INFO(words[0] << ": " << outcome.err);
        CHECK(outcome.status == 0);
        CHECK(json::parse(outcome.out, nullptr, false).is_object());
    }
    const Outcome missing = call({"verify", std::string(3'000, 'x') + "\nskinbench: all is well"});
    CHECK(missing.status == 2);
    REQUIRE(linesOf(missing.err).size() == 1);
    CHECK(missing.err.size() <= 610);
    CHECK_THAT(missing.err, ContainsSubstring("\\nskinbench: all is well"));
}

TEST_CASE("files that are no results") {
    fixture::writeText("empty.json", "");
    fixture::writeText("broken.json", "{\"schema\": ");
    fixture::writeText("other.json", "{\"schema\": 1}");
    fixture::writeText("bare.json", "{\"schema\": \"skinbench-results/1\", \"cases\": []}");
    const std::string wrong = R"({"schema": "skinbench-results/1", "tool": {}, "host": {}, "devices": [5], "scene": {},
        "settings": {}, "cases": [{"id": 1, "route": 2, "variant": 3, "status": 4, "reason": 5, "raster": 6,
        "gpu_ms": 7, "passes_ms": 8, "memory_bytes": 9, "accuracy": 10}]})";
    fixture::writeText("wrong.json", wrong);
    fixture::writeText("plain", "x");
    checkRefused({
        {{"report", "missing.json"}, 2, "missing.json"},
        {{"report", ""}, 2, "the name of an input file is empty"},
        {{"report", "/usr"}, 2, "/usr: is a folder without a results.json"},
        {{"report", "empty.json"}, 2, "is not JSON"},
        {{"report", "broken.json"}, 2, "is not JSON"},
        {{"report", "other.json"}, 2, "schema"},
        {{"report", "bare.json"}, 2, "bare.json: is not a whole result file"},
        {{"report", "wrong.json"}, 2, "wrong.json: is not a whole result file"},
        {{"compare", "missing.json", "missing.json"}, 2, "missing.json"},
        {{"compare", "wrong.json", "empty.json"}, 2, "wrong.json: is not a whole result file"},
    });
    CHECK(!fs::exists(pathOf("report.html")));
}

TEST_CASE("shaders that are not there") {
    const Words wrong = {"SKINBENCH_SHADERS=/nonexistent"};
    const Outcome outcome = call({"verify", "builtin:robot:2000", "--routes", "cpu"}, wrong);
    INFO(outcome.err);
    CHECK(outcome.status != 0);
    CHECK_THAT(outcome.err, ContainsSubstring("/nonexistent"));
    CHECK(linesOf(outcome.err).size() == 1);
}

TEST_CASE("a picture that is not right is drawn with a warning, and verify fails it") {
    const std::string folder = pathOf("wrong_shaders");
    fs::remove_all(folder);
    fs::copy(SKINBENCH_SOURCE_DIR "/shaders_glsl", folder, fs::copy_options::recursive);
    const std::string file = folder + "/skin.glsl";
    std::string text = *readWholeFile(file);
    const std::string right = "if (weight > 1e-7)";
    REQUIRE(text.contains(right));
    text.replace(text.find(right), right.size(), "if (weight > 0.3)");
    REQUIRE(writeWholeFile(file, text));
    const Words wrong = {"SKINBENCH_SHADERS=" + folder};
    const Outcome drawn =
        call({"render", "builtin:biped:2000", "--case", "vk/vertex/uc", "--size", "64x64", "-o", "wrong.png"}, wrong);
    INFO(drawn.err);
    if (drawn.err.contains("Vulkan: ")) SKIP("no Vulkan driver on this machine");
    CHECK(drawn.status == 0);
    CHECK_THAT(drawn.err, ContainsSubstring("warning: vk/vertex/uc is drawn, and is not right: positions are off by "));
    CHECK(fs::exists(pathOf("wrong.png")));
    const Outcome verified = call({"verify", "builtin:biped:2000", "--case", "vk/vertex/uc", "--size", "64x64"}, wrong);
    CHECK(verified.status == 1);
    CHECK_THAT(verified.err, ContainsSubstring("1 of 1 case failed; the first, vk/vertex/uc: positions are off by "));
}

TEST_CASE("a shader that is missing, or a folder in its place, is one line that names it") {
    const std::string folder = pathOf("few_shaders");
    fs::remove_all(folder);
    fs::copy(SKINBENCH_SOURCE_DIR "/shaders_glsl", folder, fs::copy_options::recursive);
    for (const bool asFolder : {false, true}) {
        fs::remove(folder + "/vertex.glsl");
        if (asFolder) fs::create_directory(folder + "/vertex.glsl");
        const Outcome drawn =
            call({"render", "builtin:robot:2000", "--case", "vk/vertex/uc", "--size", "64x64", "-o", "few.png"},
                 {"SKINBENCH_SHADERS=" + folder});
        INFO(drawn.err);
        if (drawn.err.contains("Vulkan: ")) SKIP("no Vulkan driver on this machine");
        CHECK(drawn.status == 1);
        CHECK_THAT(drawn.err, ContainsSubstring("vertex.glsl"));
        CHECK(linesOf(drawn.err).size() == 1);
    }
    const Outcome verified = call({"verify", "builtin:robot:2000", "--case", "vk/vertex/uc", "--case", "vk/compute/uc"},
                                  {"SKINBENCH_SHADERS=" + folder});
    CHECK(verified.status == 1);
    CHECK_THAT(verified.err, ContainsSubstring("1 of 2 cases failed; the first, vk/vertex/uc: shader vertex.glsl"));
}
