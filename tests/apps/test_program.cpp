// The program as a user calls it: exit statuses, what goes to which stream, files.
#include <format>
#include <functional>
#include <limits>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/cases/axes.h"
#include "common/core/file.h"
#include "common/scene/scene.h"
#include "tests/apps/program_call.h"

using namespace skinbench;
using namespace program;
using Catch::Matchers::ContainsSubstring;
using fixture::Gltf;
using fixture::json;
namespace fs = std::filesystem;

namespace {

struct BadCall {
    Words words;
    int status;
    const char* part;  // of the message
};

void checkRefused(const std::vector<BadCall>& calls) {
    for (const BadCall& bad : calls) {
        std::string line;
        for (const std::string& word : bad.words) line += " " + word;
        INFO("skinbench" << line);
        checkRefused(call(bad.words), bad.status, bad.part);
    }
}

}  // namespace

TEST_CASE("version and help") {
    const Outcome version = call({"--version"});
    CHECK(version.status == 0);
    CHECK(linesOf(version.out).size() == 1);
    CHECK(version.err == "");
    for (const Words& words : {Words{"--help"},
                               {"bench", "--help"},
                               {"verify", "-h"},
                               {"probe", "--help"},
                               {"render", "--help"},
                               {"partition", "--help"},
                               {"report", "--help"},
                               {"reproduce", "--help"},
                               {"compare", "--help"},
                               {"scene", "--help"}}) {
        const Outcome help = call(words);
        CHECK(help.status == 0);
        CHECK(help.err == "");
        CHECK_THAT(help.out, ContainsSubstring("skinbench"));
        CHECK_THAT(help.out, ContainsSubstring("--help"));
    }
}

TEST_CASE("the presets of the help page are those of the docs") {
    const std::string help = call({"bench", "--help"}).out;
    const std::string docs = readWholeFile(SKINBENCH_SOURCE_DIR "/docs/method.md").value_or("");
    const size_t begin = help.find("  preset "), end = help.find("\n\n", begin);
    REQUIRE(end != std::string::npos);
    CHECK_THAT(docs, ContainsSubstring("```\n" + help.substr(begin, end - begin) + "\n```\n"));
    CHECK_THAT(help, ContainsSubstring("\n  of its own limit  "));
}

TEST_CASE("a wrong word gets the nearest right one and the page that has it") {
    checkRefused({
        {{"bench", "--copis", "4"}, 2, "no option --copis; did you mean --copies? See skinbench bench --help"},
        {{"verify", "--variant=mesh"}, 2, "no option --variant=mesh; did you mean --variants? See skinbench verify"},
        {{"benhc"}, 2, "no subcommand 'benhc'; did you mean bench? See skinbench --help"},
        {{"dance"}, 2, "no subcommand 'dance'; there is probe, bench, verify"},
        {{"scene", "lst"}, 2, "no subcommand 'lst'; did you mean list? See skinbench scene --help"},
        {{"bench", "--xyzzy"}, 2, "no option --xyzzy; see skinbench bench --help"},
        {{"bench", "--copies", "0"}, 2, "--copies: '0' is not a number from 1 to 1000000; see skinbench bench --help"},
        {{"bench", "--shape", "odd"}, 2, "--shape: no 'odd'; there is given, auto"},
        {{"bench", "--warmup"}, 2, "--warmup needs a value; see skinbench bench --help"},
        {{"bench", "--size", "5"}, 2, "--size '5' is not two numbers, as in 640x480"},
        {{"bench", "a.glb", "b.glb"}, 2, "'b.glb' is one word too many; see skinbench bench --help"},
        {{"bench", "--baseline", "mash"}, 2, "--baseline 'mash' is neither a variant (none, vertex"},
        {{"bench", "--routes", "vk", "--baseline", "gl/vertex/uc"}, 2, "gl/vertex/uc is not among the cases"},
        {{"verify", "./no/../such.glb", "--routes", "cpu"}, 2, "skinbench: ./no/../such.glb: there is no such file"},
    });
}

TEST_CASE("a list prints the cases, what would be skipped, and what no case can have") {
    const Words words = {"bench",           "--routes", "cpu,vk,gl", "--variants",
                         "vertex,cpu,mesh", "--cull",   "compact",   "--list"};
    const Outcome list = call(words);
    CHECK(list.status == 0);
    CHECK(list.out.starts_with("cpu/cpu/uc\n"));
    CHECK_THAT(list.out, ContainsSubstring("\nvk/vertex/uc+pull"));
    CHECK_THAT(list.out, ContainsSubstring("--variants  skipped: mesh needs vk-ext, vk-nv, gl-ext or gl-nv\n"));
    CHECK_THAT(list.out, ContainsSubstring("--cull  skipped: --cull needs vk-ext, vk-nv, gl-ext or gl-nv\n"));
    CHECK_THAT(list.err, ContainsSubstring("skinbench: 7 cases, "));
    Words asJson = words;
    asJson.push_back("--json");
    const json found = json::parse(call(asJson).out, nullptr, false);
    REQUIRE(found.is_object());
    CHECK(found["cases"].size() == 7);
    CHECK(found["unused"][0]["words"] == json{"mesh"});
    CHECK(!fs::exists(pathOf("results")));
}

TEST_CASE("shells complete subcommands, options and the values of the axes") {
    for (const char* shell : {"bash", "zsh", "fish"}) {
        const Outcome script = call({"completion", shell});
        CHECK(script.status == 0);
        CHECK(script.err == "");
        INFO(shell);
        for (const Axis& axis : axes()) {
            if (!axis.benched) continue;
            std::string words;
            for (const std::string& word : axis.words) words += (words.empty() ? "" : " ") + word;
            CHECK_THAT(script.out, ContainsSubstring(axis.option.name));
            CHECK_THAT(script.out, ContainsSubstring(words));
        }
        if (std::string(shell) == "bash") fixture::writeText("skinbench.bash", script.out);
    }
    // As bash asks: the words before the cursor, and the one that it is in.
    const auto completed = [](const std::string& words) {
        const std::string ask =
            ". ./skinbench.bash; COMP_WORDS=(" + words +
            "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _skinbench; printf '%s ' \"${COMPREPLY[@]}\"";
        const Outcome outcome = finish(start({"-c", ask}, {}, "", "/bin/bash"));
        CHECK(outcome.err == "");
        return outcome.out;
    };
    CHECK(completed("skinbench be") == "bench ");
    CHECK(completed("skinbench bench --routes vk,g") == "vk,gl vk,gl-ext vk,gl-nv ");
    CHECK(completed("skinbench render --method = d") == "dqs ");
    CHECK(completed("skinbench render x.glb --meth") == "--method ");
    CHECK(completed("skinbench partition --ord") == "--order ");
    checkRefused(call({"completion", "tcsh"}), 2, "no shell 'tcsh'; there is bash, zsh, fish");
}

TEST_CASE("words that do not exist") {
    checkRefused({
        {{}, 2, "subcommand"},
        {{"dance"}, 2, "dance"},
        {{"bench", "--dance"}, 2, "--dance"},
        {{"probe", "extra"}, 2, "extra"},
        {{"bench", "a.glb", "b.glb"}, 2, "b.glb"},
        {{"bench", "--routes", "dx"}, 2, "no route 'dx'; there is vk, vk-ext"},
        {{"bench", "--routes", "vk,dx"}, 2, "no route 'dx'"},
        {{"bench", "--routes", ""}, 2, "route"},
        {{"bench", "--routes"}, 2, "--routes"},
        {{"bench", "--variants", "dual"}, 2, "no variant 'dual'; there is none, vertex"},
        {{"bench", "--codecs", "zip"}, 2, "no codec 'zip'; there is uc"},
        {{"bench", "--builders", "best"}, 2, "no builder 'best'; there is meshopt, scan"},
        {{"bench", "--layouts", "loose"}, 2, "no layout 'loose'"},
        {{"bench", "--raster", "half"}, 2, "no raster mode 'half'; there is full"},
        {{"bench", "--vertex-fetch", "push"}, 2, "no vertex fetch 'push'"},
        {{"bench", "--submission", "never"}, 2, "no submission 'never'"},
        {{"bench", "--index-writes", "none"}, 2, "no index write 'none'"},
        {{"bench", "--preset", "huge"}, 2, "no preset 'huge'; there is quick"},
        {{"bench", "--pose", "t"}, 2, "no pose 't'; there is frozen, animated"},
        {{"bench", "--geometry", "round"}, 2, "no geometry 'round'; there is welded"},
        {{"bench", "builtin:robot:2000", "--routes", "cpu", "--out", "c", "--clip", "jump"},
         2,
         "no clip 'jump'; there"},
        {{"verify", "--routes", "vk-ext", "--variants", "vertex"}, 2, "none of these variants exists"},
        {{"verify", "--routes", "cpu", "--variants", "mesh,vertex"}, 2, "none of these variants exists"},
        {{"render", "builtin:robot:2000", "--view", "x-ray", "-o", "x.png"}, 2, "no view 'x-ray'; there is shaded"},
        {{"render", "builtin:robot:2000", "--route", "dx", "-o", "x.png"}, 2, "no route 'dx'"},
        {{"render", "builtin:robot:2000", "--animate", "4", "-o", "x.png"}, 2, "--animate writes a .webp file"},
        {{"bench", "--camera", "half", "--character-pixels", "50"}, 2, "of camera crowd, not of half"},
        {{"bench", "--character-pixels", "0"}, 2, "--character-pixels"},
        {{"bench", "--cluster-cull", "some"}, 2, "no culling of meshlets 'some'; there is off, task, list"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--variant", "mesh", "-o", "x.png"},
         2,
         "none of these variants exists on these routes: mesh needs vk-ext, vk-nv, gl-ext or gl-nv"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--view", "meshlets", "-o", "x.png"},
         2,
         "needs a mesh route"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--variant", "compute", "--view", "velocity", "-o", "x.png"},
         2,
         "view velocity needs --variant compute --compute previous"},
        {{"render", "builtin:robot:2000", "--route", "vk-ext", "--variant", "mesh", "--view", "culled", "-o", "x.png"},
         2,
         "view culled needs a case that culls; add --cluster-cull or --cull"},
        {{"render", "builtin:robot:2000", "--route", "gl", "--view", "culled", "-o", "x.png"},
         2,
         "view culled needs a variant that culls, not vertex: compute-cull, or mesh"},
        {{"render", "builtin:robot:2000", "--case", "vk-ext/mesh/uc/meshopt/redirect+cull-compact+prepass+view-culled",
          "-o", "x.png"},
         2,
         "view culled shows no pre-pass"},
        {{"bench", "builtin:robot:2000", "--case", "vk/vertex/uc+view-normals", "--out", ""},
         2,
         "vk/vertex/uc+view-normals: what is measured is the usual view, shaded; leave out view-normals"},
        {{"render", "builtin:robot:2000", "--case", "vk/compute-cull/uc+no-tests+view-culled", "-o", "x.png"},
         2,
         "leave out --triangle-tests none"},
        {{"verify", "--variants", "palette", "--palette-slots", "0"},
         2,
         "--palette-slots '0' is not a number from 1 to 65535"},
        {{"verify", "--compute", "staged+fast"}, 2, "no compute option 'fast'; there is plain, staged, previous"},
        {{"verify", "--compute", "plain+staged"}, 2, "no compute option 'plain'"},
        {{"verify", "--compute", "staged++packed"}, 2, "no compute option ''"},
        {{"render", "builtin:robot:2000"}, 2, "--output"},
        {{"render", "-o", "x.png"}, 2, "scene"},
        {{"scene"}, 2, "subcommand"},
        {{"scene", "export", "robot"}, 2, "out"},
        {{"scene", "delete"}, 2, "delete"},
        {{"partition"}, 2, "scene"},
        {{"partition", "builtin:robot:2000", "--hardware", "abacus"}, 2, "no hardware 'abacus'; there is generic"},
        {{"partition", "builtin:robot:2000", "--solver", "exact"}, 2, "no solver 'exact'; there is simple, cheapest"},
        {{"partition", "builtin:robot:2000", "--order", "best"}, 2, "no order 'best'; there is given, size, lexico"},
        {{"partition", "builtin:robot:2000", "--hardware", "vs1", "--slots", "9"}, 2, "vs1 has 28"},
        {{"report"}, 2, "files"},
        {{"reproduce"}, 2, "thesis"},
        {{"reproduce", "knuth"}, 2, "no thesis 'knuth'; there is torabi, kimmersdorfer"},
        {{"reproduce", "torabi", "--routes", "vk,dx"}, 2, "no route 'dx'; there is vk"},
        {{"reproduce", "kimmersdorfer", "--routes", "cpu"}, 2, "none of these variants exists"},
        {{"compare"}, 2, "A"},
        {{"compare", "a.json"}, 2, "a second file, B, or --pair AXIS"},
        {{"compare", "a.json", "b.json", "c.json"}, 2, "c.json"},
        {{"compare", "a.json", "b.json", "--fail-above"}, 2, "--fail-above"},
        {{"compare", "a.json", "b.json", "--fail-above", "much"}, 2, "--fail-above"},
        {{"compare", "a.json", "b.json", "--fail-above", "-1"}, 2, "--fail-above"},
        {{"compare", "a.json", "b.json", "--fail-above", "nan"}, 2, "--fail-above"},
    });
    CHECK(!fs::exists(pathOf("results")));
}

TEST_CASE("bad numbers") {
    checkRefused({
        {{"bench", "--copies", "0"}, 2, "--copies"},
        {{"bench", "--copies", "-1"}, 2, "--copies"},
        {{"bench", "--copies", "many"}, 2, "--copies"},
        {{"bench", "--copies", "2.5"}, 2, "--copies"},
        {{"bench", "--copies", "99999999999999999999"}, 2, "--copies"},
        {{"bench", "--frames", "0"}, 2, "--frames"},
        {{"bench", "--frames", "-3"}, 2, "--frames"},
        {{"bench", "--frames", "x"}, 2, "--frames"},
        {{"bench", "--frames", "4294967297"}, 2, "--frames"},
        {{"bench", "--warmup", "-1"}, 2, "--warmup"},
        {{"bench", "--warmup", "4294967296"}, 2, "--warmup"},
        {{"bench", "--rounds", "0"}, 2, "--rounds"},
        {{"bench", "--rounds", "1e9"}, 2, "--rounds"},
        {{"bench", "--seed", "one"}, 2, "--seed"},
        {{"bench", "--seed", "-1"}, 2, "--seed"},
        {{"bench", "--time", "-1"}, 2, "--time"},
        {{"bench", "--time", "noon"}, 2, "--time"},
        {{"bench", "--time", "nan"}, 2, "--time"},
        {{"bench", "--tolerance", "0"}, 2, "--tolerance"},
        {{"bench", "--tolerance", "-1e-6"}, 2, "--tolerance"},
        {{"bench", "--tolerance", "nan"}, 2, "--tolerance"},
        {{"bench", "--tolerance", "small"}, 2, "--tolerance"},
        {{"bench", "--influences", "5"}, 2, "no influences '5'; there is 4, 8"},
        {{"bench", "--influences", "four"}, 2, "no influences 'four'"},
        {{"bench", "--group-size", "0"}, 2, "--group-size '0' is not a number from 1 to 1024"},
        {{"bench", "--group-size", "1025"}, 2, "--group-size"},
        {{"bench", "--group-size", "-32"}, 2, "--group-size"},
        {{"bench", "--meshlets", "64"}, 2, "meshlet limits '64'"},
        {{"bench", "--meshlets", "64/"}, 2, "meshlet limits"},
        {{"bench", "--meshlets", "0/124"}, 2, "meshlet limits"},
        {{"bench", "--meshlets", "2/124"}, 2, "must lie between"},
        {{"bench", "--meshlets", "64/3"}, 2, "must lie between"},
        {{"bench", "--meshlets", "256/124"}, 2, "must lie between"},
        {{"bench", "--meshlets", "64/513"}, 2, "meshlet limits"},
        {{"bench", "--meshlets", "64/124/3"}, 2, "meshlet limits"},
        {{"bench", "--meshlets", "-64/124"}, 2, "meshlet limits"},
        {{"bench", "--size", "1920"}, 2, "size '1920'"},
        {{"bench", "--size", "0x1080"}, 2, "size '0'"},
        {{"bench", "--size", "1920x"}, 2, "size"},
        {{"bench", "--size", "-5x5"}, 2, "size"},
        {{"bench", "--size", "axb"}, 2, "size 'a'"},
        {{"bench", "--size", "16385x16"}, 2, "1 to 16384"},
        {{"bench", "--size", "99999999999x2"}, 2, "size"},
        {{"partition", "builtin:robot:2000", "--slots", "0"}, 2, "--slots"},
        {{"reproduce", "torabi", "--copies", "0"}, 2, "--copies"},
        {{"reproduce", "torabi", "--rounds", "none"}, 2, "--rounds"},
        {{"reproduce", "torabi", "--size", "64"}, 2, "size '64'"},
        {{"partition", "builtin:robot:2000", "--slots", "65536"}, 2, "--slots"},
        {{"partition", "builtin:robot:2000", "--influences", "5"}, 2, "influences must be 4 or 8"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--method", "lbs,x", "-o", "x.png"}, 2, "no method 'x'"},
        {{"render", "builtin:robot:2000", "--yaw", "sideways", "-o", "x.png"}, 2, "--yaw"},
        {{"render", "builtin:robot:2000", "--yaw", "361", "-o", "x.png"}, 2, "--yaw"},
        {{"render", "builtin:robot:2000", "--copies", "0", "-o", "x.png"}, 2, "--copies"},
        {{"render", "builtin:robot:2000", "--size", "x", "-o", "x.png"}, 2, "size"},
        {{"render", "builtin:robot:2000", "--influences", "3", "--route", "vk", "-o", "x.png"}, 2, "influences"},
    });
    CHECK(!fs::exists(pathOf("x.png")));
    CHECK(!fs::exists(pathOf("results")));
}

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
                                                          {"", ""},
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
        {"index 3 is vertex 4", [](Gltf& g) { g.poke<uint16_t>(5, 3, 4); }},
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
    CHECK(missing.err.size() <= 410);
    CHECK_THAT(missing.err, ContainsSubstring("\\nskinbench: all is well"));
}

TEST_CASE("what the machine cannot do has status 1") {
    checkRefused({
        {{"verify", "builtin:robot:2000", "--routes", "vk", "--device", "voodoo"}, 1, "voodoo"},
        {{"verify", "builtin:robot:2000", "--routes", "vk,gl", "--device", "77"}, 1, "77"},
        {{"probe", "--device", "voodoo"}, 1, "voodoo"},
        {{"probe", "--device", "256"}, 1, "no device '256'"},
        {{"reproduce", "torabi", "--device", "voodoo"}, 1, "voodoo"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--device", "voodoo", "-o", "v.png"}, 1, "voodoo"},
    });
    CHECK(!fs::exists(pathOf("v.png")));
    // Cases that cannot run stand in the table, and one line says why there is no more.
    for (const Words& words :
         {Words{"verify", "builtin:biped:60000", "--routes", "cpu", "--copies", "1000000"},
          Words{"verify", "builtin:biped:60000", "--routes", "vk", "--variants", "vertex", "--copies", "4000"}}) {
        const Outcome outcome = call(words);
        INFO("standard error: " << outcome.err);
        CHECK(outcome.status == 1);
        CHECK_THAT(outcome.out, ContainsSubstring("fewer copies"));
        const std::vector<std::string> lines = linesOf(outcome.err);
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], ContainsSubstring("fewer copies"));
    }
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

TEST_CASE("scene list, export and verify") {
    const Outcome list = call({"scene", "list"});
    CHECK(list.status == 0);
    CHECK(list.err == "");
    CHECK(linesOf(list.out).size() == builtinScenes().size());
    const Outcome machine = call({"scene", "list", "--json"});
    CHECK(machine.status == 0);
    const json rows = json::parse(machine.out, nullptr, false);
    REQUIRE(rows.is_array());
    REQUIRE(rows.size() == builtinScenes().size());
    CHECK(rows[0]["name"] == "builtin:biped");

    const Outcome saved = call({"scene", "export", "builtin:robot:2000", "out/robot.glb"});
    CHECK(saved.status == 0);
    CHECK(saved.err == "skinbench: out/robot.glb\n");
    REQUIRE(fs::exists(pathOf("out/robot.glb")));
    const Outcome verified =
        call({"verify", "out/robot.glb", "--copies", "2", "--size", "320x180", "--routes", "cpu,vk,gl", "--json"});
    INFO(verified.err);
    CHECK(verified.status == 0);
    const json results = json::parse(verified.out, nullptr, false);
    REQUIRE(results.is_object());
    CHECK(results["schema"] == "skinbench-results/1");
    for (const json& row : results["cases"]) {
        CHECK(row["status"] != "failed");
        CHECK(row["gpu_ms"].is_null());
    }
    CHECK(!fs::exists(pathOf("results")));
}

TEST_CASE("partition prints a table or the command list") {
    const Words words = {"partition", "builtin:creature:4000", "--slots", "20", "--order", "lexicographic"};
    const Outcome table = call(words);
    INFO(table.err);
    CHECK(table.status == 0);
    CHECK(table.err == "");
    Words asJson = words;
    asJson.push_back("--json");
    const Outcome list = call(asJson);
    CHECK(list.status == 0);
    const json found = json::parse(list.out, nullptr, false);
    REQUIRE(found.is_object());
    CHECK(found["schema"] == "skinbench-partition/1");
    CHECK(found["solver"] == "cheapest-insertion");
    CHECK(found["hardware"]["slots"] == 20);
    CHECK(found["commands"].size() == found["passes"]);
    CHECK(found["passes"] > 2);
    size_t uploads = 0, triangles = 0;
    for (const json& command : found["commands"]) {
        uploads += command["loads"].size();
        CHECK(command["first_triangle"] == triangles);
        triangles += command["triangle_count"].get<size_t>();
        for (const json& load : command["loads"]) CHECK(load["slot"] < 20);
    }
    CHECK(found["uploads"] == uploads);
    CHECK(found["triangles"].size() == triangles);
    CHECK_THAT(table.out, ContainsSubstring("\nuploads   " + std::to_string(uploads) + "\n"));
    CHECK_THAT(table.out, ContainsSubstring("\npasses    " + std::to_string(found["passes"].get<int>()) + "\n"));

    const Words bent = {"partition", "builtin:biped:4000", "--hardware", "rigid"};
    checkRefused(call(bent), 2, "but rigid has 1 palette slot; keep fewer influences a vertex (--influences)");
    CHECK(call({"partition", "builtin:robot:2000", "--hardware", "rigid", "--solver", "simple"}).status == 0);
}

TEST_CASE("probe tells what there is and what auto takes") {
    const Outcome probe = call({"probe", "--json"});
    INFO(probe.err);
    CHECK(probe.status == 0);
    const json found = json::parse(probe.out, nullptr, false);
    REQUIRE(found.is_object());
    CHECK(found["auto"]["route"].is_string());
    CHECK(found["auto"]["variant"].is_string());
    for (const json& device : found["devices"])
        CHECK(device["routes"].size() == 14);  // 6 variants without mesh shaders, 4 on each mesh route
    CHECK(found["auto"]["rule"].size() == 8);
    CHECK(found["measured"].is_null());
    const Outcome text = call({"probe"});
    CHECK(text.status == 0);
    CHECK_THAT(text.out, ContainsSubstring("auto: " + found["auto"]["route"].get<std::string>()) &&
                             ContainsSubstring("rule of auto: the first that runs of vk-ext/mesh, vk-nv/mesh"));
    for (const json& device : found["devices"])
        CHECK_THAT(text.out, ContainsSubstring(std::format("{}: {}", device["number"].get<size_t>(),
                                                           device["name"].get<std::string>())));
}

TEST_CASE("probe measures what auto chooses from") {
    if (json::parse(call({"probe", "--json"}).out, nullptr, false)["auto"]["route"] == "cpu") SKIP("no driver");
    const Outcome probe = call({"probe", "--measure", "builtin:robot:2000", "--json"});
    INFO(probe.err);
    CHECK(probe.status == 0);
    const json measured = json::parse(probe.out, nullptr, false)["measured"];
    REQUIRE(measured.is_object());
    REQUIRE(measured["cases"].size() > 1);
    CHECK(measured["fastest"] == measured["cases"][0]["id"]);
    CHECK(measured["rule"].is_string());
    double last = 0;
    for (const json& row : measured["cases"]) {
        INFO(row["id"]);
        REQUIRE(row["median_ms"].is_number());
        CHECK(row["median_ms"] >= last);
        last = row["median_ms"];
    }
    checkRefused(call({"probe", "--measure", "none.glb"}), 2, "none.glb");
}

TEST_CASE("two devices of one name are told apart, and each has a folder of its own") {
    checkRefused(call({"verify", "builtin:robot:2000", "--device", "all", "--json"}), 2, "--device all");
    // A second file for one driver is a second device to the loader, with the UUID of the first.
    std::string driver;
    for (const char* file : {"/usr/share/vulkan/icd.d/lvp_icd.json", "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json"})
        if (fs::exists(file)) driver = file;
    if (driver.empty()) SKIP("no lavapipe");
    const std::string second = fixture::writeText("lvp_again.json", readWholeFile(driver).value());
    const Words twice = {"VK_DRIVER_FILES=" + driver + ":" + second, "VK_ADD_DRIVER_FILES=", "VK_ICD_FILENAMES="};
    const Words small = {"verify", "builtin:robot:2000", "--routes", "vk",     "--variants",
                         "vertex", "--copies",           "1",        "--size", "64x64"};
    auto with = [&](const Words& more) {
        Words words = small;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    checkRefused(call(with({"--device", "llvm"}), twice), 1, "'llvm' fits ");
    const Outcome all = call(with({"--device", "all", "--out", "each"}), twice);
    INFO(all.err);
    CHECK(all.status == 0);
    for (const char* number : {"0", "1"}) {
        const std::string folder = pathOf(std::string("each/") + number + "-llvmpipe");
        const auto text = readWholeFile(folder + "/results.json");
        REQUIRE(text);
        const json device = json::parse(*text, nullptr, false)["devices"][0];
        CHECK(device["number"] == std::stoi(number));
        CHECK(device["uuid"].is_null());
        const auto csv = readWholeFile(folder + "/results.csv");
        REQUIRE(csv);
        CHECK_THAT(*csv, ContainsSubstring(std::string("(device ") + number + ")"));
    }
    CHECK(fs::exists(pathOf("each/report.html")));
    CHECK(call({"report", "each", "-o", "farm.html"}).status == 0);
    CHECK_THAT(readWholeFile(pathOf("farm.html")).value(), ContainsSubstring("each/0-llvmpipe"));
}

TEST_CASE("OpenGL's reason is what the display said that came farthest") {
    const Words old = {"MESA_GL_VERSION_OVERRIDE=3.3", "LIBGL_ALWAYS_SOFTWARE=1"};
    const json found = json::parse(call({"probe", "--json"}, old).out, nullptr, false);
    REQUIRE(found.is_object());
    if (found["missing"].empty()) SKIP("a driver that the variable does not bind");
    const std::string reason = found["missing"].back();
    if (!reason.starts_with("OpenGL: no device")) SKIP("no EGL");
    CHECK_THAT(reason, ContainsSubstring("OpenGL: no device: no core profile of version 4.5 or newer"));
    CHECK(reason.size() <= 400);
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
    const std::string right = "if (weight <= 1e-7) return;";
    REQUIRE(text.contains(right));
    text.replace(text.find(right), right.size(), "if (weight <= 0.3) return;");
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
    CHECK_THAT(verified.err, ContainsSubstring("1 of 1 cases failed; the first, vk/vertex/uc: positions are off by "));
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
        CHECK(drawn.status != 0);
        CHECK_THAT(drawn.err, ContainsSubstring("vertex.glsl"));
        CHECK(linesOf(drawn.err).size() == 1);
    }
}
