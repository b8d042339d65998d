#include <algorithm>
#include <charconv>
#include <format>
#include <optional>
#include <span>

#include "apps/apps.h"

namespace skinbench {
namespace {

struct Preset {
    const char* name;
    const char* what;
    uint32_t copies, frames, warmup, rounds;
    std::vector<const char*> rasters;
};

const std::vector<Preset>& presets() {
    static const std::vector<Preset> rows = {
        {"quick", "4 copies, 6 frames: does it work", 4, 6, 1, 2, {"full"}},
        {"gpu", "100 copies, 60 frames", 100, 60, 5, 3, {"full"}},
        {"geometry",
         "200 copies, 60 frames, no fragments and rasteriser discard: what skinning costs",
         200,
         60,
         5,
         3,
         {"no-fragments", "discard"}},
    };
    return rows;
}

const Preset& presetOf(const Selectors& selectors, bool anyHardware) {
    for (const Preset& preset : presets())
        if (selectors.preset == preset.name) return preset;
    return presets()[anyHardware ? 1 : 0];
}

template <class Row>
std::string tableNames(const std::vector<Row>& rows) {
    std::string names;
    for (const Row& row : rows) names += (names.empty() ? "" : ", ") + std::string(row.name);
    return names;
}

// The rows that the words name, or all rows for no words.
template <class Row>
Result<std::vector<const Row*>> chosenRows(const std::vector<Row>& rows, const std::vector<std::string>& words,
                                           const char* kind) {
    std::vector<const Row*> chosen;
    if (words.empty())
        for (const Row& row : rows) chosen.push_back(&row);
    for (const std::string& word : words) {
        auto row = std::ranges::find_if(rows, [&](const Row& candidate) { return word == candidate.name; });
        if (row == rows.end()) return inputError(std::format("no {} '{}'; there is {}", kind, word, tableNames(rows)));
        if (std::ranges::find(chosen, &*row) == chosen.end()) chosen.push_back(&*row);
    }
    return chosen;
}

template <class Value>
struct Word {
    const char* name;
    Value value;
};

const std::vector<Word<RasterMode>> kRasters = {
    {"full", RasterMode::full}, {"no-fragments", RasterMode::noFragments}, {"discard", RasterMode::discard}};
const std::vector<Word<VertexFetch>> kFetches = {{"attributes", VertexFetch::attributes}, {"pull", VertexFetch::pull}};
const std::vector<Word<Submission>> kSubmissions = {{"per-copy", Submission::perCopy},
                                                    {"batched", Submission::batched}};
const std::vector<Word<bool>> kIndexWrites = {{"packed", true}, {"single", false}};
const std::vector<Word<Geometry>> kGeometries = {
    {"welded", Geometry::welded}, {"stored", Geometry::stored}, {"unwelded", Geometry::unwelded}};

Result<uint32_t> parseNumber(const std::string& text, const char* what, uint32_t most) {
    uint32_t value = 0;
    auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failed != std::errc{} || end != text.data() + text.size() || value == 0 || value > most)
        return inputError(std::format("{} '{}' is not a number from 1 to {}", what, text, most));
    return value;
}

Result<std::pair<uint32_t, uint32_t>> parsePair(const std::string& text, char separator, const char* what,
                                                uint32_t most) {
    const size_t middle = text.find(separator);
    if (middle == std::string::npos)
        return inputError(std::format("{} '{}' is not of the form A{}B", what, text, separator));
    auto a = parseNumber(text.substr(0, middle), what, most);
    if (!a) return std::unexpected(a.error());
    auto b = parseNumber(text.substr(middle + 1), what, most);
    if (!b) return std::unexpected(b.error());
    return std::pair{*a, *b};
}

Result<std::vector<MeshletLimits>> parseLimits(const std::vector<std::string>& words) {
    std::vector<MeshletLimits> limits;
    for (const std::string& word : words) {
        auto pair = parsePair(word, '/', "meshlet limits", 512);
        if (!pair) return std::unexpected(pair.error());
        if (pair->first < 3 || pair->first > 255 || pair->second < 4)
            return inputError("meshlet limits '" + word + "' must lie between 3/4 and 255/512");
        limits.push_back({pair->first, pair->second});
    }
    if (limits.empty()) limits.push_back({});
    return limits;
}

// The rows and values to cross, looked up once.
struct Axes {
    std::vector<const Route*> routes;
    std::vector<const Variant*> variants;
    std::vector<const Codec*> codecs;
    std::vector<const Builder*> builders;
    std::vector<const MeshletLayout*> layouts;
    std::vector<const Word<RasterMode>*> rasters;
    std::vector<const Word<VertexFetch>*> fetches;
    std::vector<const Word<Submission>*> submissions;
    std::vector<const Word<bool>*> indexWrites;
    std::vector<MeshletLimits> limits;
    std::vector<int> influences;
    std::vector<uint32_t> groupSizes;
};

std::vector<std::string> orDefault(const std::vector<std::string>& words, const char* byDefault) {
    return words.empty() ? std::vector<std::string>{byDefault} : words;
}

template <class Row>
bool take(std::vector<const Row*>& into, Result<std::vector<const Row*>> rows, std::optional<Error>& error) {
    if (rows) {
        into = std::move(*rows);
        return true;
    }
    if (!error) error = rows.error();
    return false;
}

Result<Axes> lookUp(const Selectors& s) {
    Axes axes;
    std::optional<Error> error;
    std::vector<std::string> rasters = s.rasters;
    if (rasters.empty())
        for (const char* raster : presetOf(s, false).rasters) rasters.push_back(raster);
    if (!s.preset.empty() && std::ranges::none_of(presets(), [&](const Preset& p) { return s.preset == p.name; }))
        return inputError(std::format("no preset '{}'; there is {}", s.preset, tableNames(presets())));
    take(axes.routes, chosenRows(routes(), s.routes, "route"), error);
    take(axes.variants, chosenRows(variants(), s.variants, "variant"), error);
    take(axes.codecs, chosenRows(codecs(), s.codecs, "codec"), error);
    take(axes.builders, chosenRows(builders(), orDefault(s.builders, "meshopt"), "builder"), error);
    take(axes.layouts, chosenRows(meshletLayouts(), orDefault(s.layouts, "redirect"), "layout"), error);
    take(axes.rasters, chosenRows(kRasters, rasters, "raster mode"), error);
    take(axes.fetches, chosenRows(kFetches, s.fetches, "vertex fetch"), error);
    take(axes.submissions, chosenRows(kSubmissions, orDefault(s.submissions, "per-copy"), "submission"), error);
    take(axes.indexWrites, chosenRows(kIndexWrites, orDefault(s.indexWrites, "packed"), "index write"), error);
    if (error) return std::unexpected(*error);
    auto limits = parseLimits(s.meshlets);
    if (!limits) return std::unexpected(limits.error());
    axes.limits = *limits;
    axes.influences = s.influences.empty() ? std::vector<int>{4} : s.influences;
    for (int influences : axes.influences)
        if (influences != 4 && influences != 8) return inputError("influences must be 4 or 8");
    axes.groupSizes = s.groupSizes.empty() ? std::vector<uint32_t>{32} : s.groupSizes;
    for (uint32_t size : axes.groupSizes)
        if (size == 0 || size > 1024) return inputError("a mesh work group has 1 to 1024 invocations");
    return axes;
}

// The cases of one route, variant and codec: only the axes that mean something to them.
void crossOne(const Axes& axes, Case which, std::vector<Case>& cases) {
    const bool meshes = which.route->dialect != MeshDialect::none;
    const bool draws = which.route->api != Api::cpu;
    const bool fetches = which.variant->fetches && !meshes;
    const bool nv = which.route->dialect == MeshDialect::nv;
    auto only = [](auto& values, bool all) { return std::span(values).first(all ? values.size() : 1); };
    for (auto* builder : only(axes.builders, meshes))
        for (auto* layout : only(axes.layouts, meshes))
            for (const MeshletLimits& limits : only(axes.limits, meshes))
                for (uint32_t groupSize : only(axes.groupSizes, meshes))
                    for (auto* write : only(axes.indexWrites, nv))
                        for (auto* fetch : only(axes.fetches, fetches))
                            for (int influences : axes.influences)
                                for (auto* submission : only(axes.submissions, draws))
                                    for (auto* raster : only(axes.rasters, draws)) {
                                        if (meshes) {
                                            which.builder = builder;
                                            which.layout = layout;
                                            which.limits = limits;
                                            which.groupSize = groupSize;
                                        }
                                        if (nv) which.packedWrites = write->value;
                                        if (fetches) which.fetch = fetch->value;
                                        which.influences = influences;
                                        if (draws) which.submission = submission->value;
                                        if (draws) which.raster = raster->value;
                                        cases.push_back(which);
                                    }
}

}  // namespace

std::string selectorWords(const std::string& option) {
    if (option == "routes") return tableNames(routes());
    if (option == "variants") return tableNames(variants());
    if (option == "codecs") return tableNames(codecs());
    if (option == "builders") return tableNames(builders());
    if (option == "layouts") return tableNames(meshletLayouts());
    if (option == "raster") return tableNames(kRasters);
    if (option == "vertex-fetch") return tableNames(kFetches);
    if (option == "submission") return tableNames(kSubmissions);
    if (option == "index-writes") return tableNames(kIndexWrites);
    if (option == "geometry") return tableNames(kGeometries);
    if (option == "preset") return tableNames(presets());
    return {};
}

Result<std::vector<Case>> crossCases(const Selectors& selectors) {
    auto axes = lookUp(selectors);
    if (!axes) return std::unexpected(axes.error());
    std::vector<Case> cases;
    for (const Variant* variant : axes->variants)
        for (const Route* route : axes->routes) {
            if (!runsOn(*variant, *route)) continue;
            for (const Codec* codec : axes->codecs) {
                Case which;
                which.route = route;
                which.variant = variant;
                which.codec = codec;
                which.keepBackFaces = selectors.keepBackFaces;
                crossOne(*axes, which, cases);
            }
        }
    if (cases.empty())
        return inputError(
            "none of these variants exists on these routes: vertex, compute and cpu run on vk and gl, "
            "mesh on vk-ext, vk-nv, gl-ext and gl-nv");
    return cases;
}

Result<std::pair<uint32_t, uint32_t>> parseSize(const std::string& text) { return parsePair(text, 'x', "size", 16384); }

Result<WorkloadSettings> workloadSettings(const Selectors& s, bool anyHardware) {
    WorkloadSettings settings;
    auto size = parseSize(s.size);
    if (!size) return std::unexpected(size.error());
    settings.width = size->first;
    settings.height = size->second;
    auto geometry = chosenRows(kGeometries, {s.geometry}, "geometry");
    if (!geometry) return std::unexpected(geometry.error());
    settings.prepare.geometry = geometry->front()->value;
    settings.prepare.cacheOrder = !s.noCacheOrder;
    if (s.pose != "frozen" && s.pose != "animated")
        return inputError("no pose '" + s.pose + "'; there is frozen, animated");
    settings.animated = s.pose == "animated";
    settings.clip = s.clip;
    settings.seconds = static_cast<float>(s.seconds);
    settings.copies = s.copies ? s.copies : presetOf(s, anyHardware).copies;
    return settings;
}

BenchSettings benchSettings(const Selectors& s, bool anyHardware) {
    const Preset& preset = presetOf(s, anyHardware);
    BenchSettings settings;
    settings.frames = s.frames ? s.frames : preset.frames;
    settings.warmup = s.warmupGiven ? s.warmup : preset.warmup;
    settings.rounds = std::min(s.rounds ? s.rounds : preset.rounds, settings.frames);
    settings.seed = s.seed;
    settings.tolerance = s.tolerance;
    return settings;
}

Result<Workload> openWorkload(const std::string& name, const WorkloadSettings& settings) {
    auto folder = findShaderFolder();
    if (!folder) return std::unexpected(folder.error());
    auto shaders = loadShaders(*folder);
    if (!shaders) return std::unexpected(shaders.error());
    auto scene = loadScene(name);
    if (!scene) return std::unexpected(scene.error());
    for (const std::string& warning : scene->warnings) warn(scene->name + ": " + warning);
    return makeWorkload(std::move(*scene), std::move(*shaders), settings);
}

}  // namespace skinbench
