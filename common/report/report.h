// Results as data: the JSON of the result file, a CSV of the same rows, a table for a terminal, and one HTML page.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/measure/bench.h"
#include "common/measure/device_state.h"

namespace skinbench {

inline constexpr const char* kResultsSchema = "skinbench-results/1";

// How `--shape auto` chose the shape of a case: every shape that was tried, in milliseconds a frame.
struct Calibration {
    std::string chosen;  // the id of the case with its chosen shape
    std::vector<std::pair<std::string, double>> tried;
};

// Where a run took place and what it was asked for.
struct RunContext {
    std::string version, revision, buildType;
    std::string os, cpu;
    std::vector<DeviceCaps> devices;  // those that were opened
    std::string sceneName;
    SceneStats scene;  // prepared with `influences`
    WorkloadSettings workload;
    std::optional<InView> inView;
    BenchSettings bench;
    std::vector<Calibration> calibrations;
    std::map<Api, double> copyBandwidth;                 // bytes a second, by API that was opened
    std::vector<std::vector<DeviceState>> deviceStates;  // when timing began and when it ended
    double verifiedSeconds = 0, timedSeconds = 0;        // host time of the two parts of a run
    std::vector<std::string> warnings;                   // that concern the figures
    std::string command;                                 // as a shell takes it; empty: not known
    std::string baseline = "vertex";                     // a variant, or the id of a case
    std::vector<Unused> unused;                          // what was asked for and is in no case
};

// What a reader of the figures must know: a debug build, clocks that moved by more than 2 % while cases were timed,
// rounds that drifted by more than 1 %, a precision that was not reached.
std::vector<std::string> figureWarnings(const RunContext& context, const std::vector<CaseResult>& results);

// The largest relative difference of the two medians of a case that BenchSettings::selfTest listed twice; cases that
// the host skins are left out. Empty without such pairs.
std::optional<double> noiseFloor(const std::vector<CaseResult>& results);

// Version, revision and build type of this program, operating system and processor of this machine.
RunContext hostContext();

// Times in milliseconds, memory in bytes, position error relative, normal error in radians; fields that do not apply
// are null.
nlohmann::ordered_json resultsJson(const RunContext& context, const std::vector<CaseResult>& results);

// The block "scene" of result and inspect files.
nlohmann::ordered_json sceneJson(const std::string& name, const SceneStats& stats);

// "24000 vertices, 47960 triangles, 57 joints, 812 tuples, 1.90 influences (4 at the most)"
std::string sceneText(const SceneStats& stats);

// The table of axes, for readers of the file: what may differ between cases, and what that changes.
nlohmann::ordered_json axesJson();

// The table of routes: name, API with its name, and dialect.
nlohmann::ordered_json routeTableJson();

nlohmann::ordered_json capsJson(const DeviceCaps& caps);

// Facts of a result file, each a group of it and a key, that say what its cases draw.
struct DrawnFact {
    const char *group, *key;
};
const std::vector<DrawnFact>& drawnFacts();

// "scene", "copies": which of them two files both have, and differ in. Such times say nothing about which is faster.
std::vector<std::string> drawnDifferences(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

// What a device of a result file is called among others of its machine: its label, in older files its name.
std::string deviceLabel(const nlohmann::ordered_json& device);

// Adds to a file of an older version what every reader expects of one: the table of axes, every axis of a case, the
// routes and labels of the devices. All follow from today's tables and the ids of the cases.
void completeResults(nlohmann::ordered_json& results);

// One line a case, the columns named in the first line: every axis and every column that is no list; quoted as RFC 4180
// says.
std::string resultsCsv(const nlohmann::ordered_json& results);

// Lines for people: what was measured in one sentence; the cases of each route, the fastest first; what was skipped;
// warnings; the answers (answers.h). Times of software drivers carry a mark that is explained at the end. For a
// terminal of `width` columns, what all ids share is said once and equal reasons are joined; with 0, for files and
// pipes, every case has a line of its own with its whole id.
std::string resultsTable(const nlohmann::ordered_json& results, size_t width = 0);

// A folder stands for the results.json in it.
std::string resultsFileOf(const std::string& path);

// Reads a result file, or that of a folder, and completes it; the error says what is wrong with it.
Result<nlohmann::ordered_json> loadResults(const std::string& path);

// Whether a route, or that of a case, is carried by a software driver; both as loadResults gives them.
bool isSoftwareRoute(const nlohmann::ordered_json& results, const std::string& route);
bool isSoftware(const nlohmann::ordered_json& results, const nlohmann::ordered_json& row);

// One self-contained page of one or more result files, which are in it as JSON; `names` of the files, as
// their reader knows them, may be fewer.
std::string reportHtml(const std::vector<nlohmann::ordered_json>& results, const std::vector<std::string>& names = {});

}  // namespace skinbench
