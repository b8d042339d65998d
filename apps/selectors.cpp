#include <algorithm>
#include <charconv>
#include <format>
#include <set>

#include "apps/selectors.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

struct Preset {
    const char* name;
    const char* what;
    uint32_t copies, frames, warmup, rounds;
    std::vector<std::string> rasters;
    double precision, timeLimit;  // percent, seconds
};

const std::vector<Preset>& presets() {
    static const std::vector<Preset> rows = {
        {"quick", "does it work? default without a GPU", 2, 6, 1, 2, {"full"}, 1, 5},
        {"gpu", "default on a GPU", 100, 30, 5, 3, {"full"}, 1, 120},
        {"geometry", "what skinning costs", 200, 30, 5, 3, {"no-fragments", "discard"}, 1, 120},
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
        return inputError(std::format("{} '{}' is not two numbers, as in 640{}480", what, text, separator));
    auto a = parseNumber(text.substr(0, middle), what, most);
    SKINBENCH_TRY(a);
    auto b = parseNumber(text.substr(middle + 1), what, most);
    SKINBENCH_TRY(b);
    return std::pair{*a, *b};
}

std::string presetWords() { return tableNames(presets()); }
std::string geometryWords() { return tableNames(kGeometries); }

std::string presetTable() {
    constexpr auto kLine = "  {:<9} {:>6}  {:>6}  {:>6}  {:>6}  {:<21} {:>9}  {:>5}  {}\n";
    std::string text =
        std::format(kLine, "preset", "copies", "frames", "warmup", "rounds", "raster", "precision", "limit", "");
    text = text.substr(0, text.find_last_not_of(" \n") + 1) + "\n";
    for (const Preset& preset : presets()) {
        std::string rasters;
        for (const std::string& raster : preset.rasters) rasters += (rasters.empty() ? "" : ",") + raster;
        text +=
            std::format(kLine, preset.name, preset.copies, preset.frames, preset.warmup, preset.rounds, rasters,
                        std::format("{:g} %", preset.precision), std::format("{:g} s", preset.timeLimit), preset.what);
    }
    return text;
}

// Insertions, deletions, replacements and swaps of neighbours (the optimal string alignment distance).
static size_t editsBetween(const std::string& a, const std::string& b) {
    std::vector<std::vector<size_t>> edits(a.size() + 1, std::vector<size_t>(b.size() + 1));
    for (size_t i = 0; i <= a.size(); ++i)
        for (size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                edits[i][j] = i + j;
                continue;
            }
            edits[i][j] = std::min(
                {edits[i - 1][j] + 1, edits[i][j - 1] + 1, edits[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                edits[i][j] = std::min(edits[i][j], edits[i - 2][j - 2] + 1);
        }
    return edits[a.size()][b.size()];
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& words) {
    constexpr size_t kLongest = 40;
    if (word.empty() || word.size() > kLongest) return {};
    std::vector<std::string> longer;
    for (const std::string& other : words)
        if (word.size() > 1 && other.starts_with(word)) longer.push_back(other);
    if (longer.size() == 1) return longer.front();
    std::string nearest;
    size_t fewest = std::min<size_t>(3, word.size() / 3 + 1);
    for (const std::string& other : words)
        if (const size_t edits = editsBetween(word, other); edits < fewest) {
            fewest = edits;
            nearest = other;
        }
    return nearest;
}

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
        if (!std::ranges::contains(cases, caseId(*parsed), caseId)) cases.push_back(*parsed);
    }
    return cases;
}

Result<std::vector<Case>> crossedOnce(const std::vector<AxisWords>& crossings) {
    std::vector<Case> cases;
    std::set<std::string> known;
    std::optional<Error> firstError;
    for (const AxisWords& words : crossings) {
        auto crossed = crossCases(words);
        if (!crossed && !firstError) firstError = crossed.error();
        if (!crossed) continue;
        for (const Case& c : *crossed)
            if (known.insert(caseId(c)).second) cases.push_back(c);
    }
    // A route may lack some of the crossings; that it has none, or does not exist, is an error.
    if (cases.empty()) return std::unexpected(*firstError);
    return cases;
}

Result<bool> namesAuto(const std::vector<std::string>& routes) {
    if (!std::ranges::contains(routes, "auto")) return false;
    if (routes.size() > 1) return inputError("route auto is used alone, not beside others");
    return true;
}

Result<std::pair<uint32_t, uint32_t>> parseSize(const std::string& text) {
    return parsePair(text, 'x', "--size", 16384);
}

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
    if (s.characterPixels > 0 && settings.camera != Camera::crowd)
        return inputError("--character-pixels sizes the characters of camera crowd, not of " + s.camera);
    settings.characterPixels = static_cast<float>(s.characterPixels);
    settings.clip = s.clip;
    settings.seconds = static_cast<float>(s.seconds);
    settings.copies = s.copies ? s.copies : presetOf(s, anyHardware).copies;
    return settings;
}

BenchSettings benchSettings(const Selectors& s, bool anyHardware) {
    const Preset& preset = presetOf(s, anyHardware);
    const uint32_t rounds = s.selfTest ? std::max(kSelfTestRounds, preset.rounds) : preset.rounds;
    BenchSettings settings;
    const uint32_t asked = s.rounds ? s.rounds : rounds;
    settings.frames = s.frames ? s.frames : std::max(asked, preset.frames);
    settings.warmup = s.warmupGiven ? s.warmup : preset.warmup;
    settings.rounds = std::min(asked, settings.frames);
    if (s.rounds > settings.rounds)
        warn(std::format("--rounds {} share --frames {}, at least one each: {}", s.rounds, settings.frames,
                         counted(settings.rounds, "round")));
    const bool fixed = s.frames || s.rounds;
    settings.precision = (s.precision >= 0 ? s.precision : fixed ? 0 : preset.precision) / 100;
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
    for (const std::string& warning : scene->warnings) warn(name + ": " + warning);
    return makeWorkload(std::move(*scene), std::move(*shaders), settings);
}

std::string viewWarning(const Workload& workload, const InView& seen) {
    const WorkloadSettings& settings = workload.settings;
    if (seen.vertices == 1 || settings.camera != Camera::crowd || settings.characterPixels > 0) return {};
    return std::format(
        "{}: {:.3g} % of the vertices leave the image in the first frame, so that their triangles are not "
        "all rasterised",
        workload.stored.name, (1 - seen.vertices) * 100);
}

static Result<void> checkCulled(const Case& c) {
    if (c.scenario == Scenario::prepass)
        return inputError(
            "view culled shows no pre-pass, whose image is drawn where the depth is equal: what is culled has none");
    if (verdictsOf(c).size() > 1) return {};
    if (c.clusterCull != ClusterCull::off)
        return inputError("view culled needs a test to show; leave out --cluster-tests none");
    if (c.variant->listsTriangles)
        return inputError("view culled needs a test to show; leave out --triangle-tests none");
    if (c.variant->cullsMeshlets)
        return inputError("view culled needs a case that culls; add --cluster-cull or --cull");
    return inputError(std::string("view culled needs a variant that culls, not ") + c.variant->name +
                      ": compute-cull, or mesh, mesh-ci or compute-mesh with --cluster-cull or --cull");
}

Result<void> checkView(const Case& c) {
    if (c.view == View::meshlets && !c.builder)
        return inputError(std::string("view meshlets needs a mesh route, not ") + c.route->name);
    if (c.view == View::velocity && !c.compute.previous)
        return inputError("view velocity needs --variant compute --compute previous");
    if (c.view == View::culled) return checkCulled(c);
    if (c.view == View::shaded || c.view == View::normals || c.view == View::velocity) return {};
    if (c.variant->readsSkinned || (!c.builder && !c.variant->fetches))
        return inputError(std::string("view ") + findAxis("view")->get(c) +
                          " needs a variant that reads the codec's vertices where it draws: vertex or mesh");
    return {};
}

std::optional<std::string> reasonAgainst(const Case& c, const Backends& backends) {
    if (c.route->api == Api::cpu) return "route cpu draws nothing";
    const OpenBackend& open = backends.at(c.route->api);
    if (!open.backend) return open.missing;
    if (auto reason = unsupported(c, open.backend->caps())) return reason;
    if (auto possible = checkView(c); !possible) return possible.error().text;
    return std::nullopt;
}

}  // namespace skinbench
