// From the words of the command line to cases: each list is an axis, and the axes that mean something to a case are
// crossed.
#include <algorithm>
#include <charconv>
#include <format>
#include <functional>
#include <optional>
#include <ranges>

#include "apps/selectors.h"

namespace skinbench {
namespace {

const std::vector<Word<RasterMode>> kRasters = {
    {"full", RasterMode::full}, {"no-fragments", RasterMode::noFragments}, {"discard", RasterMode::discard}};
const std::vector<Word<VertexFetch>> kFetches = {{"attributes", VertexFetch::attributes}, {"pull", VertexFetch::pull}};
const std::vector<Word<Submission>> kSubmissions = {{"per-copy", Submission::perCopy},
                                                    {"batched", Submission::batched}};
const std::vector<Word<bool>> kIndexWrites = {{"packed", true}, {"single", false}};
const std::vector<Word<Cull>> kCulls = {
    {"off", Cull::off}, {"compact", Cull::compact}, {"primitive", Cull::primitive}, {"torabi", Cull::torabi}};
const std::vector<Word<Exchange>> kExchanges = {
    {"auto", Exchange::automatic}, {"shuffle", Exchange::shuffle}, {"shared", Exchange::shared}};
const std::vector<Word<Scenario>> kScenarios = {{"direct", Scenario::direct}, {"prepass", Scenario::prepass}};
const std::vector<Word<JointSource>> kJoints = {
    {"vertex", JointSource::vertex}, {"meshlet", JointSource::meshlet}, {"staged", JointSource::staged}};
const std::vector<Word<bool>> kLoads = {{"guarded", false}, {"clamped", true}};
const std::vector<Word<bool>> kRecords = {{"indexed", false}, {"ordered", true}};
const std::vector<Word<bool>> kPalettes = {{"storage", false}, {"uniform", true}};
const std::vector<Word<CiGrouping>> kCiGroupings = {{"meshlets", CiGrouping::meshlets},
                                                    {"triangles", CiGrouping::triangles}};
const std::vector<Word<CiKey>> kCiKeys = {{"fit", CiKey::fit}, {"set", CiKey::set}, {"ordered", CiKey::ordered}};
const std::vector<Word<bool>> kCiVertices = {{"slim", false}, {"fat", true}};

// Meshlet limits that the literature and the vendors name.
const std::vector<Word<MeshletLimits>> kLimits = {
    {"nvidia", {64, 126}}, {"meshopt", {64, 124}}, {"nvidia-84", {64, 84}},
    {"square", {64, 64}},  {"half", {64, 96}},     {"amd", {128, 256}},
};

Result<std::vector<MeshletLimits>> parseLimits(const std::vector<std::string>& words) {
    std::vector<MeshletLimits> limits;
    for (const std::string& word : words) {
        if (auto named = std::ranges::find(kLimits, word, &Word<MeshletLimits>::name); named != kLimits.end()) {
            limits.push_back(named->value);
            continue;
        }
        if (word.find('/') == std::string::npos)
            return inputError("no meshlet limits '" + word + "'; there is " + tableNames(kLimits) +
                              ", or VERTICES/TRIANGLES");
        auto pair = parsePair(word, '/', "meshlet limits", 512);
        if (!pair) return std::unexpected(pair.error());
        if (pair->first < 3 || pair->first > 255 || pair->second < 4)
            return inputError("meshlet limits '" + word + "' must lie between 3/4 and 255/512");
        limits.push_back({pair->first, pair->second});
    }
    if (limits.empty()) limits.push_back({});
    return limits;
}

// "plain", or words of computeWords() joined with +.
Result<std::vector<ComputeOptions>> parseComputes(const std::vector<std::string>& words) {
    std::vector<ComputeOptions> all;
    for (const std::string& word : words) {
        ComputeOptions options;
        for (const auto part : std::views::split(word, '+')) {
            const std::string name(part.begin(), part.end());
            const auto row = std::ranges::find(computeWords(), name, &ComputeWord::name);
            if (row != computeWords().end())
                options.*row->option = true;
            else if (word != "plain")
                return inputError(std::format("no compute option '{}'; there is {}, which may be joined with +", name,
                                              selectorWords("compute")));
        }
        if (std::ranges::find(all, options) == all.end()) all.push_back(options);
    }
    if (all.empty()) all.push_back({});
    return all;
}

// Rows of codecs(), or any other that findCodec knows.
Result<std::vector<const Codec*>> parseCodecs(const std::vector<std::string>& words) {
    std::vector<const Codec*> chosen;
    for (const std::string& word : words) {
        const Codec* const codec = findCodec(word);
        if (!codec)
            return inputError(
                std::format("no codec '{}'; there is {}, and pc16, pc24 to pc64", word, selectorWords("codecs")));
        if (std::ranges::find(chosen, codec) == chosen.end()) chosen.push_back(codec);
    }
    return chosen;
}

bool onMeshRoute(const Case& which) { return which.route->dialect != MeshDialect::none; }
bool onNvRoute(const Case& which) { return which.route->dialect == MeshDialect::nv; }
bool draws(const Case& which) { return which.route->api != Api::cpu; }
bool fetches(const Case& which) { return which.variant->fetches && !onMeshRoute(which); }
bool pulls(const Case& which) { return fetches(which) && !feedsAttributes(*which.codec); }
bool choosesFetch(const Case& which) { return fetches(which) && !pulls(which); }
bool skinsMeshlets(const Case& which) { return onMeshRoute(which) && which.variant->skins; }
bool choosesJoints(const Case& which) { return skinsMeshlets(which) && !sharesJointLists(which); }
bool culls(const Case& which) { return which.cull != Cull::off; }
bool prepasses(const Case& which) { return which.variant->prepasses; }
bool skinsInCompute(const Case& which) { return which.variant == findVariant("compute"); }
bool groupsTriangles(const Case& which) {
    return sharesJointLists(which) && which.common.grouping == CiGrouping::triangles;
}

// The cases so far, and the first word that is in no table.
struct Crossing {
    std::vector<Case> cases;
    std::optional<Error> error;

    template <class Value>
    void by(const std::vector<Value>& values, bool (*applies)(const Case&),
            const std::function<void(Case&, const Value&)>& set) {
        std::vector<Case> crossed;
        for (const Case& which : cases) {
            if (!applies(which)) {
                crossed.push_back(which);
                continue;
            }
            for (const Value& value : values) set(crossed.emplace_back(which), value);
        }
        cases = std::move(crossed);
    }

    template <class Row>
    void byRows(const std::vector<Row>& table, const std::vector<std::string>& words, const char* kind,
                bool (*applies)(const Case&), const std::function<void(Case&, const Row&)>& set) {
        auto rows = chosenRows(table, words, kind);
        if (!rows) {
            if (!error) error = rows.error();
            return;
        }
        std::vector<const Row*> chosen = *rows;
        by<const Row*>(chosen, applies, [&](Case& which, const Row* const& row) { set(which, *row); });
    }

    template <class Value>
    void byWords(const std::vector<Word<Value>>& table, const std::vector<std::string>& words, const char* kind,
                 bool (*applies)(const Case&), const std::function<void(Case&, const Value&)>& set) {
        byRows<Word<Value>>(table, words, kind, applies,
                            [&](Case& which, const Word<Value>& word) { set(which, word.value); });
    }
};

std::vector<std::string> orDefault(const std::vector<std::string>& words, const char* byDefault) {
    return words.empty() ? std::vector<std::string>{byDefault} : words;
}

Result<void> crossMeshlets(Crossing& all, const Selectors& s) {
    auto limits = parseLimits(s.meshlets);
    if (!limits) return std::unexpected(limits.error());
    const std::vector<uint32_t> groupSizes = s.groupSizes.empty() ? std::vector<uint32_t>{32} : s.groupSizes;
    for (uint32_t size : groupSizes)
        if (size == 0 || size > 1024) return inputError("a mesh work group has 1 to 1024 invocations");
    all.byRows<Builder>(builders(), orDefault(s.builders, "meshopt"), "builder", onMeshRoute,
                        [](Case& c, const Builder& row) { c.builder = &row; });
    all.byRows<MeshletLayout>(meshletLayouts(), orDefault(s.layouts, "redirect"), "layout", onMeshRoute,
                              [](Case& c, const MeshletLayout& row) { c.layout = &row; });
    all.by<MeshletLimits>(*limits, onMeshRoute, [](Case& c, const MeshletLimits& value) { c.limits = value; });
    all.by<uint32_t>(groupSizes, onMeshRoute, [](Case& c, const uint32_t& value) { c.groupSize = value; });
    all.byWords<bool>(kIndexWrites, orDefault(s.indexWrites, "packed"), "index write", onNvRoute,
                      [](Case& c, bool value) { c.packedWrites = value; });
    all.byWords<CiGrouping>(kCiGroupings, orDefault(s.ciGroupings, "meshlets"), "common-influence grouping",
                            sharesJointLists, [](Case& c, CiGrouping value) { c.common.grouping = value; });
    all.byWords<CiKey>(kCiKeys, orDefault(s.ciKeys, ciKeyName(CommonInfluences{}.key)), "common-influence key",
                       groupsTriangles, [](Case& c, CiKey value) { c.common.key = value; });
    all.byWords<bool>(kCiVertices, orDefault(s.ciVertices, "slim"), "kind of common-influence vertices",
                      sharesJointLists, [](Case& c, bool value) { c.common.fat = value; });
    if (!s.ciMins.empty())
        all.by<uint32_t>(s.ciMins, sharesJointLists,
                         [](Case& c, const uint32_t& value) { c.common.minVertices = value; });
    all.byWords<JointSource>(kJoints, orDefault(s.joints, "vertex"), "joint source", choosesJoints,
                             [](Case& c, JointSource value) { c.shape.joints = value; });
    all.byWords<bool>(kLoads, orDefault(s.loads, "guarded"), "kind of loads", onMeshRoute,
                      [](Case& c, bool value) { c.shape.clampedLoads = value; });
    all.byWords<bool>(kRecords, orDefault(s.records, "indexed"), "order of records", onMeshRoute,
                      [](Case& c, bool value) { c.shape.orderedRecords = value; });
    all.byWords<bool>(kPalettes, orDefault(s.palettes, "storage"), "palette buffer", skinsMeshlets,
                      [](Case& c, bool value) { c.shape.uniformPalette = value; });
    all.byWords<Cull>(kCulls, orDefault(s.culls, "off"), "culling", skinsMeshlets,
                      [](Case& c, Cull value) { c.cull = value; });
    all.byWords<Exchange>(kExchanges, orDefault(s.exchanges, "auto"), "exchange", culls,
                          [](Case& c, Exchange value) { c.exchange = value; });
    return {};
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
    if (option == "meshlets") return tableNames(kLimits);
    if (option == "cull") return tableNames(kCulls);
    if (option == "exchange") return tableNames(kExchanges);
    if (option == "scenario") return tableNames(kScenarios);
    if (option == "joints") return tableNames(kJoints);
    if (option == "loads") return tableNames(kLoads);
    if (option == "records") return tableNames(kRecords);
    if (option == "palette") return tableNames(kPalettes);
    if (option == "ci-grouping") return tableNames(kCiGroupings);
    if (option == "ci-key") return tableNames(kCiKeys);
    if (option == "compute") return "plain, " + tableNames(computeWords());
    if (option == "ci-vertices") return tableNames(kCiVertices);
    return {};
}

Result<std::vector<Case>> crossCases(const Selectors& s) {
    Crossing all;
    auto everyRow = [](const Case&) { return true; };
    all.cases.push_back({});
    all.cases.front().keepBackFaces = s.keepBackFaces;
    all.byRows<Variant>(variants(), s.variants, "variant", everyRow,
                        [](Case& c, const Variant& row) { c.variant = &row; });
    all.byRows<Route>(routes(), s.routes, "route", everyRow, [](Case& c, const Route& row) { c.route = &row; });
    if (all.error) return std::unexpected(*all.error);
    std::erase_if(all.cases, [](const Case& c) { return !runsOn(*c.variant, *c.route); });
    auto chosen = parseCodecs(orDefault(s.codecs, "uc"));
    if (!chosen) return std::unexpected(chosen.error());
    all.by<const Codec*>(*chosen, everyRow, [](Case& c, const Codec* const& row) { c.codec = row; });
    if (all.error) return std::unexpected(*all.error);
    // The CPU skins the vertices themselves.
    std::erase_if(all.cases, [](const Case& c) { return c.variant->onCpuRoute && !feedsAttributes(*c.codec); });
    if (auto crossed = crossMeshlets(all, s); !crossed) return std::unexpected(crossed.error());
    const std::vector<int> influences = s.influences.empty() ? std::vector<int>{4} : s.influences;
    for (int count : influences)
        if (count != 4 && count != 8) return inputError("influences must be 4 or 8");
    auto computes = parseComputes(s.computes);
    if (!computes) return std::unexpected(computes.error());
    auto rasters = chosenRasters(s);
    if (!rasters) return std::unexpected(rasters.error());
    all.byWords<VertexFetch>(kFetches, s.fetches, "vertex fetch", choosesFetch,
                             [](Case& c, VertexFetch value) { c.fetch = value; });
    all.byWords<VertexFetch>(kFetches, orDefault(s.fetches, "pull"), "vertex fetch", pulls,
                             [](Case& c, VertexFetch value) { c.fetch = value; });
    for (uint32_t slots : s.paletteSlots)
        if (slots == 0 || slots > UINT16_MAX) return inputError("a palette has 1 to 65535 slots");
    if (!s.paletteSlots.empty())
        all.by<uint32_t>(s.paletteSlots, usesPartition, [](Case& c, const uint32_t& value) { c.paletteSlots = value; });
    all.by<ComputeOptions>(*computes, skinsInCompute, [](Case& c, const ComputeOptions& value) { c.compute = value; });
    all.by<int>(influences, everyRow, [](Case& c, const int& value) { c.influences = value; });
    all.byWords<Submission>(kSubmissions, orDefault(s.submissions, "per-copy"), "submission", draws,
                            [](Case& c, Submission value) { c.submission = value; });
    all.byWords<Scenario>(kScenarios, orDefault(s.scenarios, "direct"), "scenario", prepasses,
                          [](Case& c, Scenario value) { c.scenario = value; });
    all.byWords<RasterMode>(kRasters, *rasters, "raster mode", draws,
                            [](Case& c, RasterMode value) { c.raster = value; });
    if (all.error) return std::unexpected(*all.error);
    if (all.cases.empty())
        return inputError(
            "none of these variants exists on these routes: vertex, compute and cpu run on vk and gl, "
            "mesh on vk-ext, vk-nv, gl-ext and gl-nv");
    return std::move(all.cases);
}

}  // namespace skinbench
