// Words of the command line: what is refused in one line, aliases, what shells complete.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/cases/axes.h"
#include "tests/apps/program_call.h"

using namespace skinbench;
using namespace program;
using Catch::Matchers::ContainsSubstring;
namespace fs = std::filesystem;

TEST_CASE("a wrong word gets the nearest right one and the page that has it") {
    checkRefused({
        {{"bench", "--copis", "4"}, 2, "no option --copis; did you mean --copies? See skinbench bench --help"},
        {{"verify", "--varients=mesh"}, 2, "no option --varients=mesh; did you mean --variants? See skinbench verify"},
        {{"benhc"}, 2, "no subcommand 'benhc'; did you mean bench? See skinbench --help"},
        {{"dance"}, 2, "no subcommand 'dance'; there is probe, bench, verify"},
        {{"scene", "lst"}, 2, "no subcommand 'lst'; did you mean list? See skinbench scene --help"},
        {{"bench", "--xyzzy"}, 2, "no option --xyzzy; see skinbench bench --help"},
        {{"bench", "--copies", "0"}, 2, "--copies: '0' is not a number from 1 to 1000000; see skinbench bench --help"},
        {{"bench", "--shape", "odd"}, 2, "--shape: no 'odd'; there is given, auto"},
        {{"bench", "--warmup"}, 2, "--warmup needs a value; see skinbench bench --help"},
        {{"bench", "--copies", "4", "--copies", "5"}, 2, "--copies is given twice; see skinbench bench --help"},
        {{"bench", "--size", "4x4", "--size", "5x5", "--size", "6x6"}, 2, "--size is given 3 times; see skinbench"},
        {{"render", "a.glb", "-o", "a.png", "--view", "joints", "--view", "weights"}, 2, "--view is given twice"},
        {{"inspect", "a.glb", "--meshlets", "64/84", "--meshlet-limits", "64/84"}, 2, "--meshlets is given twice"},
        {{"bench", "--json=maybe"}, 2, "--json takes no value; see skinbench bench --help"},
        {{"bench", "--self-test=3"}, 2, "--self-test takes no value"},
        {{"--device", "3", "bench"}, 2, "--device goes behind bench; see skinbench bench --help"},
        {{"view", "a.glb", "--copies", "5"}, 2, "the window is the program skinview beside this one, ./run view"},
        {{"bench", "--size", "5"}, 2, "--size '5' is not two numbers, as in 640x480"},
        {{"bench", "a.glb", "b.glb"}, 2, "'b.glb' is one word too many; see skinbench bench --help"},
        {{"bench", "--baseline", "mash"}, 2, "--baseline 'mash' is neither a variant (none, vertex"},
        {{"bench", "--routes", "vk", "--baseline", "gl/vertex/uc"}, 2, "gl/vertex/uc is not among the cases"},
        {{"bench", "--routes", "vk", "--baseline", "mesh"}, 2, "--baseline mesh: no case of this run has that variant"},
        {{"bench", "--routes", "cpu", "--baseline", "vertex"}, 2, "--baseline vertex: no case of this run has that"},
        {{"verify", "./no/../such.glb", "--routes", "cpu"}, 2, "skinbench: ./no/../such.glb: there is no such file"},
    });
}

TEST_CASE("an empty value, a list of commas and an option in a value's place are refused before anything runs") {
    std::vector<BadCall> calls;
    for (const char* option : {"--out", "--device", "--clip", "--routes", "--case", "--preset", "--size", "--copies"}) {
        calls.push_back({{"bench", option, ""}, 2, "the value is empty; see skinbench bench --help"});
        calls.push_back({{"bench", std::string(option) + "="}, 2, "the value is empty; see skinbench bench --help"});
    }
    for (const Words& words : {Words{"render", "a.glb", "-o", ""},
                               {"render", "a.glb", "-o", "a.png", "--view", ""},
                               {"report", "a.json", "-o", ""},
                               {"compare", "a.json", "--pair", ""},
                               {"reproduce", "torabi", "--out", ""},
                               {"partition", "a.glb", "--order", ""},
                               {"probe", "--measure", ""},
                               {"probe", "--measure="},
                               {"bench", "--routes", ","},
                               {"bench", "--routes=,,"}})
        calls.push_back({words, 2, "the value is empty"});
    calls.push_back({{"bench", "--out", "--json"}, 2, "--out: a value is missing before --json; see skinbench bench"});
    calls.push_back({{"scene", "export", "biped", ""}, 2, "the name of an output file is empty"});
    checkRefused(calls);
    CHECK(!fs::exists(pathOf("results")));
}

TEST_CASE("bench and render take both spellings of an option, and the help has one") {
    const Outcome list = call({"bench", "--route", "vk", "--variant", "vertex", "--vertex-fetch", "pull", "--list"});
    CHECK(list.out.starts_with("vk/vertex/uc+pull"));
    const std::string bench = call({"bench", "--help"}).out, render = call({"render", "--help"}).out;
    CHECK_THAT(bench, ContainsSubstring("    --variants WORD,...\n") &&
                          ContainsSubstring("dpdc16, and wicked, pc16, pc24 to pc64"));
    CHECK_THAT(render, ContainsSubstring("    --variant WORD,...\n"));
    for (const char* part : {"(default: all)\n", "(default: both)", "--raster "}) {
        INFO(part);
        CHECK(!render.substr(render.find("    --route ")).substr(0, 700).contains(part));
    }
    checkRefused({{{"render", "a.glb", "--codecs", "zip", "-o", "a.png"}, 2, "no codec 'zip'"},
                  {{"render", "a.glb", "--meshlets", "odd", "-o", "a.png"}, 2, "no meshlet limits 'odd'"}});
}

TEST_CASE("verify takes the options of times, and its help leaves them out") {
    const std::string bench = call({"bench", "--help"}).out, verify = call({"verify", "--help"}).out;
    for (const char* option :
         {"--frames", "--warmup", "--rounds", "--precision", "--time-limit", "--placement", "--seed"}) {
        CHECK_THAT(bench, ContainsSubstring(std::string("    ") + option + " "));
        CHECK(!verify.contains(std::string("    ") + option + " "));
    }
    CHECK(call({"verify", "--routes", "cpu", "--frames", "6", "--rounds", "2", "--seed", "5", "--list"}).status == 0);
}

TEST_CASE("equal cases are one case") {
    const Words twice = {"--case", "vk/vertex/uc", "--case", "vk/compute/uc", "--case", "vk/vertex/uc"};
    Words words = {"bench", "--list"};
    words.insert(words.end(), twice.begin(), twice.end());
    CHECK(linesOf(call(words).out).size() == 2);
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
    CHECK(completed("skinbench render --codecs os") == completed("skinbench bench --codec os"));
    CHECK(completed("skinbench render --variants palet") == "palette ");
    CHECK(completed("skinbench bench --varia") == "--variants ");
    CHECK(completed("skinbench verify --see") == " ");
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
        {{"render", "a.glb", "--case", "vk/vertex/uc", "--route", "gl", "-o", "x.png"}, 2, "--case names whole cases"},
        {{"render", "a.glb", "--variant", "vertex,foo", "-o", "x.png"}, 2, "no variant 'foo'; there is none, vertex"},
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
        {{"bench", "builtin:robot:2000", "--case", "vk/vertex/uc+view-normals", "--out", "x"},
         2,
         "vk/vertex/uc+view-normals: what is measured is the usual view, shaded; leave out view-normals"},
        {{"render", "builtin:robot:2000", "--case", "vk/compute-cull/uc+no-tests+view-culled", "-o", "x.png"},
         2,
         "leave out --triangle-tests none"},
        {{"verify", "--variants", "palette", "--palette-slots", "0"},
         2,
         "--palette-slots '0' is not a number from 1 to 65535"},
        {{"verify", "--compute", "staged+fast"}, 2, "no compute option 'fast'; there is plain, staged, previous"},
        {{"verify", "--compute", "plain+staged"}, 2, "compute option plain is used alone, not as in 'plain+staged'"},
        {{"verify", "--routes", "auto,gl"}, 2, "route auto is used alone, not beside others"},
        {{"render", "builtin:robot:2000", "--route", "gl,auto", "-o", "x.png"}, 2, "route auto is used alone"},
        {{"verify", "--compute", "staged++packed"}, 2, "no compute option ''"},
        {{"render", "builtin:robot:2000"}, 2, "--output is required"},
        {{"render", "-o", "x.png"}, 2, "SCENE is required"},
        {{"scene"}, 2, "subcommand"},
        {{"scene", "export", "robot"}, 2, "OUT is required"},
        {{"scene", "delete"}, 2, "delete"},
        {{"partition"}, 2, "SCENE is required; see skinbench partition --help"},
        {{"partition", "builtin:robot:2000", "--hardware", "abacus"}, 2, "no hardware 'abacus'; there is generic"},
        {{"partition", "builtin:robot:2000", "--solver", "exact"}, 2, "no solver 'exact'; there is simple, cheapest"},
        {{"partition", "builtin:robot:2000", "--order", "best"}, 2, "no order 'best'; there is given, size, lexico"},
        {{"partition", "builtin:robot:2000", "--hardware", "vs1", "--slots", "9"}, 2, "vs1 has 28"},
        {{"report"}, 2, "FILES are required"},
        {{"reproduce"}, 2, "THESIS is required"},
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
        {{"bench", "--seed", "one"}, 2, "--seed: 'one' is not a number from 0"},
        {{"bench", "--seed", "-1"}, 2, "--seed: '-1' is not a number from 0 to 4294967295"},
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
        {{"partition", "builtin:robot:2000", "--influences", "5"}, 2, "--influences: no '5'; there is 4, 8"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--method", "lbs,x", "-o", "x.png"}, 2, "no method 'x'"},
        {{"render", "builtin:robot:2000", "--yaw", "sideways", "-o", "x.png"}, 2, "--yaw"},
        {{"render", "builtin:robot:2000", "--yaw", "361", "-o", "x.png"}, 2, "--yaw"},
        {{"render", "builtin:robot:2000", "--copies", "0", "-o", "x.png"}, 2, "--copies"},
        {{"render", "builtin:robot:2000", "--size", "x", "-o", "x.png"}, 2, "size"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--method", "lbs,dqs", "--size", "16384x16384", "-o",
          "x.png"},
         2,
         "x.png: a picture of 32768x16384 is too large for a PNG file; the largest is 16384x16384"},
        {{"render", "builtin:robot:2000", "--route", "vk", "--method", "lbs,dqs", "--difference", "--size",
          "16384x16384", "--animate", "2", "-o", "x.png.d"},
         2,
         "a picture of 49152x16384 is too large"},
        {{"render", "builtin:robot:2000", "--influences", "3", "--route", "vk", "-o", "x.png"}, 2, "influences"},
    });
    CHECK(!fs::exists(pathOf("x.png")));
    CHECK(!fs::exists(pathOf("results")));
}
