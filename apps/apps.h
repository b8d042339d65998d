// What the subcommands share: the words of the command line, the selectors of bench and verify, opened devices.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/cases/axes.h"
#include "common/frame/devices.h"
#include "common/measure/bench.h"
#include "common/report/report.h"

namespace skinbench {

inline constexpr int kExitDone = 0, kExitFailed = 1, kExitBadInput = 2;

// One line on standard error each, whatever is in the text: "skinbench: <text>", or with the name that was given.
// reportError gives the exit status of the fault.
void nameProgram(const std::string& name);
void say(const std::string& text);
void warn(const std::string& text);
int reportError(const Error& error);

// Standard output has reached its reader, else kExitFailed and a line that says so.
int flushOutput();

// Columns of the terminal that standard output is; 0 where it is none.
size_t terminalWidth();

// --- devices (devices.cpp) -------------------------------------------------------------------------------------

// The devices of this machine, listed on the first call, which takes a second.
const Machine& thisMachine();

// What a user should know of them: variables that hide devices, GPUs that no driver offers.
const std::vector<std::string>& machineNotes();

// The backends that a run uses, one an API at the most, all on one physical device.
struct Devices {
    std::vector<std::unique_ptr<Backend>> owned;
    Backends byApi;
    bool anyHardware = false;
    std::vector<DeviceCaps> caps;
    std::vector<std::string> notes;  // where it cannot be told whether two APIs are on one device
};

// Opens what the routes need on the device that a word names (pickDevice) and says the machine's notes. An API that
// cannot be opened stays in `byApi` with its reason; only a device that was named and that no API has is an error.
Result<Devices> openDevices(const std::vector<const Route*>& needed, const std::string& device, bool validation);

// The caps of a device on every API that has it.
std::vector<DeviceCaps> capsOfDevice(size_t device);

// The routes that `auto` tries, best first: mesh shaders before compute before the vertex stage, Vulkan before OpenGL,
// EXT before NV.
struct RouteWish {
    const char* route;
    const char* variant;
    const char* reason;
};
const std::vector<RouteWish>& routeWishes();
Case caseOf(const RouteWish& wish);

// The first of them that a device runs.
struct Choice {
    const Route* route = nullptr;
    const Variant* variant = nullptr;
    std::string reason;
};
Choice chooseRoute(const std::vector<DeviceCaps>& devices);

// What `auto` stands for on the device that a word names; an empty word becomes the number of the device.
Result<Choice> chooseRouteOf(std::string& device);

// --- crashes (crash.cpp) ---------------------------------------------------------------------------------------

// From now on a crash is one line and status 1. The line names the library, says what was being done, whether the
// address space is limited (drivers crash where it is), and which file has what was measured. Handlers that are there
// already stay, as a sanitizer's.
void catchCrashes();
void noteDoing(const std::string& what);
void noteKept(const std::string& path);

// --- selectors (selectors.cpp) ---------------------------------------------------------------------------------

// Which cases, of which scene, and how they are measured.
struct Selectors {
    std::string scene = "builtin:biped";
    AxisWords words;                   // crossed
    std::vector<std::string> caseIds;  // exactly these cases instead
    std::string shape = "given";
    std::string geometry = "welded";
    bool noCacheOrder = false;
    std::string clip;
    double seconds = 0.4;
    std::string pose = "animated";
    std::string camera = "crowd";
    double characterPixels = 0;                               // 0: as the camera has it
    uint32_t copies = 0, frames = 0, warmup = 0, rounds = 0;  // 0: chosen from the devices
    bool warmupGiven = false;
    double precision = -1;  // percent; below 0: chosen from the devices, or 0 where frames or rounds are given
    double timeLimit = -1;  // seconds; below 0: chosen from the devices
    bool selfTest = false;
    std::string placement;  // empty: fresh for the self-test, otherwise kept
    std::string size = "1920x1080";
    std::string preset;
    uint32_t seed = 1;
    double tolerance = 2e-6;
    std::string device;
    bool validation = false;
};

// The cases that were named, or the crossed ones; raster modes that were not named are the preset's.
Result<std::vector<Case>> selectedCases(const Selectors& selectors);

// The crossings one behind the other, each case once. That some of them have no case is no error.
Result<std::vector<Case>> crossedOnce(const std::vector<AxisWords>& crossings);

// --shape auto: times every shape of each mesh case for a few frames and gives the case its fastest.
Result<std::vector<Calibration>> calibrateShapes(Workload& workload, std::vector<Case>& cases, const Backends& backends,
                                                 const BenchSettings& settings);

// The settings with the devices' defaults filled in.
Result<WorkloadSettings> workloadSettings(const Selectors& selectors, bool anyHardware);
// Warns where fewer rounds are left than were asked for.
BenchSettings benchSettings(const Selectors& selectors, bool anyHardware);

Result<std::pair<uint32_t, uint32_t>> parseSize(const std::string& text);

// Loads the scene and the shaders, prints the scene's warnings to standard error.
Result<Workload> openWorkload(const std::string& scene, const WorkloadSettings& settings);

// The sentence that says how many vertices the first frame leaves out of the image; empty where it leaves out none, or
// where the camera is one that should.
std::string viewWarning(const Workload& workload, const InView& seen);

// --- running cases (running.cpp) -------------------------------------------------------------------------------

// The first SIGINT, SIGTERM or SIGHUP ends the run after the current case; another one, more than a second later, at
// once. A signal that was ignored stays so (nohup). A reader of standard output that goes away ends nothing.
void catchInterrupts();

// Until then such a signal is one line, and ends the program as it would without.
void catchEarlyInterrupts();
bool interrupted();

// Progress on a terminal, the end at an interrupt, and what `context` tells of devices and durations; the checkpoint is
// left empty.
BenchEvents consoleEvents(RunContext& context);

// A checkpoint that takes no more than a tenth of the run, so a crash loses the cases of ten writes at the most.
Checkpoint nowAndThen(Checkpoint write);

// A checkpoint that could not be written is a warning, and no second one after `warned`; the next one tries again.
void warnOnce(bool& warned, const Result<void>& written);

// A file's suffix says what is in it: `wanted`, or none at all, as /dev/stdout has.
Result<void> checkSuffix(const std::string& path, const std::string& wanted);

// "results.json" becomes "results.previous.json" in the same folder, whole at every moment. Nothing happens without it.
void keepPrevious(const std::string& path);

// Path and text of each. All are written, or none (writeWholeFiles), with one line on standard error and status 1. The
// first one, unless it is `printed` already, then goes to the folder for temporary files, and the line says where.
int writeOutputs(const std::vector<std::pair<std::string, std::string>>& files, bool printed,
                 const std::function<void()>& beforeReplacing);

// Everything but `bench` and `calibrations`. `scene` is the workload's, prepared.
RunContext runContext(const Devices& devices, const Workload& workload, const Scene& scene);

// The exit status; one line on standard error for what went wrong, the table has the rest.
int statusOf(const std::vector<CaseResult>& results);

// --- subcommands: options in, exit status out ------------------------------------------------------------------

inline constexpr const char* kUsualBaseline = "vertex";

struct RunOptions {
    Selectors selectors;
    bool timed = true;
    bool json = false;
    bool list = false;     // the cases alone
    std::string baseline;  // RunContext::baseline; empty: kUsualBaseline
    std::string command;   // RunContext::command
    std::string out;       // folder of results.json, results.csv and report.html; empty: none
};
int runCases(const RunOptions& options);  // bench and verify

// The run on every device (allDevices) one after the other, each with a folder of its own in --out, and a page of all.
// A device that fails ends no other's.
int runOnAllDevices(const RunOptions& options, int (*runOn)(const RunOptions& options));
// Prints the cases, each with why it would be skipped as far as the caps of the devices say. No shader is compiled.
int listCases(const RunOptions& options, const std::vector<Case>& cases, const std::vector<Unused>& unused);

struct ProbeOptions {
    std::string device;
    bool measure = false;  // time what `auto` chooses from
    std::string scene = "builtin:biped";
    bool json = false;
};
int runProbe(const ProbeOptions& options);

// Verifies and times every route and variant of routeWishes() that the device (its number, as a word) runs: scene,
// copies, cases with median_ms and interval, the fastest first, and the ids of the fastest and of the rule's choice.
Result<nlohmann::ordered_json> measureChoices(const std::string& scene, const std::string& device,
                                              const Choice& choice);
std::string measuredText(const nlohmann::ordered_json& measured);

// What a view needs of a case beyond what the route needs.
Result<void> checkView(const Case& c);

// Why no backend draws the case, or nothing.
std::optional<std::string> reasonAgainst(const Case& c, const Backends& backends);

inline constexpr float kUsualYaw = 25;  // degrees that a single character is turned by in pictures

inline constexpr uint32_t kMostFrames = 10'000;  // of a clip

struct RenderOptions {
    Selectors selectors;
    std::string view, out;  // view: empty is the case's own
    float yaw = kUsualYaw;
    uint32_t animate = 0;     // frames over the clip; 0: one picture
    bool difference = false;  // of two cases, beside them
};
int runRender(const RenderOptions& options);

struct InspectOptions {
    Selectors selectors;  // scene and words
    bool all = false;     // InspectSettings::all
    bool json = false;
};
int runInspect(const InspectOptions& options);

struct PartitionOptions {
    std::string scene, hardware = "generic", solver = "cheapest-insertion", order = "given";
    uint32_t slots = 0;  // of generic; 0: its default
    int influences = 4;
    bool json = false;
};
int runPartition(const PartitionOptions& options);

// The tables and figures of one thesis (common/theses/reproduce.h).
struct ReproduceOptions {
    std::string thesis;
    std::vector<std::string> scenes;  // empty: the built-in ones
    Selectors selectors;              // routes, copies, frames, rounds, size, device
    bool json = false;
    std::string out = "reproduce";  // folder of reproduce.md, reproduce.html and reproduce.json
};
int runReproduce(const ReproduceOptions& options);

int runSceneList(bool json);
int runSceneExport(const std::string& name, const std::string& out);

struct CompareOptions {
    std::string a, b;                 // b empty: pairs within a
    std::vector<std::string> pair;    // AXIS or AXIS=VALUE (PairAxis)
    std::optional<double> failAbove;  // percent
    bool allowMissing = false;        // by failAbove: B may lack cases of A
    bool json = false;
};
int runCompare(const CompareOptions& options);

// Files or folders with a results.json.
int runReport(const std::vector<std::string>& files, const std::string& out);

}  // namespace skinbench
