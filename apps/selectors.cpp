#include <algorithm>
#include <charconv>
#include <format>

#include "apps/selectors.h"

namespace skinbench {
namespace {

struct Preset {
    const char* name;
    const char* what;
    uint32_t copies, frames, warmup, rounds;
    double timeLimit;  // seconds
    std::vector<std::string> rasters;
};

const std::vector<Preset>& presets() {
    static const std::vector<Preset> rows = {
        {"quick", "2 copies, 6 frames: does it work", 2, 6, 1, 2, 5, {"full"}},
        {"gpu", "100 copies, 30 frames or more", 100, 30, 5, 3, 120, {"full"}},
        {"geometry",
         "200 copies, 30 frames or more, no fragments and rasteriser discard: what skinning costs",
         200,
         30,
         5,
         3,
         120,
         {"no-fragments", "discard"}},
    };
    return rows;
}

// With three rounds that differ, intervals are too narrow: one equal pair in ten is told apart by chance.
constexpr uint32_t kSelfTestRounds = 8;

const Preset& presetOf(const Selectors& selectors, bool anyHardware) {
    for (const Preset& preset : presets())
        if (selectors.preset == preset.name) return preset;
    return presets()[anyHardware ? 1 : 0];
}

const std::vector<Word<Geometry>> kGeometries = {
    {"welded", Geometry::welded}, {"stored", Geometry::stored}, {"unwelded", Geometry::unwelded}};

Result<uint32_t> parseNumber(const std::string& text, const char* what, uint32_t most) {
    uint32_t value = 0;
    auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc{} || end != text.data() + text.size() || value == 0 || value > most)
        return inputError(std::format("{} '{}' is not a number from 1 to {}", what, text, most));
    return value;
}

}  // namespace

Result<std::pair<uint32_t, uint32_t>> parsePair(const std::string& text, char separator, const char* what,
                                                uint32_t most) {
    const size_t middle = text.find(separator);
    if (middle == std::string::npos)
        return inputError(std::format("{} '{}' is not of the form A{}B", what, text, separator));
    auto a = parseNumber(text.substr(0, middle), what, most);
    SKINBENCH_TRY(a);
    auto b = parseNumber(text.substr(middle + 1), what, most);
    SKINBENCH_TRY(b);
    return std::pair{*a, *b};
}

std::string presetWords() { return tableNames(presets()); }
std::string geometryWords() { return tableNames(kGeometries); }

std::vector<std::string> presetRasters(const Selectors& s) { return presetOf(s, false).rasters; }

Result<std::vector<Case>> selectedCases(const Selectors& s) {
    if (!s.preset.empty() && std::ranges::none_of(presets(), [&](const Preset& p) { return s.preset == p.name; }))
        return inputError(std::format("no preset '{}'; there is {}", s.preset, presetWords()));
    AxisWords words = s.words;
    if (s.caseIds.empty()) {
        if (words["raster"].empty()) words["raster"] = presetRasters(s);
        return crossCases(words);
    }
    for (const auto& [name, values] : words)
        if (!values.empty())
            return inputError(
                std::format("--case names whole cases, so --{} has no place beside it", findAxis(name)->option.name));
    std::vector<Case> cases;
    for (const std::string& id : s.caseIds) {
        auto parsed = parseCaseId(id);
        SKINBENCH_TRY(parsed);
        cases.push_back(*parsed);
    }
    return cases;
}

Result<std::pair<uint32_t, uint32_t>> parseSize(const std::string& text) { return parsePair(text, 'x', "size", 16384); }

Result<WorkloadSettings> workloadSettings(const Selectors& s, bool anyHardware) {
    WorkloadSettings settings;
    auto size = parseSize(s.size);
    SKINBENCH_TRY(size);
    settings.width = size->first;
    settings.height = size->second;
    auto geometry = chosenRows(kGeometries, {s.geometry}, "geometry");
    SKINBENCH_TRY(geometry);
    settings.prepare.geometry = geometry->front()->value;
    settings.prepare.cacheOrder = !s.noCacheOrder;
    if (s.pose != "frozen" && s.pose != "animated")
        return inputError("no pose '" + s.pose + "'; there is frozen, animated");
    settings.animated = s.pose == "animated";
    const auto camera = std::ranges::find(cameraNames(), s.camera);
    if (camera == cameraNames().end())
        return inputError("no camera '" + s.camera + "'; there is crowd, half, inside, close");
    settings.camera = static_cast<Camera>(camera - cameraNames().begin());
    settings.clip = s.clip;
    settings.seconds = static_cast<float>(s.seconds);
    settings.copies = s.copies ? s.copies : presetOf(s, anyHardware).copies;
    return settings;
}

BenchSettings benchSettings(const Selectors& s, bool anyHardware) {
    const Preset& preset = presetOf(s, anyHardware);
    const uint32_t rounds = s.selfTest ? std::max(kSelfTestRounds, preset.rounds) : preset.rounds;
    BenchSettings settings;
    settings.frames = s.frames ? s.frames : std::max(rounds, preset.frames);
    settings.warmup = s.warmupGiven ? s.warmup : preset.warmup;
    settings.rounds = std::min(s.rounds ? s.rounds : rounds, settings.frames);
    const bool fixed = s.frames || s.rounds;
    settings.precision = (s.precision >= 0 ? s.precision : fixed ? 0 : 1) / 100;
    settings.timeLimit = s.timeLimit >= 0 ? s.timeLimit : preset.timeLimit;
    settings.limits = true;
    settings.selfTest = s.selfTest;
    // A pair kept in two places of the memory would differ alike in every round, which no interval tells.
    settings.freshPlacement = s.placement.empty() ? s.selfTest : s.placement == "fresh";
    settings.seed = s.seed;
    settings.tolerance = s.tolerance;
    return settings;
}

Result<Workload> openWorkload(const std::string& name, const WorkloadSettings& settings) {
    auto folder = findShaderFolder();
    SKINBENCH_TRY(folder);
    auto shaders = loadShaders(*folder);
    SKINBENCH_TRY(shaders);
    auto scene = loadScene(name);
    SKINBENCH_TRY(scene);
    for (const std::string& warning : scene->warnings) warn(scene->name + ": " + warning);
    return makeWorkload(std::move(*scene), std::move(*shaders), settings);
}

std::string viewWarning(const Workload& workload, double shareOutOfView) {
    if (shareOutOfView == 0 || workload.settings.camera != Camera::crowd) return {};
    return std::format(
        "{}: {:.3g} % of the vertices leave the image in the first frame, so that their triangles are not "
        "all rasterised",
        workload.stored.name, shareOutOfView * 100);
}

}  // namespace skinbench
