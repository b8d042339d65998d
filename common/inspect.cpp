#include "common/inspect.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include <nlohmann/json.hpp>

#include "common/codecs/packed.h"
#include "common/variant.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint32_t kFloatVertexBytes = 32;  // position, normal and texture coordinate as floats

// Runs every task once, spread over the cores.
void runAll(const std::vector<std::function<void()>>& tasks) {
    std::atomic<size_t> next = 0;
    auto work = [&] {
        for (size_t task = next++; task < tasks.size(); task = next++) tasks[task]();
    };
    const size_t threads = std::min<size_t>(tasks.size(), std::max(1u, std::thread::hardware_concurrency()));
    std::vector<std::jthread> others;
    for (size_t t = 1; t < threads; ++t) others.emplace_back(work);
    work();
}

// --- meshlets --------------------------------------------------------------------------------------------------

// `plain` is the builder's cut of the mesh.
Result<void> fillRow(MeshletRow& row, const Mesh& mesh, const MeshletMesh& plain, const InspectSettings& settings) {
    row.vertices = static_cast<uint32_t>(mesh.positions.size());
    if (!row.grouping) {
        if (auto right = checkMeshlets(mesh, plain); !right) return right;
        row.stats = meshletStats(mesh, plain);
        row.joints = jointSpread(mesh, plain);
        return {};
    }
    const CommonInfluenceCut cut =
        buildCommonInfluences(mesh, {row.builder, settings.limits, settings.influences, *row.grouping,
                                     row.key.value_or(CiKey::fit), settings.minVertices, &plain});
    if (auto right = checkCommonInfluences(mesh, cut); !right) return right;
    const MeshletMesh ofVertices = sourceMeshlets(cut);
    row.stats = meshletStats(mesh, ofVertices);
    row.joints = jointSpread(mesh, ofVertices);
    row.commonMeshlets = cut.commonMeshlets;
    row.remainderTriangles = static_cast<uint32_t>(mesh.indices.size() / 3) - cut.commonTriangles;
    row.records = static_cast<uint32_t>(cut.sources.size());
    row.commonRecords = cut.commonRecords;
    return {};
}

std::vector<MeshletRow> rowsOf(Geometry geometry, bool cacheOrder, const InspectSettings& settings) {
    std::vector<MeshletRow> rows;
    for (const Builder& builder : builders()) {
        MeshletRow row{geometry, cacheOrder, &builder};
        rows.push_back(row);
        row.grouping = CiGrouping::meshlets;
        rows.push_back(row);
        row.grouping = CiGrouping::triangles;
        for (CiKey key : settings.keys) {
            row.key = key;
            rows.push_back(row);
        }
    }
    return rows;
}

Result<void> addMeshletRows(const Mesh& mesh, const std::vector<MeshletMesh>& cuts, Geometry geometry, bool cacheOrder,
                            Inspection& into) {
    std::vector<MeshletRow> rows = rowsOf(geometry, cacheOrder, into.settings);
    std::vector<Result<void>> outcomes(rows.size());
    std::vector<std::function<void()>> tasks;
    for (size_t i = 0; i < rows.size(); ++i)
        tasks.push_back([&, i] {
            const auto builder = static_cast<size_t>(rows[i].builder - builders().data());
            outcomes[i] = fillRow(rows[i], mesh, cuts[builder], into.settings);
        });
    runAll(tasks);
    for (size_t i = 0; i < rows.size(); ++i)
        if (!outcomes[i]) return inputError(std::string(rows[i].builder->name) + ": " + outcomes[i].error().text);
    into.meshlets.insert(into.meshlets.end(), rows.begin(), rows.end());
    return {};
}

// --- codecs -----------------------------------------------------------------------------------------------------

AttributeErrors attributeErrors(const Mesh& mesh) {
    AttributeErrors errors;
    for (int bits : {8, 10, 16, 21}) errors.position[bits] = positionError(mesh, bits);
    errors.uv = uvError(mesh);
    errors.euclidean = normalError(mesh, NormalFormat::euclidean);
    errors.spherical = normalError(mesh, NormalFormat::spherical);
    errors.octahedral = normalError(mesh, NormalFormat::octahedral);
    return errors;
}

// Largest difference of one joint's weight; a decoder may name a joint twice.
double weightDifference(const Influences& wanted, const Influences& decoded) {
    double largest = 0;
    auto weightOf = [](const Influences& influences, uint16_t joint) {
        double sum = 0;
        for (size_t i = 0; i < influences.joints.size(); ++i)
            if (influences.joints[i] == joint) sum += influences.weights[i];
        return sum;
    };
    for (const Influences* side : {&wanted, &decoded})
        for (uint16_t joint : side->joints)
            if (joint != kNoJoint)
                largest = std::max(largest, std::abs(weightOf(wanted, joint) - weightOf(decoded, joint)));
    return largest;
}

// Over encoded vertices, because a copy of a vertex may decode to something else.
CodecErrors codecErrors(const Mesh& mesh, const EncodedMesh& encoded) {
    const Mesh decoded = decodeOnCpu(mesh, encoded);
    const VertexGrids grids = vertexGrids(mesh);
    CodecErrors errors;
    auto add = [&](ErrorFigure& figure, double distance) {
        figure.mean += distance / static_cast<double>(encoded.vertexCount);
        figure.max = std::max(figure.max, distance);
    };
    // An axis without extent has no error.
    auto scaled = [](const auto& difference, const auto& extent) {
        double sum = 0;
        for (int axis = 0; axis < difference.length(); ++axis)
            if (extent[axis] > 0) sum += std::pow(static_cast<double>(difference[axis]) / extent[axis], 2);
        return std::sqrt(sum);
    };
    for (uint32_t v = 0; v < encoded.vertexCount; ++v) {
        const uint32_t source = encoded.sources.empty() ? v : encoded.sources[v];
        add(errors.weight, weightDifference(mesh.influences[source], decoded.influences[v]));
        add(errors.position, scaled(decoded.positions[v] - mesh.positions[source], grids.position.extent));
        add(errors.normal, glm::distance(decoded.normals[v], mesh.normals[source]));
        add(errors.uv, scaled(decoded.uvs[v] - mesh.uvs[source], grids.uv.extent));
    }
    return errors;
}

std::optional<uint64_t> sizeOf(const Bytes& bytes) {
    return bytes ? std::optional<uint64_t>(bytes->size()) : std::nullopt;
}

void encodeInto(CodecRow& row, const Mesh& mesh, const MeshletMesh& cut, int influences) {
    auto encoded = row.codec->encode(mesh, &cut, influences);
    if (!encoded) {
        row.reason = encoded.error().text;
        return;
    }
    row.vertices = encoded->vertexCount;
    row.vertexBytes = sizeOf(encoded->vertices).value_or(0);
    row.meshletExtraBytes = sizeOf(encoded->meshletExtra);
    row.tupleBytes = sizeOf(encoded->tuples);
    if (!row.codec->needsMeshlets) row.indexBytes = mesh.indices.size() * sizeof(uint32_t);
    for (const MeshletLayout& layout : meshletLayouts()) {
        const PackedMeshlets packed = layout.pack(encoded->meshlets ? *encoded->meshlets : cut, {});
        row.descriptorBytes[layout.name] = packed.descriptors.size() * sizeof(uint32_t);
        row.dataBytes[layout.name] = packed.data.size() * sizeof(uint32_t);
    }
    row.errors = codecErrors(mesh, *encoded);
    const uint64_t bytes = row.vertexBytes + row.meshletExtraBytes.value_or(0) + row.tupleBytes.value_or(0);
    row.blendBytesPerVertex = static_cast<double>(bytes) / static_cast<double>(mesh.positions.size()) -
                              (encoded->decode ? kBaseVertexBytes : kFloatVertexBytes);
}

void addCodecRows(const Mesh& mesh, const std::vector<MeshletMesh>& cuts, Geometry geometry, Inspection& into) {
    std::vector<CodecRow> rows;
    for (const Builder& builder : builders())
        for (const Codec& codec : codecs()) rows.push_back({&codec, geometry, &builder});
    std::vector<std::function<void()>> tasks;
    for (size_t i = 0; i < rows.size(); ++i)
        tasks.push_back([&, i] { encodeInto(rows[i], mesh, cuts[i / codecs().size()], into.settings.influences); });
    runAll(tasks);
    into.codecs.insert(into.codecs.end(), rows.begin(), rows.end());
}

// A cut per builder.
std::vector<MeshletMesh> cutMesh(const Mesh& mesh, const MeshletLimits& limits) {
    std::vector<MeshletMesh> cuts(builders().size());
    std::vector<std::function<void()>> tasks;
    for (size_t b = 0; b < cuts.size(); ++b) tasks.push_back([&, b] { cuts[b] = builders()[b].build(mesh, limits); });
    runAll(tasks);
    return cuts;
}

// --- JSON ------------------------------------------------------------------------------------------------------

template <class T>
Json orNull(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json errorJson(const ErrorFigure& figure) { return {{"mean", figure.mean}, {"max", figure.max}}; }

Json meshletRowJson(const MeshletRow& row) {
    const MeshletStats& stats = row.stats;
    const bool common = row.grouping.has_value();
    auto ofCommon = [&](uint32_t value) { return common ? Json(value) : Json(nullptr); };
    return {{"geometry", geometryName(row.geometry)},
            {"cache_order", row.cacheOrder},
            {"builder", row.builder->name},
            {"ci_grouping", common ? Json(ciGroupingName(*row.grouping)) : Json(nullptr)},
            {"ci_key", row.key ? Json(ciKeyName(*row.key)) : Json(nullptr)},
            {"vertices", row.vertices},
            {"meshlets", stats.meshlets},
            {"mean_vertices", stats.meanVertices},
            {"mean_triangles", stats.meanTriangles},
            {"vertex_fill", stats.vertexFill},
            {"triangle_fill", stats.triangleFill},
            {"vertex_reuse", stats.vertexReuse},
            {"mean_unique_tuples", stats.meanUniqueTuples},
            {"mean_joints", row.joints.mean},
            {"max_joints", row.joints.largest},
            {"common_meshlets", ofCommon(row.commonMeshlets)},
            {"remainder_triangles", ofCommon(row.remainderTriangles)},
            {"records", ofCommon(row.records)},
            {"common_records", ofCommon(row.commonRecords)}};
}

Json attributesJson(const AttributeErrors& errors) {
    Json position = Json::object();
    for (const auto& [bits, figure] : errors.position) position[std::to_string(bits)] = errorJson(figure);
    return {{"position_error", position},
            {"uv_error", errorJson(errors.uv)},
            {"normal_error",
             {{"euclidean", errorJson(errors.euclidean)},
              {"spherical", errorJson(errors.spherical)},
              {"octahedral", errorJson(errors.octahedral)}}}};
}

Json memoryJson(const CodecRow& row) {
    if (!row.reason.empty()) return nullptr;
    Json layouts = Json::object();
    for (const auto& [name, bytes] : row.dataBytes)
        layouts[name] = {{"descriptors", row.descriptorBytes.at(name)}, {"data", bytes}};
    const std::string usual = meshletLayouts().front().name;
    return {{"vertex", row.vertexBytes},
            {"index", orNull(row.indexBytes)},
            {"meshlet", row.descriptorBytes.at(usual) + row.dataBytes.at(usual)},
            {"meshlet_layouts", layouts},
            {"additional_meshlet", orNull(row.meshletExtraBytes)},
            {"tuple", orNull(row.tupleBytes)}};
}

Json codecRowJson(const CodecRow& row) {
    const bool encoded = row.reason.empty();
    auto orNothing = [&](Json value) { return encoded ? value : Json(nullptr); };
    return {{"codec", row.codec->name},
            {"geometry", geometryName(row.geometry)},
            {"builder", row.builder->name},
            {"reason", encoded ? Json(nullptr) : Json(row.reason)},
            {"vertices", orNothing(row.vertices)},
            {"memory_bytes", memoryJson(row)},
            {"bytes_per_vertex_blend", orNothing(row.blendBytesPerVertex)},
            {"max_weight_error", orNothing(row.errors.weight.max)},
            {"mean_weight_error", orNothing(row.errors.weight.mean)},
            {"position_error", orNothing(errorJson(row.errors.position))},
            {"normal_error", orNothing(errorJson(row.errors.normal))},
            {"uv_error", orNothing(errorJson(row.errors.uv))}};
}

}  // namespace

const char* geometryName(Geometry geometry) {
    constexpr const char* kNames[] = {"welded", "stored", "unwelded"};
    return kNames[static_cast<size_t>(geometry)];
}

JointSpread jointSpread(const Mesh& mesh, const MeshletMesh& cut) {
    JointSpread spread;
    uint64_t sum = 0;
    std::vector<uint16_t> joints;
    for (const Meshlet& meshlet : cut.meshlets) {
        joints.clear();
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            const Influences& influences = mesh.influences[cut.vertices[meshlet.firstVertex + i]];
            for (size_t k = 0; k < influences.joints.size(); ++k)
                if (influences.weights[k] > 0) joints.push_back(influences.joints[k]);
        }
        std::ranges::sort(joints);
        const auto distinct = static_cast<uint32_t>(std::ranges::unique(joints).begin() - joints.begin());
        sum += distinct;
        spread.largest = std::max(spread.largest, distinct);
    }
    if (!cut.meshlets.empty()) spread.mean = static_cast<double>(sum) / static_cast<double>(cut.meshlets.size());
    return spread;
}

Result<Inspection> inspectScene(const Scene& stored, const InspectSettings& settings) {
    Inspection inspection;
    inspection.scene = stored.name;
    inspection.settings = settings;
    for (Geometry geometry : {Geometry::welded, Geometry::unwelded})
        for (bool cacheOrder : {true, false}) {
            auto scene = prepareScene(stored, {settings.influences, geometry, cacheOrder});
            if (!scene) return std::unexpected(scene.error());
            const std::vector<MeshletMesh> cuts = cutMesh(scene->mesh, settings.limits);
            if (auto added = addMeshletRows(scene->mesh, cuts, geometry, cacheOrder, inspection); !added)
                return std::unexpected(added.error());
            if (!cacheOrder) continue;
            addCodecRows(scene->mesh, cuts, geometry, inspection);
            if (geometry != Geometry::welded) continue;
            inspection.stats = sceneStats(*scene);
            inspection.warnings = scene->warnings;
            inspection.attributes = attributeErrors(scene->mesh);
        }
    return inspection;
}

nlohmann::ordered_json inspectJson(const Inspection& inspection) {
    Json keys = Json::array(), meshlets = Json::array(), codecRows = Json::array();
    for (CiKey key : inspection.settings.keys) keys.push_back(ciKeyName(key));
    for (const MeshletRow& row : inspection.meshlets) meshlets.push_back(meshletRowJson(row));
    for (const CodecRow& row : inspection.codecs) codecRows.push_back(codecRowJson(row));
    return {{"schema", kInspectSchema},
            {"scene",
             {{"name", inspection.scene},
              {"vertices", inspection.stats.vertices},
              {"triangles", inspection.stats.triangles},
              {"joints", inspection.stats.joints},
              {"unique_tuples", inspection.stats.uniqueTuples},
              {"mean_influences", inspection.stats.meanInfluences},
              {"max_influences", inspection.stats.maxInfluences}}},
            {"settings",
             {{"meshlet_vertices", inspection.settings.limits.vertices},
              {"meshlet_triangles", inspection.settings.limits.triangles},
              {"influences", inspection.settings.influences},
              {"ci_min", inspection.settings.minVertices},
              {"ci_keys", keys}}},
            {"warnings", inspection.warnings},
            {"meshlets", meshlets},
            {"attributes", attributesJson(inspection.attributes)},
            {"codecs", codecRows}};
}

}  // namespace skinbench
