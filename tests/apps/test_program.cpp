// The program as a user calls it: words, exit statuses, what goes to which stream.
#include <format>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/cases/axes.h"
#include "common/core/file.h"
#include "common/scene/scene.h"
#include "tests/apps/program_call.h"

using namespace skinbench;
using namespace program;
using Catch::Matchers::ContainsSubstring;
using fixture::json;
namespace fs = std::filesystem;

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
    CHECK(completed("skinbench scene e") == "export ");
    CHECK(completed("skinbench completion z") == "zsh ");
    CHECK(completed("skinbench reproduce ''") == "torabi kimmersdorfer ");
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
