// What the subcommands share: the words of the command line, the selectors of bench and verify, opened devices.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/measure/bench.h"
#include "common/report/report.h"

namespace skinbench {

inline constexpr int kExitDone = 0, kExitFailed = 1, kExitBadInput = 2;

// Prints "skinbench: <text>" and gives the exit status of the fault.
int reportError(const Error& error);
void warn(const std::string& text);

// --- devices (devices.cpp) -------------------------------------------------------------------------------------

std::vector<Api> graphicsApis();
const char* apiName(Api api);
Result<std::vector<DeviceCaps>> listDevices(Api api);

// The backends that a run uses, one an API at the most.
struct Devices {
    std::vector<std::unique_ptr<Backend>> owned;
    Backends byApi;
    bool anyHardware = false;
    std::vector<DeviceCaps> caps;
};

// Opens what the routes need. An API that cannot be opened stays in `byApi` with its reason; only a device that was
// named and that no API has is an error.
Result<Devices> openDevices(const std::vector<const Route*>& needed, const BackendOptions& options);

// The route that a program should take, best first: mesh shaders before compute before the CPU, hardware before
// software, Vulkan before OpenGL, EXT before NV.
struct Choice {
    const Route* route = nullptr;
    const Variant* variant = nullptr;
    std::string reason;
};
Choice chooseRoute(const std::vector<DeviceCaps>& devices);

// --- selectors (selectors.cpp) ---------------------------------------------------------------------------------

// Lists are crossed. Empty lists mean every row of their table, but for what is said here.
struct Selectors {
    std::string scene = "builtin:biped";
    std::vector<std::string> routes, variants, codecs, builders, layouts, rasters, fetches, submissions, indexWrites;
    std::vector<std::string> culls, exchanges, scenarios, joints, loads, records, palettes;
    std::vector<std::string> ciGroupings, ciKeys, ciVertices;
    std::vector<std::string> computes;   // "plain", or options joined with +; empty: plain
    std::vector<uint32_t> ciMins;        // empty: the default
    std::vector<uint32_t> paletteSlots;  // empty: the default
    std::vector<std::string> meshlets;   // "64/124" or the name of such a pair
    std::vector<int> influences;         // empty: 4
    std::vector<uint32_t> groupSizes;    // empty: 32
    std::string shape = "given";
    std::string geometry = "welded";
    bool noCacheOrder = false;
    bool keepBackFaces = false;
    std::string clip;
    double seconds = 0.4;
    std::string pose = "animated";
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

// The crossed cases, without combinations that exist on no device (a mesh variant on a route without mesh shaders).
// A word that is in no table is an error that lists the table.
Result<std::vector<Case>> crossCases(const Selectors& selectors);

// --shape auto: times every shape of each mesh case for a few frames and gives the case its fastest.
Result<std::vector<Calibration>> calibrateShapes(Workload& workload, std::vector<Case>& cases, const Backends& backends,
                                                 const BenchSettings& settings);

// The settings with the devices' defaults filled in.
Result<WorkloadSettings> workloadSettings(const Selectors& selectors, bool anyHardware);
BenchSettings benchSettings(const Selectors& selectors, bool anyHardware);

Result<std::pair<uint32_t, uint32_t>> parseSize(const std::string& text);

// Loads the scene and the shaders, prints the scene's warnings to standard error.
Result<Workload> openWorkload(const std::string& scene, const WorkloadSettings& settings);

// --- running cases (running.cpp) -------------------------------------------------------------------------------

// The first SIGINT or SIGTERM ends the run after the current case; another one, more than a second later, at once.
void catchInterrupts();
bool interrupted();

// Progress on a terminal, the end at an interrupt, and what `context` tells of devices and durations; the checkpoint is
// left empty.
BenchEvents consoleEvents(RunContext& context);

// A checkpoint that takes no more than a tenth of the run, so a crash loses the cases of ten writes at the most.
Checkpoint nowAndThen(Checkpoint write);

// Everything but `bench` and `calibrations`. `scene` is the workload's, prepared.
RunContext runContext(const Devices& devices, const Workload& workload, const Scene& scene);

// The exit status; one line on standard error for what went wrong, the table has the rest.
int statusOf(const std::vector<CaseResult>& results);

// --- subcommands: options in, exit status out ------------------------------------------------------------------

struct RunOptions {
    Selectors selectors;
    bool timed = true;
    bool json = false;
    std::string out;  // folder of results.json, results.csv and report.html; empty: none
};
int runCases(const RunOptions& options);  // bench and verify

struct ProbeOptions {
    std::string device;
    bool json = false;
};
int runProbe(const ProbeOptions& options);

struct RenderOptions {
    Selectors selectors;
    std::string route = "auto", variant, codec = "uc", view = "shaded", out;
    float yaw = 25;  // degrees that a single character is turned by
};
int runRender(const RenderOptions& options);

struct InspectOptions {
    Selectors selectors;  // scene, meshlets, influences, ciKeys, ciMins
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

// The tables and figures of one of theses() (common/theses/reproduce.h).
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
    std::string a, b;
    std::optional<double> failAbove;  // percent
    bool json = false;
};
int runCompare(const CompareOptions& options);

int runReport(const std::vector<std::string>& files, const std::string& out);

}  // namespace skinbench
