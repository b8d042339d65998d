#include "common/report/inspect.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>

#include <nlohmann/json.hpp>

#include "common/codecs/packed.h"
#include "common/core/parallel.h"
#include "common/plans/plan.h"
#include "common/report/report.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr uint32_t kFloatVertexBytes = 32;  // position, normal and texture coordinate as floats

// Runs every task once, spread over the cores.
void runAll(const std::vector<std::function<void()>>& tasks) {
    std::atomic<size_t> next = 0;
    parallelEach(std::min(tasks.size(), coreCount()), [&](size_t) {
        for (size_t task = next++; task < tasks.size(); task = next++) tasks[task]();
    });
}

// --- meshlets --------------------------------------------------------------------------------------------------

// `plain` is the builder's cut of the mesh. Leaves out what a row of CiGrouping::meshlets has in common with it.
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
    if (row.grouping != CiGrouping::meshlets) {
        const MeshletMesh ofVertices = sourceMeshlets(cut);
        row.stats = meshletStats(mesh, ofVertices);
        row.joints = jointSpread(mesh, ofVertices);
    }
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
    for (size_t i = 1; i < rows.size(); ++i) {
        if (rows[i].grouping != CiGrouping::meshlets) continue;
        rows[i].stats = rows[i - 1].stats;  // the same meshlets in another order
        rows[i].joints = rows[i - 1].joints;
    }
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
    auto placesOf = [](const Influences& influences) {
        size_t places = influences.joints.size();
        while (places > 0 && influences.joints[places - 1] == kNoJoint) --places;
        return places;
    };
    const size_t wantedPlaces = placesOf(wanted), decodedPlaces = placesOf(decoded);
    auto weightOf = [](const Influences& influences, size_t places, uint16_t joint) {
        double sum = 0;
        for (size_t i = 0; i < places; ++i)
            if (influences.joints[i] == joint) sum += influences.weights[i];
        return sum;
    };
    auto visit = [&](const Influences& side, size_t places) {
        for (size_t i = 0; i < places; ++i)
            if (const uint16_t joint = side.joints[i]; joint != kNoJoint)
                largest = std::max(
                    largest, std::abs(weightOf(wanted, wantedPlaces, joint) - weightOf(decoded, decodedPlaces, joint)));
    };
    visit(wanted, wantedPlaces);
    visit(decoded, decodedPlaces);
    return largest;
}

// An axis without extent has no error.
template <class Vec>
double scaledLength(const Vec& difference, const Vec& extent) {
    double sum = 0;
    for (int axis = 0; axis < difference.length(); ++axis)
        if (extent[axis] > 0) sum += std::pow(static_cast<double>(difference[axis]) / extent[axis], 2);
    return std::sqrt(sum);
}

using Distances = std::array<double, 4>;  // in the order of CodecErrors

// Over encoded vertices, because a copy of a vertex may decode to something else.
CodecErrors codecErrors(const Mesh& mesh, const EncodedMesh& encoded) {
    if (!encoded.decode) return {};
    const Mesh decoded = encoded.decode();
    const VertexGrids grids = vertexGrids(mesh);
    auto distances = [&](size_t v) -> Distances {
        const size_t source = encoded.sources.empty() ? v : encoded.sources[v];
        return {weightDifference(mesh.influences[source], decoded.influences[v]),
                scaledLength(decoded.positions[v] - mesh.positions[source], grids.position.extent),
                glm::distance(decoded.normals[v], mesh.normals[source]),
                scaledLength(decoded.uvs[v] - mesh.uvs[source], grids.uv.extent)};
    };
    // Shares are added in the order of the vertices, so that the mean does not depend on the number of threads.
    constexpr size_t kBlock = size_t{1} << 20;
    std::vector<Distances> shares(std::min<size_t>(encoded.vertexCount, kBlock));
    Distances mean{}, most{};
    for (size_t first = 0; first < encoded.vertexCount; first += kBlock) {
        const size_t count = std::min(encoded.vertexCount - first, kBlock);
        const auto largest = parallelParts(count, [&](size_t begin, size_t end) {
            Distances high{};
            for (size_t i = begin; i < end; ++i) {
                shares[i] = distances(first + i);
                for (size_t f = 0; f < high.size(); ++f) {
                    high[f] = std::max(high[f], shares[i][f]);
                    shares[i][f] /= static_cast<double>(encoded.vertexCount);
                }
            }
            return high;
        });
        for (const auto& [begin, high] : largest)
            for (size_t f = 0; f < high.size(); ++f) most[f] = std::max(most[f], high[f]);
        for (size_t i = 0; i < count; ++i)
            for (size_t f = 0; f < mean.size(); ++f) mean[f] += shares[i][f];
    }
    return {{mean[0], most[0]}, {mean[1], most[1]}, {mean[2], most[2]}, {mean[3], most[3]}};
}

std::optional<uint64_t> sizeOf(const Bytes& bytes) {
    return bytes ? std::optional<uint64_t>(bytes->size()) : std::nullopt;
}

void encodeInto(CodecRow& row, const Mesh& mesh, const MeshletMesh& cut, int influences) {
    const auto start = std::chrono::steady_clock::now();
    auto encoded = row.codec->encode({mesh, &cut, influences});
    row.encodeMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (!encoded) {
        row.encodeMs = 0;
        row.reason = encoded.error().text;
        return;
    }
    row.vertices = encoded->vertexCount;
    row.vertexBytes = sizeOf(encoded->vertices).value_or(0);
    row.meshletExtraBytes = sizeOf(encoded->meshletExtra);
    row.tupleBytes = sizeOf(encoded->tuples);
    if (!row.codec->needsMeshlets) row.indexBytes = mesh.indices.size() * sizeof(uint32_t);
    row.errors = codecErrors(mesh, *encoded);
    const uint64_t bytes = row.vertexBytes + row.meshletExtraBytes.value_or(0) + row.tupleBytes.value_or(0);
    row.blendBytesPerVertex = static_cast<double>(bytes) / static_cast<double>(mesh.positions.size()) -
                              (encoded->decode ? kBaseVertexBytes : kFloatVertexBytes);
}

// A layout's bytes depend on counts, which no codec changes: codecs renumber vertices.
std::vector<CodecRow> layoutRows(const std::vector<MeshletMesh>& cuts) {
    std::vector<CodecRow> rows(cuts.size());
    std::vector<std::function<void()>> tasks;
    for (size_t b = 0; b < cuts.size(); ++b)
        tasks.push_back([&, b] {
            for (const MeshletLayout& layout : meshletLayouts()) {
                const PackedMeshlets packed = layout.pack(cuts[b], {});
                rows[b].descriptorBytes[layout.name] = packed.descriptors.size() * sizeof(uint32_t);
                rows[b].dataBytes[layout.name] = packed.data.size() * sizeof(uint32_t);
            }
        });
    runAll(tasks);
    return rows;
}

// One encoder after the other: each has all cores while it is timed.
void addCodecRows(const Mesh& mesh, const std::vector<MeshletMesh>& cuts, Geometry geometry, Inspection& into) {
    const std::vector<CodecRow> layouts = layoutRows(cuts);
    const size_t first = into.codecs.size();
    for (size_t b = 0; b < cuts.size(); ++b)
        for (size_t c = 0; c < codecs().size(); ++c) {
            CodecRow row{&codecs()[c], geometry};
            if (b == 0 || row.codec->needsMeshlets) {
                encodeInto(row, mesh, cuts[b], into.settings.influences);
            } else {
                row = into.codecs[first + c];
            }
            row.builder = &builders()[b];
            if (row.reason.empty()) {
                row.descriptorBytes = layouts[b].descriptorBytes;
                row.dataBytes = layouts[b].dataBytes;
            }
            into.codecs.push_back(std::move(row));
        }
}

struct CutScene {
    Result<Scene> scene;
    std::vector<MeshletMesh> cuts;  // one a builder
};

// A builder has one core.
CutScene cutScene(const Scene& stored, Geometry geometry, bool cacheOrder, const InspectSettings& settings) {
    CutScene made{prepareScene(stored, {settings.influences, geometry, cacheOrder}), {}};
    if (!made.scene) return made;
    made.cuts.resize(builders().size());
    parallelEach(made.cuts.size(),
                 [&](size_t b) { made.cuts[b] = builders()[b].build(made.scene->mesh, settings.limits); });
    return made;
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
            {"uv_error", orNothing(errorJson(row.errors.uv))},
            {"encode_ms", orNothing(row.encodeMs)}};
}

}  // namespace

JointSpread jointSpread(const Mesh& mesh, const MeshletMesh& cut) {
    JointSpread spread;
    uint64_t sum = 0;
    std::vector<size_t> seenIn(size_t{kNoJoint} + 1, SIZE_MAX);  // the last meshlet that has the joint
    for (size_t m = 0; m < cut.meshlets.size(); ++m) {
        const Meshlet& meshlet = cut.meshlets[m];
        uint32_t distinct = 0;
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            const Influences& influences = mesh.influences[cut.vertices[meshlet.firstVertex + i]];
            for (size_t k = 0; k < influences.joints.size(); ++k) {
                if (!(influences.weights[k] > 0)) continue;
                size_t& seen = seenIn[influences.joints[k]];
                distinct += seen != m;
                seen = m;
            }
        }
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
            if (!settings.all && !(geometry == Geometry::welded && cacheOrder)) continue;
            const auto [scene, cuts] = cutScene(stored, geometry, cacheOrder, settings);
            SKINBENCH_TRY(scene);
            SKINBENCH_TRY(addMeshletRows(scene->mesh, cuts, geometry, cacheOrder, inspection));
            if (!cacheOrder) continue;
            addCodecRows(scene->mesh, cuts, geometry, inspection);
            if (geometry != Geometry::welded) continue;
            inspection.stats = sceneStats(*scene);
            inspection.warnings = scene->warnings;
            inspection.attributes = attributeErrors(scene->mesh);
        }
    return inspection;
}

std::vector<EncodeTotal> encodeTotals(const std::vector<CodecRow>& rows) {
    std::vector<EncodeTotal> totals;
    for (const CodecRow& row : rows) {
        if (totals.empty() || totals.back().geometry != row.geometry || totals.back().builder != row.builder)
            totals.push_back({row.geometry, row.builder});
        if (!row.reason.empty()) continue;
        ++totals.back().codecs;
        totals.back().encodeMs += row.encodeMs;
    }
    return totals;
}

nlohmann::ordered_json inspectJson(const Inspection& inspection) {
    Json keys = Json::array(), meshlets = Json::array(), codecRows = Json::array();
    Json totals = Json::array();
    for (CiKey key : inspection.settings.keys) keys.push_back(ciKeyName(key));
    for (const MeshletRow& row : inspection.meshlets) meshlets.push_back(meshletRowJson(row));
    for (const CodecRow& row : inspection.codecs) codecRows.push_back(codecRowJson(row));
    for (const EncodeTotal& total : encodeTotals(inspection.codecs))
        totals.push_back({{"geometry", geometryName(total.geometry)},
                          {"builder", total.builder->name},
                          {"codecs", total.codecs},
                          {"encode_ms", total.encodeMs}});
    return {{"schema", kInspectSchema},
            {"scene", sceneJson(inspection.scene, inspection.stats)},
            {"settings",
             {{"meshlet_vertices", inspection.settings.limits.vertices},
              {"meshlet_triangles", inspection.settings.limits.triangles},
              {"influences", inspection.settings.influences},
              {"ci_min", inspection.settings.minVertices},
              {"ci_keys", keys}}},
            {"warnings", inspection.warnings},
            {"meshlets", meshlets},
            {"attributes", attributesJson(inspection.attributes)},
            {"codecs", codecRows},
            {"encode_all", totals}};
}

}  // namespace skinbench
