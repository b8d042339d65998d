// The program as a user calls it: exit statuses, what goes to which stream.
#include <format>
#include <fstream>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

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
    checkRefused(
        call(bent), 2,
        "but a draw has 1 palette slot; choose fewer influences a vertex (--influences) or hardware with more slots "
        "(--hardware, --slots)");
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

TEST_CASE("probe that is interrupted while it measures says so") {
    if (json::parse(call({"probe", "--json"}).out, nullptr, false)["auto"]["route"] == "cpu") SKIP("no driver");
    const Running running = start({"probe", "--measure", "builtin:biped:60000"});
    // From when it runs cases on, a reader that goes away ends nothing.
    const auto ignores = [&](int signal) {
        std::ifstream file(std::format("/proc/{}/status", running.pid));
        std::string line;
        while (std::getline(file, line))
            if (line.starts_with("SigIgn:")) return (std::stoull(line.substr(7), nullptr, 16) >> (signal - 1) & 1) == 1;
        return false;
    };
    for (int tries = 0; tries < 20'000 && !ignores(SIGPIPE); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(running.pid, SIGINT);
    const Outcome outcome = finish(running);
    INFO(outcome.err);
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.err, ContainsSubstring("skinbench: interrupted before a case was done\n"));
    CHECK(!outcome.err.contains("no route could be timed"));
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
