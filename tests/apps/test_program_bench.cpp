// What the program draws and measures, as a user calls it: files, interrupts, missing drivers.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/core/file.h"
#include "tests/apps/program_call.h"

using namespace skinbench;
using namespace program;
using Catch::Matchers::ContainsSubstring;
using fixture::json;
namespace fs = std::filesystem;

TEST_CASE("bench writes what it prints, and report makes a page of it") {
    const Outcome bench = call({"bench", "builtin:robot:2000", "--copies", "2", "--frames", "2", "--rounds", "1",
                                "--warmup", "0", "--size", "320x180", "--out", "run/deep", "--json"});
    INFO(bench.err);
    CHECK(bench.status == 0);
    const json printed = json::parse(bench.out, nullptr, false);
    REQUIRE(printed.is_object());
    CHECK(readWholeFile(pathOf("run/deep/results.json")) == bench.out);
    const auto csv = readWholeFile(pathOf("run/deep/results.csv"));
    REQUIRE(csv);
    CHECK(linesOf(*csv).size() == printed["cases"].size() + 1);
    const auto page = readWholeFile(pathOf("run/deep/report.html"));
    REQUIRE(page);
    CHECK(printed["settings"]["copies"] == 2);
    CHECK(printed["settings"]["warmup"] == 0);
    CHECK(
        printed["command"] ==
        "skinbench bench builtin:robot:2000 --copies 2 --frames 2 --rounds 1 --warmup 0 --size 320x180 --out run/deep "
        "--json");
    for (const json& row : printed["cases"]) {
        const std::string id = row["id"], status = row["status"];
        INFO(id << ": " << row["reason"]);
        CHECK(status != "failed");
        CHECK(row["gpu_ms"].is_null() == (status != "ok"));
        if (status == "ok") CHECK(row["gpu_ms"]["samples"].size() == 2);
        CHECK_THAT(*page, ContainsSubstring(id));
        CHECK_THAT(*csv, ContainsSubstring(id));
    }
    size_t files = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(pathOf("run/deep"))) ++files;
    CHECK(files == 3);

    const Outcome report = call({"report", "run/deep/results.json", "run/deep/", "-o", "r.html"});
    CHECK(report.status == 0);
    CHECK(report.err == "skinbench: r.html\n");
    const auto made = readWholeFile(pathOf("r.html"));
    REQUIRE(made);
    for (const char* name : {"data-name=\"run/deep/results.json\"", "data-name=\"run/deep/\""})
        CHECK_THAT(*made, ContainsSubstring(name));
    CHECK(made->size() > page->size());
    fixture::writeText("plain", "x");
    checkRefused(call({"report", "run/deep/results.json", "-o", "plain/r.html"}), 2, "plain/r.html");

    // Two samples a case tell nothing; a case that fails is worse.
    const Words compare = {"compare", "run/deep/results.json", "run/deep/results.json"};
    const Outcome same = call(compare);
    CHECK(same.status == 0);
    CHECK(same.err == "");
    CHECK_THAT(same.out, ContainsSubstring("not known, fewer than 6 samples"));
    CHECK(same.out.find("differs") == std::string::npos);
    const Outcome pairs = call({"compare", "run/deep", "--pair", "variant", "--json"});
    CHECK(pairs.status == 0);
    CHECK(json::parse(pairs.out, nullptr, false)["paired_by"] == json{"variant"});
    const Outcome odd = call({"compare", "run/deep", "--pair", "shoe"});
    CHECK(odd.status == 2);
    for (const json& axis : printed["axes"]) CHECK_THAT(odd.err, ContainsSubstring(axis["name"].get<std::string>()));
    json broken = printed;
    for (json& row : broken["cases"])
        if (row["route"] == "cpu") row["status"] = "failed", row["reason"] = "wrong";
    fixture::writeText("broken_cases.json", broken.dump());
    const Outcome worse =
        call({"compare", "run/deep/results.json", "broken_cases.json", "--fail-above", "5", "--json"});
    CHECK(worse.status == 1);
    CHECK_THAT(worse.err, ContainsSubstring("skinbench: 1 of ") && ContainsSubstring("is ok in A and not in B"));
    const json compared = json::parse(worse.out, nullptr, false);
    REQUIRE(compared.is_object());
    CHECK(compared["schema"] == "skinbench-compare/1");
    CHECK(compared["cases"].size() == printed["cases"].size());
    CHECK(call({"compare", "run/deep/results.json", "broken_cases.json"}).status == 0);
    const Outcome few = call({"compare", "broken_cases.json", "run/deep/results.json", "--fail-above", "0"});
    CHECK(few.status == 1);
    CHECK_THAT(few.err, ContainsSubstring("too few samples to be compared"));

    // Any key of the file may be missing or of another kind: an error or a page, never a crash.
    size_t refused = 0;
    for (const json::json_pointer& place :
         {"/scene/vertices"_json_pointer, "/scene/mean_influences"_json_pointer, "/settings/frames"_json_pointer,
          "/host/os"_json_pointer, "/tool"_json_pointer, "/cases/0/id"_json_pointer, "/cases/0/gpu_ms"_json_pointer,
          "/cases/0/gpu_ms/median"_json_pointer, "/cases/0/route"_json_pointer, "/cases/0/passes_ms"_json_pointer,
          "/cases/0/accuracy"_json_pointer, "/cases/0/memory_bytes/total"_json_pointer, "/devices"_json_pointer})
        for (const json& value : {json(), json("text"), json(5), json::array({1}), json::object()}) {
            json damaged = printed;
            if (!damaged.contains(place)) continue;
            damaged[place] = value;
            fixture::writeText("damaged.json", damaged.dump());
            const Outcome outcome = call({"report", "damaged.json", "-o", "d.html"});
            INFO(place.to_string() << " = " << value.dump());
            INFO(outcome.err);
            CHECK((outcome.status == 0 || outcome.status == 2));
            CHECK(outcome.out == "");
            CHECK(linesOf(outcome.err).size() == 1);
            refused += outcome.status == 2;
        }
    CHECK(refused > 20);
}

TEST_CASE("what was asked for and exists on none of the routes is skipped with the reason") {
    const Outcome bench = call({"bench", "builtin:robot:2000", "--routes", "cpu,vk", "--variants", "cpu,mesh", "--cull",
                                "off", "--preset", "quick", "--size", "64x64", "--out", "it's unused"});
    INFO(bench.err);
    CHECK_THAT(bench.out, ContainsSubstring("\n--variants mesh ") &&
                              ContainsSubstring("skipped: mesh needs vk-ext, vk-nv, gl-ext or gl-nv\n"));
    CHECK_THAT(bench.out, ContainsSubstring("skipped: --cull needs vk-ext, vk-nv, gl-ext or gl-nv\n"));
    const json results = json::parse(readWholeFile(pathOf("it's unused/results.json")).value_or(""), nullptr, false);
    REQUIRE(results.is_object());
    CHECK(results["unused"].size() == 2);
    CHECK(results["command"].get<std::string>().ends_with("--out 'it'\\''s unused'"));
}

TEST_CASE("the self-test prepares its pairs anew in every round, a plain bench does not, unless it is told to") {
    const auto placementOf = [](const Words& more) {
        Words words = {"bench", "builtin:robot:2000", "--routes", "cpu", "--copies", "1",
                       "--out", "placement",          "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const json results = json::parse(call(words).out, nullptr, false);
        REQUIRE(results.is_object());
        return results["settings"]["placement"].get<std::string>();
    };
    CHECK(placementOf({}) == "kept");
    CHECK(placementOf({"--self-test"}) == "fresh");
    CHECK(placementOf({"--self-test", "--placement", "kept"}) == "kept");
    CHECK(placementOf({"--placement", "fresh"}) == "fresh");
}

TEST_CASE("the same seed and scene give the same cases; lists are crossed") {
    const Words words = {"verify", "builtin:robot:2000", "--routes", "cpu,vk",   "--variants", "cpu,none", "--codecs",
                         "uc",     "--influences",       "4,8",      "--copies", "1",          "--size",   "64x64",
                         "--json"};
    const Outcome verified = call(words);
    INFO(verified.err);
    const json results = json::parse(verified.out, nullptr, false);
    REQUIRE(results.is_object());
    std::vector<std::string> ids;
    for (const json& row : results["cases"]) ids.push_back(row["id"]);
    const std::vector<std::string> wanted = {"vk/none/uc",
                                             "vk/none/uc+pull",
                                             "vk/none/uc+8-influences",
                                             "vk/none/uc+8-influences+pull",
                                             "cpu/cpu/uc",
                                             "cpu/cpu/uc+8-influences",
                                             "vk/cpu/uc",
                                             "vk/cpu/uc+8-influences"};
    CHECK(std::is_permutation(ids.begin(), ids.end(), wanted.begin(), wanted.end()));
}

namespace {

// Runs until a checkpoint holds a time.
Running startTiming(const std::string& folder) {
    fs::remove_all(pathOf(folder));
    const Running running = start({"bench", "builtin:robot:2000", "--routes", "cpu", "--influences", "4,8", "--copies",
                                   "4", "--frames", "100000", "--rounds", "1000", "--out", folder, "--json"});
    bool timed = false;
    for (int tries = 0; tries < 2000 && !timed; ++tries) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        const auto text = readWholeFile(pathOf(folder + "/results.json"));
        timed = text && text->find("samples") != std::string::npos;
    }
    CHECK(timed);
    return running;
}

}  // namespace

TEST_CASE("a crash is one line that names what was done and where its results are, and status 1") {
    const Running running = startTiming("crash");
    kill(running.pid, SIGSEGV);
    const Outcome crashed = finish(running);
    INFO(crashed.err);
    CHECK(crashed.status == 1);
    CHECK(json::parse(readWholeFile(pathOf("crash/results.json")).value_or(""), nullptr, false).is_object());
#ifndef __SANITIZE_ADDRESS__  // which has a handler of its own
    CHECK(linesOf(crashed.err).size() == 1);
    CHECK(crashed.err.starts_with("skinbench: crashed (SIGSEGV) in "));
    CHECK_THAT(crashed.err, ContainsSubstring(" at cpu/cpu/uc") && ContainsSubstring("is in crash/results.json\n"));
#endif
}

TEST_CASE("rounds that the frames are too few for are not left out in silence") {
    const Words few = {"bench", "builtin:robot:2000", "--routes", "cpu",   "--copies", "1", "--frames",
                       "3",     "--rounds",           "8",        "--out", "few"};
    CHECK(call(few).err.starts_with("skinbench: warning: --rounds 8 share --frames 3, at least one each: 3 rounds\n"));
    const json many = json::parse(call({"bench", "builtin:robot:2000", "--routes", "cpu", "--copies", "1", "--rounds",
                                        "40", "--out", "few", "--json"})
                                      .out,
                                  nullptr, false);
    CHECK(many["settings"]["rounds"] == 40);
    CHECK(many["settings"]["frames"] == 40);
}

TEST_CASE("an interrupted bench keeps what was measured") {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const Running running = startTiming("cut");
        // Twice, as coreutils' timeout does.
        kill(running.pid, signal);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        kill(running.pid, signal);
        const Outcome outcome = finish(running);
        INFO(outcome.err);
        CHECK(outcome.status == 0);
        CHECK_THAT(outcome.err, ContainsSubstring("skinbench: interrupted"));
        CHECK(readWholeFile(pathOf("cut/results.json")) == outcome.out);
        const json results = json::parse(outcome.out, nullptr, false);
        REQUIRE(results.is_object());
        CHECK(results["cases"].size() >= 2);
        CHECK(fs::exists(pathOf("cut/report.html")));
    }
}

TEST_CASE("a bench that is interrupted before it begins says so, and ends by the signal") {
    const Running running = start({"bench", "builtin:biped:1000000", "--routes", "cpu", "--out", "before"});
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(running.pid, SIGTERM);
    const Outcome outcome = finish(running);
    CHECK(outcome.status == 128 + SIGTERM);
    CHECK(outcome.err == "skinbench: interrupted\n");
    CHECK_FALSE(fs::exists(pathOf("before/results.json")));
}

TEST_CASE("a bench that is interrupted early says which cases were not measured") {
    const Running running = start({"bench", "builtin:biped:60000", "--routes", "cpu", "--influences", "4,8", "--copies",
                                   "8", "--frames", "400", "--rounds", "1", "--out", "early", "--json"});
    bool verified = false;
    for (int tries = 0; tries < 2000 && !verified; ++tries) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        const auto text = readWholeFile(pathOf("early/results.json"));
        verified = text && text->find("\"status\": \"ok\"") != std::string::npos;
    }
    kill(running.pid, SIGINT);
    const Outcome outcome = finish(running);
    INFO(outcome.err);
    CHECK(verified);
    const json results = json::parse(outcome.out, nullptr, false);
    REQUIRE(results.is_object());
    REQUIRE(results["cases"].size() == 2);
    size_t interrupted = 0;
    for (const json& row : results["cases"]) {
        interrupted += row["reason"].is_string() && row["reason"].get<std::string>().starts_with("interrupted before");
        CHECK(row["gpu_ms"].is_null() == (row["status"] == "skipped"));
    }
    CHECK(interrupted > 0);
    CHECK(outcome.status == (interrupted == 2 ? 1 : 0));
}

TEST_CASE("an earlier result stays whole until the new run has a time of its own, and is kept then") {
    const Words quick = {"bench", "builtin:robot:2000", "--routes", "cpu", "--preset", "quick", "--out", "again"};
    CHECK(call(quick).status == 0);
    const std::string first = readWholeFile(pathOf("again/results.json")).value_or("none");
    REQUIRE(first != "none");
    fixture::writeText("again/report.html", "the first page");

    // Interrupted before a case is timed.
    const Running running = start(
        {"bench", "builtin:biped:200000", "--routes", "cpu", "--influences", "4,8", "--copies", "8", "--out", "again"});
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(running.pid, SIGINT);
    const Outcome cut = finish(running);
    INFO(cut.err);
    CHECK(cut.status != 0);
    CHECK(readWholeFile(pathOf("again/results.json")).value_or("") == first);
    CHECK(!fs::exists(pathOf("again/results.previous.json")));

    CHECK(call(quick).status == 0);
    CHECK(readWholeFile(pathOf("again/results.previous.json")).value_or("") == first);
    CHECK(readWholeFile(pathOf("again/report.previous.html")) == "the first page");
    CHECK(readWholeFile(pathOf("again/results.json")).value_or("") != first);
}

TEST_CASE("what was measured is printed though no file can be written") {
    fs::create_directories(pathOf("gone"));
    const Running running = start({"bench", "builtin:robot:2000", "--routes", "cpu", "--influences", "4,8", "--copies",
                                   "4", "--frames", "100000", "--rounds", "1000", "--out", "gone"});
    for (int tries = 0; tries < 2000 && !fs::exists(pathOf("gone/report.html")); ++tries)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    fs::remove_all(pathOf("gone"));
    fixture::writeText("gone", "a file in the folder's place");
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    kill(running.pid, SIGINT);
    const Outcome outcome = finish(running);
    INFO(outcome.err);
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.out, ContainsSubstring("cpu/cpu/uc+8-influences"));
    const std::vector<std::string> lines = linesOf(outcome.err);
    CHECK(std::ranges::count_if(lines, [](const std::string& line) { return line.contains("tries again"); }) == 1);
    // The samples, which the table lacks, are in another place.
    const std::string mark = "the results are in ";
    const size_t at = outcome.err.find(mark);
    REQUIRE(at != std::string::npos);
    const std::string other =
        outcome.err.substr(at + mark.size(), outcome.err.find(".json", at) + 5 - at - mark.size());
    const auto kept = readWholeFile(other);
    REQUIRE(kept);
    CHECK(json::parse(*kept, nullptr, false)["schema"] == "skinbench-results/1");
    fs::remove(other);
}

TEST_CASE("without any driver the CPU route runs and the others say what is missing") {
    const Words none = {"VK_DRIVER_FILES=/nonexistent",           "VK_ICD_FILENAMES=/nonexistent",
                        "VK_ADD_DRIVER_FILES=/nonexistent",       "__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent",
                        "__EGL_VENDOR_LIBRARY_DIRS=/nonexistent", "LIBGL_DRIVERS_PATH=/nonexistent"};
    const Outcome bench = call(
        {"bench", "builtin:robot:2000", "--preset", "quick", "--size", "64x64", "--out", "nodriver", "--json"}, none);
    INFO(bench.err);
    CHECK(bench.status == 0);
    const json results = json::parse(bench.out, nullptr, false);
    REQUIRE(results.is_object());
    CHECK(results["devices"].empty());
    size_t ran = 0;
    for (const json& row : results["cases"]) {
        const bool cpu = row["route"] == "cpu";
        INFO(row["id"]);
        CHECK(row["status"] == (cpu ? "ok" : "skipped"));
        ran += cpu;
        if (cpu) continue;
        CHECK(row["reason"].get<std::string>().size() > 10);
    }
    CHECK(ran > 0);

    const Outcome divided = call({"bench", "builtin:robot:2000", "--preset", "quick", "--routes", "cpu,vk",
                                  "--variants", "cpu,vertex", "--baseline", "vertex", "--out", "nodriver"},
                                 none);
    CHECK(divided.status == 0);
    CHECK_THAT(divided.err, ContainsSubstring("skinbench: --baseline vertex has no time in this run"));

    const Outcome probe = call({"probe", "--json"}, none);
    CHECK(probe.status == 0);
    const json found = json::parse(probe.out, nullptr, false);
    REQUIRE(found.is_object());
    CHECK(found["auto"]["route"] == "cpu");
    CHECK(found["missing"].size() == 2);
    checkRefused(call({"render", "builtin:robot:2000", "--route", "vk", "-o", "n.png"}, none), 1, "Vulkan");
    checkRefused(call({"render", "builtin:robot:2000", "--route", "gl", "-o", "n.png"}, none), 1, "EGL");
    // The table with the reasons is printed all the same.
    const Outcome nothing = call({"verify", "builtin:robot:2000", "--routes", "vk,gl"}, none);
    CHECK(nothing.status == 1);
    CHECK_THAT(nothing.err, ContainsSubstring("skinbench: no case could run; the first, vk/none/"));
    CHECK_THAT(nothing.out, ContainsSubstring("skipped: OpenGL: "));
    CHECK(nothing.err.find("Vulkan: Vulkan") == std::string::npos);
    const Outcome automatic = call({"verify", "builtin:robot:2000", "--routes", "auto", "--copies", "1"}, none);
    CHECK(automatic.status == 0);
    CHECK_THAT(automatic.out, ContainsSubstring("cpu/cpu/uc"));
}

TEST_CASE("render writes a PNG file of the asked size") {
    const Outcome probe = call({"probe", "--json"});
    const json found = json::parse(probe.out, nullptr, false);
    REQUIRE(found.is_object());
    if (found["auto"]["route"] == "cpu") SKIP("no driver");
    const Outcome drawn = call({"render", "builtin:robot:2000", "--size", "96x64", "-o", "shots/robot.png"});
    INFO(drawn.err);
    CHECK(drawn.status == 0);
    CHECK(drawn.out == "");
    CHECK_THAT(drawn.err, ContainsSubstring("skinbench: shots/robot.png\n"));
    const auto bytes = readWholeFile(pathOf("shots/robot.png"));
    REQUIRE(bytes);
    CHECK(bytes->substr(1, 3) == "PNG");
    // Width and height of the IHDR chunk, big-endian.
    CHECK(bytes->substr(16, 8) == std::string("\0\0\0\x60\0\0\0\x40", 8));
}

TEST_CASE("render draws every variant that was named, or says why not") {
    const json found = json::parse(call({"probe", "--json"}).out, nullptr, false);
    REQUIRE(found.is_object());
    if (found["auto"]["route"] != "vk-ext") SKIP("auto is not vk-ext");
    const Words words = {"render", "builtin:robot:2000", "--size", "16x16", "-o", "variants.png", "--variant"};
    const auto with = [&](const Words& more) {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        return call(all);
    };
    const Outcome three = with({"vertex,compute,mesh"});
    INFO(three.err);
    CHECK(three.status == 0);
    for (const char* part : {"picture 1: vk/vertex/uc\n", "picture 2: vk/compute/uc\n", "picture 3: vk-ext/mesh/uc/",
                             "route vk: vertex does not run on vk-ext\n"})
        CHECK_THAT(three.err, ContainsSubstring(part));
    CHECK(readWholeFile(pathOf("variants.png")).value_or("").substr(16, 4) == std::string("\0\0\0\x30", 4));
    const Outcome one = with({"vertex,mesh", "--route", "vk"});
    CHECK(one.status == 0);
    CHECK(one.err ==
          "skinbench: warning: --variants mesh is not drawn: mesh needs vk-ext, vk-nv, gl-ext or gl-nv\n"
          "skinbench: variants.png\n");
    const Outcome routes = with({"vertex,mesh", "--routes", "vk,gl-ext"});
    CHECK_THAT(routes.err,
               ContainsSubstring("picture 1: vk/vertex/uc\n") && ContainsSubstring("picture 2: gl-ext/mesh/uc/"));
}

TEST_CASE("a picture of what is culled counts what a result file counts") {
    const Words scene = {"builtin:robot:2000", "--copies", "7", "--size", "320x180", "--camera", "half"};
    const auto with = [&](const char* subcommand, const Words& more) {
        Words words = {subcommand};
        words.insert(words.end(), scene.begin(), scene.end());
        words.insert(words.end(), more.begin(), more.end());
        return call(words);
    };
    const Outcome drawn = with("render", {"--case", "vk/compute-cull/uc+view-culled", "-o", "culled.png"});
    INFO(drawn.err);
    if (drawn.err.contains("Vulkan: ")) SKIP("no Vulkan driver on this machine");
    const Outcome verified = with("verify", {"--case", "vk/compute-cull/uc", "--json"});
    INFO(verified.err);
    const json counts = json::parse(verified.out, nullptr, false)["cases"][0]["culling"];
    REQUIRE(counts.is_object());
    for (const auto& [name, key] : {std::pair{"outside of the view", "triangles_frustum"},
                                    {"back faces", "triangles_back"},
                                    {"too small", "triangles_small"}}) {
        CHECK(counts[key] > 0);
        CHECK_THAT(drawn.err, ContainsSubstring(std::string(name) + ": " + counts[key].dump() + " of " +
                                                counts["triangles"].dump() + " triangles"));
    }
}

TEST_CASE("render draws a clip as files, one after the other, or as one file, with what two cases differ by") {
    const json found = json::parse(call({"probe", "--json"}).out, nullptr, false);
    REQUIRE(found.is_object());
    if (found["auto"]["route"] == "cpu") SKIP("no driver");
    const Words words = {"render", "builtin:robot:2000", "--size",   "48x32", "--codec",
                         "uc,pc",  "--difference",       "--animate"};
    auto with = [&](const Words& more) {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        return call(all);
    };
    const Outcome frames = with({"2", "-o", "frames"});
    INFO(frames.err);
    CHECK(frames.status == 0);
    const auto first = readWholeFile(pathOf("frames/0000.png")), second = readWholeFile(pathOf("frames/0001.png"));
    REQUIRE((first && second));
    CHECK(first->substr(16, 8) == std::string("\0\0\0\x90\0\0\0\x20", 8));
    CHECK(*first != *second);
    CHECK(!fs::exists(pathOf("frames/0002.png")));
    checkRefused(with({"1", "-o", "frames"}), 2,
                 "frames: a frame of another clip would stay behind this one's, from 0001.png on; remove it, or name");
    CHECK(readWholeFile(pathOf("frames/0000.png")) == *first);
    fs::copy_file(pathOf("frames/0001.png"), pathOf("frames/0002.png"));
    checkRefused(with({"1", "-o", "frames"}), 2, "frames: 2 frames of another clip would stay");
    const Outcome moving = with({"3", "-o", "moving.webp"});
    if (moving.status == 2) SKIP(moving.err);
    CHECK(moving.status == 0);
    const auto bytes = readWholeFile(pathOf("moving.webp"));
    REQUIRE(bytes);
    CHECK(bytes->substr(8, 4) == "WEBP");
    size_t shown = 0;
    for (size_t at = bytes->find("ANMF"); at != std::string::npos; at = bytes->find("ANMF", at + 4)) ++shown;
    CHECK(shown == 3);
    checkRefused(call({"render", "builtin:robot:2000", "--route", "vk", "--size", "8192x16", "--codec", "uc,pc",
                       "--difference", "--animate", "3", "-o", "wide.webp"}),
                 2, "wide.webp: a picture of 24576x16 is too large for a WebP file; the largest is 16383x16383");
    checkRefused(
        call({"render", "builtin:robot:2000", "--difference", "--route", "vk", "--variant", "vertex", "-o", "x.png"}),
        2, "--difference compares two cases, not 1");
}
