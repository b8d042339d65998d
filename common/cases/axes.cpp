// The rows. How ids, keys and crossings follow from them is in case_id.cpp and crossing.cpp.
#include "common/cases/axes.h"

#include <ranges>

#include "common/cases/axis_kinds.h"

namespace skinbench {
namespace {

// --- what a case must be for a row --------------------------------------------------------------------------------

bool onNvRoute(const Case& c) { return c.route->dialect == MeshDialect::nv; }
bool draws(const Case& c) { return c.route->api != Api::cpu; }
bool fetches(const Case& c) { return c.variant->fetches && !onMeshRoute(c); }
bool skinsMeshlets(const Case& c) { return onMeshRoute(c) && c.variant->skins; }
bool skinsInMesh(const Case& c) { return skinsMeshlets(c) && !c.variant->readsSkinned; }
bool choosesJoints(const Case& c) { return skinsInMesh(c) && !sharesJointLists(c); }
bool culls(const Case& c) { return c.cull != Cull::off; }
bool compacts(const Case& c) { return c.cull == Cull::compact; }
bool prepasses(const Case& c) { return c.variant->prepasses; }
bool skinsOnDevice(const Case& c) { return c.variant->skins && !c.variant->skinsOnHost; }
bool listsTriangles(const Case& c) { return c.variant->listsTriangles; }
bool cullsMeshlets(const Case& c) { return c.variant->cullsMeshlets; }
bool testsMeshlets(const Case& c) { return c.clusterCull != ClusterCull::off; }
bool skinsInCompute(const Case& c) { return c.variant->skinsInCompute; }
bool skinsFirst(const Case& c) { return skinsInCompute(c) || c.variant->readsSkinned || listsTriangles(c); }
bool groupsTriangles(const Case& c) { return sharesJointLists(c) && c.ci.grouping == CiGrouping::triangles; }

// --- rows that need more ---------------------------------------------------------------------------------------

// Rows of codecs(), or any other that findCodec knows, but for those that follow from where the joints are.
Axis codecAxis() {
    constexpr const char* kOthers = ", and wicked, pc16, pc24 to pc64";
    Axis axis =
        rowAxis<Codec>({.name = "codec", .option = {.name = "codecs", .help = kOthers}, .changes = Changes::encoding},
                       codecs(), "uc", [](Case& c) -> const Codec*& { return c.codec; });
    axis.set = [there = joined(axis.words) + kOthers](Case& c, const std::string& text) {
        const Codec* const codec = findCodec(text);
        const bool follows =
            std::ranges::any_of(codecs(), [&](const Codec& row) { return row.slim && text == row.slim; });
        if (!codec || follows) return Result<void>(inputError(std::format("no codec '{}'; there is {}", text, there)));
        c.codec = codec;
        return Result<void>{};
    };
    axis.ofLimit = "ids";
    axis.changesPicture = true;
    return axis;
}

// Meshlet limits that the literature and the vendors name.
const std::vector<Word<MeshletLimits>> kLimits = {
    {"nvidia", {64, 126}}, {"meshopt", {64, 124}}, {"nvidia-84", {64, 84}},
    {"square", {64, 64}},  {"half", {64, 96}},     {"amd", {128, 256}},
};

// "64/124", with any separator.
std::optional<MeshletLimits> limitsOf(std::string_view text, char separator) {
    const size_t middle = text.find(separator);
    if (middle == 0 || middle == std::string_view::npos || middle + 1 == text.size()) return std::nullopt;
    const auto vertices = numberOf(text.substr(0, middle), {3, 255, "", ""});
    const auto triangles = numberOf(text.substr(middle + 1), {4, 512, "", ""});
    if (!vertices || !triangles) return std::nullopt;
    return MeshletLimits{*vertices, *triangles};
}

std::string limitsText(const MeshletLimits& limits, char separator) {
    return std::format("{}{}{}", limits.vertices, separator, limits.triangles);
}

Axis limitsAxis() {
    Axis axis = startAxis({.name = "meshlet_limits",
                           .option = {.name = "meshlets", .help = ": limits of a meshlet; or VERTICES/TRIANGLES"},
                           .changes = Changes::meshlets,
                           .applies = onMeshRoute});
    for (const auto& named : kLimits) axis.words.push_back(named.word);
    axis.usual = limitsText({}, '/');
    axis.get = [](const Case& c) { return limitsText(c.limits, '/'); };
    axis.set = [there = joined(axis.words)](Case& c, const std::string& text) {
        const auto named = std::ranges::find(kLimits, text, &Word<MeshletLimits>::word);
        const auto limits = named != kLimits.end() ? std::optional(named->value) : limitsOf(text, '/');
        if (!limits && !text.contains('/'))
            return Result<void>(
                inputError("no meshlet limits '" + text + "'; there is " + there + ", or VERTICES/TRIANGLES"));
        if (!limits) return Result<void>(inputError("meshlet limits '" + text + "' must lie between 3/4 and 255/512"));
        c.limits = *limits;
        return Result<void>{};
    };
    axis.unnamed = [usual = axis.usual](const Case&) { return std::vector{usual}; };
    axis.idPart = [](const Case& c) { return c.limits == MeshletLimits{} ? "" : limitsText(c.limits, '-'); };
    axis.readIdPart = [](Case& c, std::string_view part) {
        const auto limits = limitsOf(part, '-');
        if (limits) c.limits = *limits;
        return limits.has_value();
    };
    axis.ofLimit = kSame;
    return axis;
}

struct Flag {
    const char* name;
    bool ComputeOptions::*option;
};
constexpr Flag kComputeFlags[] = {
    {"staged", &ComputeOptions::staged},
    {"previous", &ComputeOptions::previous},
    {"tangents", &ComputeOptions::tangents},
    {"early-exit", &ComputeOptions::earlyExit},
    {"packed", &ComputeOptions::packed},
    {"half-rate", &ComputeOptions::halfRate},
    {"short-tangents", &ComputeOptions::shortTangents},
    {"wicked", &ComputeOptions::wicked},
};

bool setFlag(ComputeOptions& options, std::string_view name) {
    const auto flag = std::ranges::find(kComputeFlags, name, &Flag::name);
    if (flag == std::end(kComputeFlags)) return false;
    options.*flag->option = true;
    return true;
}

std::string flagsOf(const Case& c) {
    std::string names;
    for (const Flag& flag : kComputeFlags)
        if (c.compute.*flag.option) names += (names.empty() ? "" : "+") + std::string(flag.name);
    return names;
}

Axis computeAxis() {
    Axis axis = startAxis(
        {.name = "compute", .option = {.help = ": options of compute, joined with +"}, .applies = skinsInCompute});
    axis.words = {"plain"};
    for (const Flag& flag : kComputeFlags) axis.words.push_back(flag.name);
    axis.usual = "plain";
    axis.get = [](const Case& c) { return c.compute == ComputeOptions{} ? "plain" : flagsOf(c); };
    axis.set = [there = joined(axis.words)](Case& c, const std::string& text) {
        c.compute = {};
        if (text == "plain") return Result<void>{};
        for (const auto part : std::views::split(text, '+')) {
            const std::string_view name(part.begin(), part.end());
            if (name == "plain")
                return Result<void>(inputError("compute option plain is used alone, not as in '" + text + "'"));
            if (!setFlag(c.compute, name))
                return Result<void>(inputError(std::format(
                    "no compute option '{}'; there is {}; all but plain may be joined with +", name, there)));
        }
        return Result<void>{};
    };
    axis.unnamed = [](const Case&) { return std::vector<std::string>{"plain"}; };
    axis.idPart = flagsOf;
    axis.readIdPart = [](Case& c, std::string_view part) { return setFlag(c.compute, part); };
    return axis;
}

// Where attributes cannot carry the codec there is one way left.
Axis fetchAxis() {
    Axis axis = wordAxis<VertexFetch>({.name = "vertex_fetch", .applies = fetches, .define = "FETCH_PULL"},
                                      {{"attributes", VertexFetch::attributes}, {"pull", VertexFetch::pull, "pull"}},
                                      [](Case& c) -> VertexFetch& { return c.fetch; });
    axis.unnamed = [words = axis.words](const Case& c) {
        return c.codec->feedsAttributes ? words : std::vector<std::string>{"pull"};
    };
    axis.ofLimit = "pull";
    return axis;
}

Axis same(Axis axis) {
    axis.ofLimit = kSame;
    return axis;
}

Axis otherWork(Axis axis) {
    axis.changesWork = true;
    return axis;
}

Axis topLevel(Axis axis) {
    axis.topLevel = true;
    return axis;
}

Axis asShape(Axis axis) {
    axis.shape = true;
    return axis;
}

// --- the table -------------------------------------------------------------------------------------------------

// What is drawn, where, from which vertices and meshlets: the path of an id.
void addPath(std::vector<Axis>& rows) {
    rows.push_back(same(rowAxis<Route>({.name = "route", .option = {.name = "routes", .help = ", or auto"}}, routes(),
                                       "", [](Case& c) -> const Route*& { return c.route; })));
    rows.push_back(rowAxis<Variant>({.name = "variant", .option = {.name = "variants"}}, variants(), "",
                                    [](Case& c) -> const Variant*& { return c.variant; }));
    rows.back().ofLimit = "none";
    rows.push_back(codecAxis());
    rows.push_back(same(rowAxis<Builder>(
        {.name = "builder", .option = {.name = "builders"}, .changes = Changes::meshlets, .applies = onMeshRoute},
        builders(), "meshopt", [](Case& c) -> const Builder*& { return c.builder; })));
    rows.push_back(same(rowAxis<MeshletLayout>(
        {.name = "layout", .option = {.name = "layouts"}, .applies = onMeshRoute}, meshletLayouts(), "redirect",
        [](Case& c) -> const MeshletLayout*& { return c.layout; })));
}

void addMeshStage(std::vector<Axis>& rows) {
    rows.push_back(limitsAxis());
    rows.push_back(
        same(numberAxis<uint32_t>({.name = "group_size",
                                   .option = {.help = "invocations of a mesh work group"},
                                   .applies = onMeshRoute,
                                   .define = "GROUP_SIZE"},
                                  {1, 1024, "group-", ""}, [](Case& c) -> uint32_t& { return c.groupSize; })));
    rows.push_back(same(wordAxis<bool>({.name = "index_writes",
                                        .option = {.help = ": how NV mesh stages write local indices"},
                                        .applies = onNvRoute,
                                        .noun = "index write",
                                        .define = "PACKED_WRITES"},
                                       {{"packed", true}, {"single", false, "unpacked-writes"}},
                                       [](Case& c) -> bool& { return c.packedWrites; })));
}

// The variant `mesh-ci`.
void addCommonInfluences(std::vector<Axis>& rows) {
    rows.push_back(
        wordAxis<CiGrouping>({.name = "ci_grouping",
                              .option = {.help = ": how mesh-ci finds common meshlets"},
                              .changes = Changes::records,
                              .applies = sharesJointLists},
                             {{ciGroupingName(CiGrouping::meshlets), CiGrouping::meshlets},
                              {ciGroupingName(CiGrouping::triangles), CiGrouping::triangles, "ci-triangles"}},
                             [](Case& c) -> CiGrouping& { return c.ci.grouping; }));
    rows.push_back(wordAxis<CiKey>({.name = "ci_key",
                                    .option = {.help = ": which triangles --ci-grouping triangles puts together"},
                                    .changes = Changes::records,
                                    .applies = groupsTriangles},
                                   {{ciKeyName(CiKey::fit), CiKey::fit},
                                    {ciKeyName(CiKey::set), CiKey::set, "ci-set"},
                                    {ciKeyName(CiKey::ordered), CiKey::ordered, "ci-ordered"}},
                                   [](Case& c) -> CiKey& { return c.ci.key; }));
    rows.back().beside = "ci_grouping";
    rows.push_back(numberAxis<uint32_t>({.name = "ci_min",
                                         .option = {.help = "fewest vertices of a common meshlet or group"},
                                         .changes = Changes::records,
                                         .applies = sharesJointLists},
                                        {0, UINT32_MAX, "ci-min-", ""},
                                        [](Case& c) -> uint32_t& { return c.ci.minVertices; }));
    rows.push_back(wordAxis<bool>({.name = "ci_vertices",
                                   .option = {.help = ": common meshlets' vertices without joint ids, or with"},
                                   .changes = Changes::encoding,
                                   .applies = sharesJointLists},
                                  {{"slim", false}, {"fat", true, "fat"}}, [](Case& c) -> bool& { return c.ci.fat; }));
}

// Shapes of the mesh shader.
void addShapes(std::vector<Axis>& rows) {
    rows.push_back(asShape(wordAxis<JointSource>({.name = "joints",
                                                  .option = {.help = ": where a mesh stage finds joint ids"},
                                                  .changes = Changes::encoding,
                                                  .applies = choosesJoints,
                                                  .noun = "joint source",
                                                  .define = "JOINTS"},
                                                 {{"vertex", JointSource::vertex},
                                                  {"meshlet", JointSource::meshlet, "joints-meshlet"},
                                                  {"staged", JointSource::staged, "joints-staged"}},
                                                 [](Case& c) -> JointSource& { return c.shape.joints; })));
    rows.push_back(asShape(wordAxis<bool>({.name = "loads",
                                           .option = {.help = ": skip or clamp loads past a meshlet's end"},
                                           .applies = onMeshRoute,
                                           .noun = "kind of loads",
                                           .define = "CLAMPED_LOADS"},
                                          {{"guarded", false}, {"clamped", true, "clamped-loads"}},
                                          [](Case& c) -> bool& { return c.shape.clampedLoads; })));
    rows.push_back(asShape(wordAxis<bool>({.name = "records",
                                           .option = {.help = ": read vertices by id, or copies of them in order"},
                                           .changes = Changes::records,
                                           .applies = onMeshRoute,
                                           .noun = "order of records",
                                           .define = "RECORDS_ORDERED"},
                                          {{"indexed", false}, {"ordered", true, "ordered-records"}},
                                          [](Case& c) -> bool& { return c.shape.orderedRecords; })));
    rows.back().ofLimit = "ordered";  // so that no vertex id is fetched
    rows.push_back(asShape(
        wordAxis<bool>({.name = "palette",
                        .option = {.name = "palette-buffer", .aliases = {"palette"}, .help = ": block for the palette"},
                        .applies = skinsInMesh,
                        .noun = "palette buffer"},
                       {{"storage", false}, {"uniform", true, "uniform-palette"}},
                       [](Case& c) -> bool& { return c.shape.uniformPalette; })));
}

// Whole meshlets that cannot be seen.
void addClusterCulling(std::vector<Axis>& rows) {
    rows.push_back(wordAxis<ClusterCull>({.name = "cluster_cull",
                                          .option = {.help = ": whole meshlets in a task stage or from a list"},
                                          .applies = cullsMeshlets,
                                          .noun = "culling of meshlets",
                                          .define = "CLUSTER_CULL"},
                                         {{"off", ClusterCull::off},
                                          {"task", ClusterCull::task, "cluster-task"},
                                          {"list", ClusterCull::list, "cluster-list"}},
                                         [](Case& c) -> ClusterCull& { return c.clusterCull; }));
    rows.push_back(wordAxis<uint32_t>({.name = "cluster_tests",
                                       .option = {.help = ": what meshlets are tested for"},
                                       .applies = testsMeshlets,
                                       .noun = "set of tests",
                                       .define = "CLUSTER_TESTS"},
                                      {{"frustum+cone", CLUSTER_TEST_FRUSTUM | CLUSTER_TEST_CONE},
                                       {"none", 0, "cluster-no-tests"},
                                       {"frustum", CLUSTER_TEST_FRUSTUM, "cluster-frustum"},
                                       {"cone", CLUSTER_TEST_CONE, "cluster-cone"}},
                                      [](Case& c) -> uint32_t& { return c.clusterTests; }));
    rows.back().beside = "cluster_cull";
    rows.push_back(wordAxis<ClusterBounds>({.name = "cluster_bounds",
                                            .option = {.help = ": bounds that the frustum test uses"},
                                            .applies = testsMeshlets,
                                            .noun = "kind of bounds",
                                            .define = "CLUSTER_BOUNDS"},
                                           {{"joint-spheres", ClusterBounds::jointSpheres},
                                            {"one-sphere", ClusterBounds::oneSphere, "one-sphere"},
                                            {"joint-boxes", ClusterBounds::jointBoxes, "joint-boxes"},
                                            {"instance", ClusterBounds::instance, "instance-box"}},
                                           [](Case& c) -> ClusterBounds& { return c.clusterBounds; }));
    rows.back().beside = "cluster_cull";
}

// How joints are read and blended.
void addSkinning(std::vector<Axis>& rows) {
    rows.push_back(wordAxis<Method>({.name = "method",
                                     .option = {.help = ": linear or dual quaternion blending"},
                                     .applies = skinsOnDevice,
                                     .define = "METHOD"},
                                    {{"lbs", Method::lbs}, {"dqs", Method::dqs, "dqs"}},
                                    [](Case& c) -> Method& { return c.method; }));
    rows.back().changesPicture = true;
    rows.back().changesWork = true;
    rows.push_back(wordAxis<RowFormat>({.name = "palette_rows",
                                        .option = {.help = ": floats or half floats"},
                                        .applies = skinsOnDevice,
                                        .noun = "format of palette rows",
                                        .define = "PALETTE_HALF"},
                                       {{"f32", RowFormat::f32}, {"f16", RowFormat::f16, "f16-rows"}},
                                       [](Case& c) -> RowFormat& { return c.paletteRows; }));
    rows.back().changesPicture = true;
    rows.push_back(wordAxis<ZeroWeights>({.name = "zero_weights",
                                          .option = {.help = ": what is done with influences that weigh nothing"},
                                          .applies = skinsOnDevice,
                                          .noun = "treatment of zero weights",
                                          .define = "ZERO_WEIGHTS"},
                                         {{"load", ZeroWeights::load, "load-zero-weights"},
                                          {"skip", ZeroWeights::skip},
                                          {"count", ZeroWeights::count, "count-influences"}},
                                         [](Case& c) -> ZeroWeights& { return c.zeroWeights; }));
    rows.push_back(wordAxis<bool>({.name = "arithmetic",
                                   .option = {.help = ": loads-only reads what skinning reads and computes nothing"},
                                   .applies = skinsOnDevice,
                                   .define = "LOADS_ONLY"},
                                  {{"all", false}, {"loads-only", true, "loads-only"}},
                                  [](Case& c) -> bool& { return c.loadsOnly; }));
    rows.back().changesPicture = rows.back().changesWork = true;
}

void addDraws(std::vector<Axis>& rows) {
    rows.push_back(
        numberAxis<uint32_t>({.name = "palette_slots",
                              .option = {.aliases = {"slots"}, .help = "joints of one draw of the variant palette"},
                              .changes = Changes::records,
                              .applies = usesPartition},
                             {1, UINT16_MAX, "slots-", "", true}, [](Case& c) -> uint32_t& { return c.paletteSlots; }));
    rows.push_back(computeAxis());
    rows.push_back(wordAxis<uint32_t>({.name = "triangle_tests",
                                       .option = {.help = ": what compute-cull tests triangles for"},
                                       .applies = listsTriangles,
                                       .noun = "set of tests",
                                       .define = "TRIANGLE_TESTS"},
                                      {{"all", TEST_FRUSTUM | TEST_BACK | TEST_SMALL},
                                       {"none", 0, "no-tests"},
                                       {"frustum", TEST_FRUSTUM, "test-frustum"},
                                       {"back", TEST_BACK, "test-back"},
                                       {"small", TEST_SMALL, "test-small"},
                                       {"frustum+back", TEST_FRUSTUM | TEST_BACK, "test-frustum-back"},
                                       {"frustum+small", TEST_FRUSTUM | TEST_SMALL, "test-frustum-small"},
                                       {"back+small", TEST_BACK | TEST_SMALL, "test-back-small"}},
                                      [](Case& c) -> uint32_t& { return c.triangleTests; }));
    rows.push_back(otherWork(
        same(wordAxis<int>({.name = "influences", .changes = Changes::scene, .define = "INFLUENCES"},
                           {{"4", 4}, {"8", 8, "8-influences"}}, [](Case& c) -> int& { return c.influences; }))));
    rows.back().changesPicture = true;
    addSkinning(rows);
    rows.push_back(fetchAxis());
    rows.push_back(
        same(wordAxis<Submission>({.name = "submission", .applies = draws, .define = "BATCHED"},
                                  {{"per-copy", Submission::perCopy}, {"batched", Submission::batched, "batched"}},
                                  [](Case& c) -> Submission& { return c.submission; })));
    rows.push_back(otherWork(same(wordAxis<bool>(
        {.name = "back_faces", .option = {.help = ": what the rasteriser does with them"}, .applies = draws},
        {{"culled", false}, {"kept", true, "keep-back-faces"}}, [](Case& c) -> bool& { return c.keepBackFaces; }))));
    rows.push_back(topLevel(wordAxis<Cull>({.name = "cull",
                                            .option = {.help = ": back faces in the mesh stage"},
                                            .applies = skinsMeshlets,
                                            .noun = "culling",
                                            .define = "CULL"},
                                           {{"off", Cull::off},
                                            {"compact", Cull::compact, "cull-compact"},
                                            {"primitive", Cull::primitive, "cull-primitive"},
                                            {"torabi", Cull::torabi, "cull-torabi"}},
                                           [](Case& c) -> Cull& { return c.cull; })));
    rows.push_back(wordAxis<Exchange>(
        {.name = "exchange", .option = {.help = ": how culling lanes see each other's positions"}, .applies = culls},
        {{"auto", Exchange::automatic},
         {"shuffle", Exchange::shuffle, "shuffle"},
         {"shared", Exchange::shared, "shared"},
         {"outputs", Exchange::outputs, "outputs"}},
        [](Case& c) -> Exchange& { return c.exchange; }));
    rows.back().beside = "cull";
    rows.push_back(wordAxis<VertexWrites>({.name = "vertex_writes",
                                           .option = {.help = ": when compact writes vertices"},
                                           .applies = compacts,
                                           .noun = "time of vertex writes"},
                                          {{"auto", VertexWrites::automatic},
                                           {"first", VertexWrites::first, "writes-first"},
                                           {"last", VertexWrites::last, "writes-last"}},
                                          [](Case& c) -> VertexWrites& { return c.vertexWrites; }));
    rows.back().beside = "cull";
    addClusterCulling(rows);
    rows.push_back(
        otherWork(topLevel(wordAxis<Scenario>({.name = "scenario", .applies = prepasses},
                                              {{"direct", Scenario::direct}, {"prepass", Scenario::prepass, "prepass"}},
                                              [](Case& c) -> Scenario& { return c.scenario; }))));
    rows.push_back(otherWork(topLevel(same(
        wordAxis<RasterMode>({.name = "raster", .changes = Changes::raster, .applies = draws, .noun = "raster mode"},
                             {{"full", RasterMode::full},
                              {"no-fragments", RasterMode::noFragments, "no-fragments"},
                              {"discard", RasterMode::discard, "discard"}},
                             [](Case& c) -> RasterMode& { return c.raster; })))));
    rows.push_back(otherWork(
        same(wordAxis<uint32_t>({.name = "views",
                                 .option = {.help = ": views per frame, the main one and others that draw only depth"},
                                 .applies = draws,
                                 .noun = "number of views"},
                                {{"1", 1}, {"2", 2, "2-views"}, {"4", 4, "4-views"}, {"8", MOST_VIEWS, "8-views"}},
                                [](Case& c) -> uint32_t& { return c.views; }))));
    rows.push_back(wordAxis<Queues>(
        {.name = "queues", .option = {.help = ": async skins the next frame on a second queue"}, .applies = skinsFirst},
        {{"one", Queues::one}, {"async", Queues::async, "async"}}, [](Case& c) -> Queues& { return c.queues; }));
    rows.push_back(wordAxis<View>({.name = "view", .applies = draws, .define = "VIEW"},
                                  {{"shaded", View::shaded},
                                   {"meshlets", View::meshlets, "view-meshlets"},
                                   {"weights", View::weights, "view-weights"},
                                   {"tuples", View::tuples, "view-tuples"},
                                   {"velocity", View::velocity, "view-velocity"},
                                   {"resolution", View::resolution, "view-resolution"},
                                   {"normals", View::normals, "view-normals"},
                                   {"joints", View::joints, "view-joints"},
                                   {"culled", View::culled, "view-culled"}},
                                  [](Case& c) -> View& { return c.view; }));
    rows.back().benched = false;
    rows.back().changesPicture = true;
}

}  // namespace

const char* changesName(Changes changes) {
    constexpr const char* names[] = {"scene", "meshlets", "records", "encoding", "plan", "raster"};
    return names[static_cast<size_t>(changes)];
}

std::vector<Axis>& axisTable() {
    static std::vector<Axis> rows = [] {
        std::vector<Axis> table;
        addPath(table);
        addMeshStage(table);
        addCommonInfluences(table);
        addShapes(table);
        addDraws(table);
        return table;
    }();
    return rows;
}

const std::vector<Axis>& axes() { return axisTable(); }

const Axis* findAxis(std::string_view name) {
    const auto axis = std::ranges::find(axes(), name, &Axis::name);
    return axis == axes().end() ? nullptr : &*axis;
}

std::string wordsOf(const Axis& axis) { return joined(axis.words); }

}  // namespace skinbench
