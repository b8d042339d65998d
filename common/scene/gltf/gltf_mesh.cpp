#include "common/scene/gltf/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <limits>
#include <numeric>
#include <span>

#include "common/core/text.h"

namespace skinbench {
namespace {

constexpr int kMaxSets = 16;  // JOINTS_0 to JOINTS_15
constexpr uint64_t kVertexBytes = 2 * sizeof(glm::vec3) + sizeof(glm::vec2) + sizeof(Influences) + sizeof(uint32_t);
enum Mode { kTriangles = 4, kStrip = 5, kFan = 6 };

int find(const GltfPrimitive& primitive, const std::string& name) {
    const auto it = primitive.attributes.find(name);
    return it == primitive.attributes.end() ? -1 : it->second;
}

Result<const GltfColumn*> checkColumn(Result<const GltfColumn*> column, const std::string& name, uint64_t vertices) {
    if (!column) return std::unexpected(Error{column.error().fault, name + ": " + column.error().text});
    if ((*column)->count != vertices)
        return inputError(
            std::format("{} has {}, POSITION has {}", name, counted((*column)->count, "element"), vertices));
    return column;
}

enum class Use { position, normal, uv, weight };

// glTF 2.0, section 3.7.2.1, and KHR_mesh_quantization.
bool isAllowed(const GltfColumn& column, Use use, bool quantization) {
    const bool isSigned = column.component == kGltfI8 || column.component == kGltfI16;
    const bool isUnsigned = column.component == kGltfU8 || column.component == kGltfU16;
    if (column.component == kGltfF32) return true;
    if (use == Use::weight) return isUnsigned && column.normalized;
    if (use == Use::uv && isUnsigned && column.normalized) return true;
    if (use == Use::normal) return quantization && isSigned && column.normalized;
    return quantization && (isSigned || isUnsigned);
}

void noteFormat(const GltfData& data, const GltfColumn& column, Use use, GltfNotes& notes) {
    if (!isAllowed(column, use, data.quantization)) notes.add(GltfNote::forbiddenFormats);
    if (column.misaligned) notes.add(GltfNote::misaligned);
}

// --- triangles --------------------------------------------------------------------------------------------------

Result<std::vector<uint32_t>> readIndices(GltfData& data, const GltfPrimitive& primitive, uint64_t vertices) {
    const GltfColumn* column = nullptr;
    if (primitive.indices >= 0) {
        const auto opened = openIndexColumn(data, primitive.indices, 1, 4);
        if (!opened) return std::unexpected(Error{opened.error().fault, "indices: " + opened.error().text});
        column = *opened;
    }
    const uint64_t count = column ? column->count : vertices;
    // Strips and fans become three indices per triangle.
    SKINBENCH_TRY(spend(data.budget, count, 4 * sizeof(uint32_t)));
    std::vector<uint32_t> indices(count);
    if (!column) std::iota(indices.begin(), indices.end(), 0u);
    for (uint64_t i = 0; column && i < count; ++i) {
        readElement(*column, i, &indices[i]);
        if (indices[i] >= vertices)
            return inputError(std::format("index {} names vertex {} of {}", i, indices[i], vertices));
    }
    return indices;
}

Result<std::vector<uint32_t>> toTriangles(std::vector<uint32_t> indices, int mode) {
    if (mode == kTriangles) {
        if (indices.size() % 3 != 0)
            return inputError(counted(indices.size(), "index", "indices") + ", which is no multiple of 3");
        return indices;
    }
    std::vector<uint32_t> triangles;
    triangles.reserve(indices.size() * 3);
    for (size_t i = 0; i + 2 < indices.size(); ++i) {
        const size_t odd = i % 2;
        if (mode == kStrip)
            triangles.insert(triangles.end(), {indices[i], indices[i + 1 + odd], indices[i + 2 - odd]});
        else
            triangles.insert(triangles.end(), {indices[i + 1], indices[i + 2], indices[0]});
    }
    return triangles;
}

// Of many vertices that others use too, a mesh may name few; its own work must not grow with theirs.
std::vector<uint32_t> usedVertices(std::span<std::vector<uint32_t>*> lists) {
    size_t count = 0, highest = 0;
    for (const std::vector<uint32_t>* list : lists) {
        count += list->size();
        highest = std::max<size_t>(highest, std::ranges::max(*list));
    }
    std::vector<uint32_t> used;
    if (highest <= count * 4) {
        std::vector<bool> marks(highest + 1);
        for (const std::vector<uint32_t>* list : lists)
            for (const uint32_t index : *list) marks[index] = true;
        for (size_t v = 0; v <= highest; ++v)
            if (marks[v]) used.push_back(static_cast<uint32_t>(v));
        return used;
    }
    used.reserve(count);
    for (const std::vector<uint32_t>* list : lists) used.insert(used.end(), list->begin(), list->end());
    std::ranges::sort(used);
    used.erase(std::ranges::unique(used).begin(), used.end());
    return used;
}

// Renumbers the triangles; the vertices that they use keep their order.
std::vector<uint32_t> compact(std::span<std::vector<uint32_t>*> lists) {
    std::vector<uint32_t> used = usedVertices(lists);
    if (used.back() + size_t{1} == used.size()) return used;
    for (std::vector<uint32_t>* list : lists)
        for (uint32_t& index : *list)
            index = static_cast<uint32_t>(std::ranges::lower_bound(used, index) - used.begin());
    return used;
}

// The cross product's length is twice the area, so that large triangles count more.
std::vector<glm::vec3> smoothNormals(const std::vector<glm::vec3>& positions, const std::vector<uint32_t>& indices) {
    std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0));
    for (size_t i = 0; i < indices.size(); i += 3) {
        const glm::dvec3 a(positions[indices[i]]), b(positions[indices[i + 1]]), c(positions[indices[i + 2]]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k) sums[indices[i + k]] += normal;
    }
    std::vector<glm::vec3> normals(sums.size());
    for (size_t v = 0; v < sums.size(); ++v) {
        const double length = glm::length(sums[v]);
        normals[v] = length > 0 && std::isfinite(length) ? glm::vec3(sums[v] / length) : glm::vec3(0, 0, 1);
    }
    return normals;
}

// --- vertices ---------------------------------------------------------------------------------------------------

Result<void> readNormals(GltfData& data, int accessor, uint64_t count, GltfVertices& out, GltfNotes& notes) {
    const auto column = checkColumn(openColumn(data, accessor, 3), "NORMAL", count);
    SKINBENCH_TRY(column);
    noteFormat(data, **column, Use::normal, notes);
    // Rounding to a byte moves a unit vector by up to 0.7 %.
    const double kLong = (*column)->component == kGltfF32 ? 0.01 : 0.05;
    out.mesh.normals.resize(out.fileVertex.size());
    for (size_t v = 0; v < out.fileVertex.size(); ++v) {
        glm::vec3 value;
        readElement(**column, out.fileVertex[v], &value.x);
        const double length = glm::length(glm::dvec3(value));
        const bool good = std::isfinite(length) && length > 0;
        // Normals that are as good as floats get stay as they are.
        const bool unit = std::abs(length - 1) < 1e-5;
        out.mesh.normals[v] = !good ? glm::vec3(0, 0, 1) : unit ? value : glm::vec3(glm::dvec3(value) / length);
        if (!good) notes.add(GltfNote::badNormals);
        if (good && std::abs(length - 1) > kLong) notes.add(GltfNote::longNormals);
    }
    return {};
}

Result<void> readUvs(GltfData& data, int accessor, uint64_t count, GltfVertices& out, GltfNotes& notes) {
    out.mesh.uvs.assign(out.fileVertex.size(), glm::vec2(0));
    if (accessor < 0) return {};
    const auto column = checkColumn(openColumn(data, accessor, 2), "TEXCOORD_0", count);
    SKINBENCH_TRY(column);
    noteFormat(data, **column, Use::uv, notes);
    for (size_t v = 0; v < out.fileVertex.size(); ++v) {
        glm::vec2 uv;
        readElement(**column, out.fileVertex[v], &uv.x);
        const bool good = std::isfinite(uv.x) && std::isfinite(uv.y);
        if (good) out.mesh.uvs[v] = uv;
        if (!good) notes.add(GltfNote::badUvs);
    }
    return {};
}

struct Sets {
    std::vector<const GltfColumn*> joints;
    std::vector<const GltfColumn*> weights;
};

Result<Sets> openSets(GltfData& data, const GltfPrimitive& primitive, uint64_t count, GltfNotes& notes) {
    Sets sets;
    for (int n = 0;; ++n) {
        const std::string jointName = std::format("JOINTS_{}", n), weightName = std::format("WEIGHTS_{}", n);
        const int joints = find(primitive, jointName), weights = find(primitive, weightName);
        if (joints < 0 && weights < 0) return sets;
        if (joints < 0 || weights < 0)
            return inputError(joints < 0 ? weightName + " has no " + jointName : jointName + " has no " + weightName);
        if (n == kMaxSets) return inputError(std::format("has more than {} influences a vertex", kMaxSets * 4));
        const auto jointColumn = checkColumn(openIndexColumn(data, joints, 4, 2), jointName, count);
        SKINBENCH_TRY(jointColumn);
        const auto weightColumn = checkColumn(openColumn(data, weights, 4), weightName, count);
        SKINBENCH_TRY(weightColumn);
        if ((*jointColumn)->normalized) notes.add(GltfNote::forbiddenFormats);
        noteFormat(data, **weightColumn, Use::weight, notes);
        sets.joints.push_back(*jointColumn);
        sets.weights.push_back(*weightColumn);
    }
}

struct Entry {
    uint32_t joint = 0;
    double weight = 0;
};

// Of more than kMaxInfluences the largest stay. Places of one joint are added first, else it could lose its place.
Influences keepLargest(std::vector<Entry>& entries, GltfNotes& notes) {
    std::vector<Entry> merged;
    for (const Entry& entry : entries) {
        if (entry.weight <= 0) continue;
        const auto same = std::ranges::find(merged, entry.joint, &Entry::joint);
        if (same != merged.end())
            same->weight += entry.weight;
        else
            merged.push_back(entry);
    }
    std::ranges::stable_sort(merged, [](const Entry& a, const Entry& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
    });
    Influences out;
    if (merged.empty()) out.joints.fill(static_cast<uint16_t>(entries[0].joint));
    double kept = 0, all = 0;
    for (size_t k = 0; k < merged.size(); ++k) {
        all += merged[k].weight;
        if (k >= kMaxInfluences) continue;
        kept += merged[k].weight;
        out.joints[k] = static_cast<uint16_t>(merged[k].joint);
        out.weights[k] = static_cast<float>(merged[k].weight);
    }
    if (merged.size() > kMaxInfluences) {
        notes.add(GltfNote::overfull);
        notes.overfullMax = std::max(notes.overfullMax, 1 - kept / all);
    }
    return out;
}

bool repeatsJoint(const std::vector<Entry>& entries) {
    for (size_t i = 0; i < entries.size(); ++i)
        for (size_t k = 0; k < i && entries[i].weight > 0; ++k)
            if (entries[k].weight > 0 && entries[k].joint == entries[i].joint) return true;
    return false;
}

// One vertex of the file, its joints and weights as they come.
void readEntries(const Sets& sets, uint32_t vertex, std::vector<Entry>& entries, GltfNotes& notes) {
    double sum = 0;
    for (size_t set = 0; set < sets.joints.size(); ++set) {
        std::array<uint32_t, 4> joints;
        std::array<float, 4> weights;
        readElement(*sets.joints[set], vertex, joints.data());
        readElement(*sets.weights[set], vertex, weights.data(), true);
        for (size_t k = 0; k < 4; ++k) {
            if (!std::isfinite(weights[k]) || weights[k] < 0) {
                weights[k] = 0;
                notes.add(GltfNote::badWeights);
            }
            entries[set * 4 + k] = {joints[k], weights[k]};
            sum += weights[k];
        }
    }
    if (sum == 0)
        notes.add(GltfNote::weightless);
    else if (std::abs(sum - 1) > 0.01)
        notes.add(GltfNote::wrongSums);
    if (repeatsJoint(entries)) notes.add(GltfNote::repeatedJoints);
}

void fillInfluences(const Sets& sets, GltfVertices& out, GltfNotes& notes) {
    out.mesh.influences.resize(out.fileVertex.size());
    const size_t places = sets.joints.size() * 4;
    std::vector<Entry> entries(places);
    for (size_t v = 0; v < out.fileVertex.size(); ++v) {
        readEntries(sets, out.fileVertex[v], entries, notes);
        Influences& influences = out.mesh.influences[v];
        if (places > kMaxInfluences) {
            influences = keepLargest(entries, notes);
            continue;
        }
        for (size_t k = 0; k < places; ++k) {
            influences.joints[k] = static_cast<uint16_t>(entries[k].joint);
            influences.weights[k] = static_cast<float>(entries[k].weight);
        }
    }
}

// `triangles`: of the first primitive; normals that have to be computed depend on them.
Result<void> readVertices(GltfData& data, const GltfPrimitive& primitive, const std::vector<uint32_t>& triangles,
                          GltfVertices& out, GltfNotes& notes) {
    if (auto ok = spend(data.budget, out.fileVertex.size(), kVertexBytes); !ok) return ok;
    const auto positions = openColumn(data, find(primitive, "POSITION"), 3);
    SKINBENCH_TRY(positions);
    noteFormat(data, **positions, Use::position, notes);
    const uint64_t count = (*positions)->count;
    out.mesh.positions.resize(out.fileVertex.size());
    glm::vec3 low(std::numeric_limits<float>::infinity()), high = -low;
    for (size_t v = 0; v < out.fileVertex.size(); ++v) {
        glm::vec3& p = out.mesh.positions[v];
        readElement(**positions, out.fileVertex[v], &p.x);
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return inputError(std::format("POSITION: vertex {} is not finite", out.fileVertex[v]));
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    noteBounds(data, find(primitive, "POSITION"), {{low.x, low.y, low.z}, {high.x, high.y, high.z}},
               out.fileVertex.size() == count, notes);
    if (auto ok = readUvs(data, find(primitive, "TEXCOORD_0"), count, out, notes); !ok) return ok;
    const auto sets = openSets(data, primitive, count, notes);
    SKINBENCH_TRY(sets);
    out.skinned = !sets->joints.empty();
    if (out.skinned) fillInfluences(*sets, out, notes);
    if (const int normals = find(primitive, "NORMAL"); normals >= 0)
        return readNormals(data, normals, count, out, notes);
    out.mesh.normals = smoothNormals(out.mesh.positions, triangles);
    return {};
}

Result<std::vector<uint32_t>> readTriangles(GltfData& data, const GltfPrimitive& primitive) {
    if (primitive.mode > kFan) return inputError(std::format("has the unknown mode {}", primitive.mode));
    const int position = find(primitive, "POSITION");
    if (position < 0) return inputError("has no POSITION");
    const auto positions = openColumn(data, position, 3);
    if (!positions) return std::unexpected(Error{positions.error().fault, "POSITION: " + positions.error().text});
    auto indices = readIndices(data, primitive, (*positions)->count);
    SKINBENCH_TRY(indices);
    return toTriangles(std::move(*indices), primitive.mode);
}

}  // namespace

Result<GltfMesh> readMesh(GltfData& data, const std::vector<GltfPrimitive>& primitives, GltfNotes& notes) {
    const auto failed = [&](size_t primitive, const Error& error) {
        const std::string place = primitives.size() > 1 ? std::format("primitive {}: ", primitive) : "";
        return std::unexpected(Error{error.fault, place + error.text});
    };
    GltfMesh mesh;
    mesh.parts.resize(primitives.size());
    std::map<std::map<std::string, int>, size_t> shared;
    std::vector<std::vector<size_t>> users;
    for (size_t p = 0; p < primitives.size(); ++p) {
        if (primitives[p].mode < kTriangles) {
            notes.add(GltfNote::skippedPrimitives);
            continue;
        }
        auto triangles = readTriangles(data, primitives[p]);
        if (!triangles) return failed(p, triangles.error());
        mesh.parts[p].indices = std::move(*triangles);
        if (mesh.parts[p].indices.empty()) continue;
        size_t group = users.size();
        // Normals that have to be computed depend on the triangles, so such vertices are not shared.
        if (find(primitives[p], "NORMAL") >= 0)
            group = shared.try_emplace(primitives[p].attributes, group).first->second;
        if (group == users.size()) users.emplace_back();
        users[group].push_back(p);
        mesh.parts[p].vertices = group;
    }
    mesh.vertices.resize(users.size());
    for (size_t group = 0; group < users.size(); ++group) {
        std::vector<std::vector<uint32_t>*> lists;
        for (const size_t p : users[group]) lists.push_back(&mesh.parts[p].indices);
        mesh.vertices[group].fileVertex = compact(lists);
        const size_t first = users[group].front();
        if (auto ok = readVertices(data, primitives[first], *lists.front(), mesh.vertices[group], notes); !ok)
            return failed(first, ok.error());
    }
    return mesh;
}

}  // namespace skinbench
