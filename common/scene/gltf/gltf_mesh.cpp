#include "common/scene/gltf/gltf_mesh.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <numeric>

namespace skinbench {
namespace {

constexpr int kMaxSets = 16;  // JOINTS_0 to JOINTS_15
enum Mode { kTriangles = 4, kStrip = 5, kFan = 6 };

int find(const GltfPrimitive& primitive, const std::string& name) {
    const auto it = primitive.attributes.find(name);
    return it == primitive.attributes.end() ? -1 : it->second;
}

Result<std::vector<float>> readAttribute(const GltfData& data, int accessor, const std::string& name, int components,
                                         size_t vertices, bool normalized = false) {
    auto values = readFloats(data, accessor, components, normalized);
    if (!values) return std::unexpected(Error{values.error().fault, name + ": " + values.error().text});
    if (values->size() != vertices * components)
        return inputError(
            std::format("{} has {} elements, POSITION has {}", name, values->size() / components, vertices));
    return values;
}

// --- triangles --------------------------------------------------------------------------------------------------

Result<std::vector<uint32_t>> readIndices(const GltfData& data, const GltfPrimitive& primitive, size_t vertices) {
    std::vector<uint32_t> indices(vertices);
    if (primitive.indices >= 0) {
        auto read = readUnsigned(data, primitive.indices, 1, 4);
        if (!read) return std::unexpected(Error{read.error().fault, "indices: " + read.error().text});
        indices = std::move(*read);
    } else {
        std::iota(indices.begin(), indices.end(), 0u);
    }
    for (size_t i = 0; i < indices.size(); ++i)
        if (indices[i] >= vertices)
            return inputError(std::format("index {} is vertex {}, but there are {} vertices", i, indices[i], vertices));
    return indices;
}

Result<std::vector<uint32_t>> toTriangles(std::vector<uint32_t> indices, int mode) {
    if (mode == kTriangles) {
        if (indices.size() % 3 != 0)
            return inputError(std::format("{} indices are not whole triangles", indices.size()));
        return indices;
    }
    std::vector<uint32_t> triangles;
    for (size_t i = 0; i + 2 < indices.size(); ++i) {
        const size_t odd = i % 2;
        if (mode == kStrip)
            triangles.insert(triangles.end(), {indices[i], indices[i + 1 + odd], indices[i + 2 - odd]});
        else
            triangles.insert(triangles.end(), {indices[i + 1], indices[i + 2], indices[0]});
    }
    return triangles;
}

// The cross product's length is twice the area, so that large triangles count more.
std::vector<glm::vec3> smoothNormals(const Mesh& mesh) {
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0));
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::dvec3 a(mesh.positions[mesh.indices[i]]);
        const glm::dvec3 b(mesh.positions[mesh.indices[i + 1]]);
        const glm::dvec3 c(mesh.positions[mesh.indices[i + 2]]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        for (int k = 0; k < 3; ++k) sums[mesh.indices[i + k]] += normal;
    }
    std::vector<glm::vec3> normals(sums.size());
    for (size_t v = 0; v < sums.size(); ++v) {
        const double length = glm::length(sums[v]);
        normals[v] = length > 0 && std::isfinite(length) ? glm::vec3(sums[v] / length) : glm::vec3(0, 0, 1);
    }
    return normals;
}

// --- vertices ---------------------------------------------------------------------------------------------------

Result<void> readNormals(const GltfData& data, int accessor, Mesh& mesh, GltfRepairs& repairs) {
    const auto values = readAttribute(data, accessor, "NORMAL", 3, mesh.positions.size());
    if (!values) return std::unexpected(values.error());
    mesh.normals.resize(mesh.positions.size());
    for (size_t v = 0; v < mesh.normals.size(); ++v) {
        const glm::dvec3 n((*values)[v * 3], (*values)[v * 3 + 1], (*values)[v * 3 + 2]);
        const double length = glm::length(n);
        const bool good = std::isfinite(length) && length > 0;
        // Normals that are as good as floats get stay as they are.
        const bool unit = std::abs(length - 1) < 1e-5;
        mesh.normals[v] = !good ? glm::vec3(0, 0, 1) : unit ? glm::vec3(n) : glm::vec3(n / length);
        repairs.badNormals += !good;
    }
    return {};
}

Result<void> readUvs(const GltfData& data, int accessor, Mesh& mesh, GltfRepairs& repairs) {
    mesh.uvs.assign(mesh.positions.size(), glm::vec2(0));
    if (accessor < 0) return {};
    const auto values = readAttribute(data, accessor, "TEXCOORD_0", 2, mesh.positions.size());
    if (!values) return std::unexpected(values.error());
    for (size_t v = 0; v < mesh.uvs.size(); ++v) {
        const glm::vec2 uv((*values)[v * 2], (*values)[v * 2 + 1]);
        const bool good = std::isfinite(uv.x) && std::isfinite(uv.y);
        if (good) mesh.uvs[v] = uv;
        repairs.badUvs += !good;
    }
    return {};
}

struct Sets {
    std::vector<std::vector<uint32_t>> joints;
    std::vector<std::vector<float>> weights;
};

Result<Sets> readSets(const GltfData& data, const GltfPrimitive& primitive, size_t vertices) {
    Sets sets;
    for (int n = 0;; ++n) {
        const std::string jointName = std::format("JOINTS_{}", n), weightName = std::format("WEIGHTS_{}", n);
        const int joints = find(primitive, jointName), weights = find(primitive, weightName);
        if (joints < 0 && weights < 0) return sets;
        if (joints < 0 || weights < 0)
            return inputError(joints < 0 ? weightName + " has no " + jointName : jointName + " has no " + weightName);
        if (n == kMaxSets) return inputError(std::format("has more than {} influences a vertex", kMaxSets * 4));
        auto indices = readUnsigned(data, joints, 4, 2);
        if (!indices) return std::unexpected(Error{indices.error().fault, jointName + ": " + indices.error().text});
        if (indices->size() != vertices * 4)
            return inputError(
                std::format("{} has {} elements, POSITION has {}", jointName, indices->size() / 4, vertices));
        auto values = readAttribute(data, weights, weightName, 4, vertices, true);
        if (!values) return std::unexpected(values.error());
        sets.joints.push_back(std::move(*indices));
        sets.weights.push_back(std::move(*values));
    }
}

struct Entry {
    uint32_t joint = 0;
    double weight = 0;
};

// Of more than kMaxInfluences the largest stay. Places of one joint are added first, else it could lose its place.
Influences keepLargest(std::vector<Entry>& entries, GltfRepairs& repairs) {
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
        ++repairs.overfull;
        repairs.overfullMax = std::max(repairs.overfullMax, 1 - kept / all);
    }
    return out;
}

void fillInfluences(const Sets& sets, Mesh& mesh, GltfRepairs& repairs) {
    mesh.influences.resize(mesh.positions.size());
    const size_t places = sets.joints.size() * 4;
    std::vector<Entry> entries(places);
    for (size_t v = 0; v < mesh.influences.size(); ++v) {
        double sum = 0;
        for (size_t k = 0; k < places; ++k) {
            float weight = sets.weights[k / 4][v * 4 + k % 4];
            if (!std::isfinite(weight) || weight < 0) {
                weight = 0;
                ++repairs.badWeights;
            }
            entries[k] = {sets.joints[k / 4][v * 4 + k % 4], weight};
            sum += weight;
        }
        if (sum == 0)
            ++repairs.weightless;
        else if (std::abs(sum - 1) > 0.01)
            ++repairs.wrongSums;
        if (places > kMaxInfluences) {
            mesh.influences[v] = keepLargest(entries, repairs);
            continue;
        }
        for (size_t k = 0; k < places; ++k) {
            mesh.influences[v].joints[k] = static_cast<uint16_t>(entries[k].joint);
            mesh.influences[v].weights[k] = static_cast<float>(entries[k].weight);
        }
    }
}

Result<void> readVertices(const GltfData& data, const GltfPrimitive& primitive, size_t vertices,
                          const std::vector<float>& positions, GltfMeshPart& part, GltfRepairs& repairs) {
    part.mesh.positions.resize(vertices);
    for (size_t v = 0; v < vertices; ++v) {
        part.mesh.positions[v] = {positions[v * 3], positions[v * 3 + 1], positions[v * 3 + 2]};
        const glm::vec3& p = part.mesh.positions[v];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return inputError(std::format("POSITION: vertex {} is not finite", v));
    }
    if (auto ok = readUvs(data, find(primitive, "TEXCOORD_0"), part.mesh, repairs); !ok) return ok;
    const auto sets = readSets(data, primitive, vertices);
    if (!sets) return std::unexpected(sets.error());
    part.skinned = !sets->joints.empty();
    if (part.skinned) fillInfluences(*sets, part.mesh, repairs);
    if (const int normals = find(primitive, "NORMAL"); normals >= 0)
        return readNormals(data, normals, part.mesh, repairs);
    part.mesh.normals = smoothNormals(part.mesh);
    return {};
}

}  // namespace

Result<GltfMeshPart> readPrimitive(const GltfData& data, const GltfPrimitive& primitive, const GltfMeshPart* shared,
                                   GltfRepairs& repairs) {
    GltfMeshPart part;
    part.attributes = primitive.attributes;
    if (primitive.mode < kTriangles) {
        ++repairs.skippedPrimitives;
        part.attributes.clear();
        return part;
    }
    if (primitive.mode > kFan) return inputError(std::format("has the unknown mode {}", primitive.mode));
    const int position = find(primitive, "POSITION");
    if (position < 0) return inputError("has no POSITION");
    // Normals that have to be computed depend on the triangles, so such vertices are not shared.
    const bool reuse = shared && find(primitive, "NORMAL") >= 0;
    std::vector<float> positions;
    size_t vertices = 0;
    if (reuse) {
        vertices = shared->mesh.positions.size();
    } else {
        auto read = readFloats(data, position, 3);
        if (!read) return std::unexpected(Error{read.error().fault, "POSITION: " + read.error().text});
        positions = std::move(*read);
        vertices = positions.size() / 3;
    }
    auto indices = readIndices(data, primitive, vertices);
    if (!indices) return std::unexpected(indices.error());
    auto triangles = toTriangles(std::move(*indices), primitive.mode);
    if (!triangles) return std::unexpected(triangles.error());
    part.mesh.indices = std::move(*triangles);
    part.ownsVertices = !reuse;
    part.skinned = reuse && shared->skinned;
    if (!reuse)
        if (auto ok = readVertices(data, primitive, vertices, positions, part, repairs); !ok)
            return std::unexpected(ok.error());
    return part;
}

std::vector<std::string> describe(const GltfRepairs& repairs) {
    std::vector<std::string> texts;
    const auto say = [&](uint64_t count, const char* one, const char* many) {
        if (count > 0) texts.push_back(std::format("{} {}", count, count == 1 ? one : many));
    };
    say(repairs.badWeights, "weight is negative or not finite; set to 0",
        "weights are negative or not finite; set to 0");
    say(repairs.wrongSums, "vertex has weights that do not sum to 1; normalised",
        "vertices have weights that do not sum to 1; normalised");
    say(repairs.weightless, "vertex has no weight at all; bound to its first joint",
        "vertices have no weight at all; bound to their first joint");
    if (repairs.overfull > 0)
        texts.push_back(
            std::format("more than {} influences in {} vertices; the largest {} were kept, and a vertex lost "
                        "up to {:.3g} of its weight",
                        kMaxInfluences, repairs.overfull, kMaxInfluences, repairs.overfullMax));
    say(repairs.badNormals, "normal has no direction; set to +z", "normals have no direction; set to +z");
    say(repairs.badUvs, "uv is not finite; set to 0", "uvs are not finite; set to 0");
    say(repairs.skippedPrimitives, "primitive of points or lines is ignored",
        "primitives of points or lines are ignored");
    return texts;
}

}  // namespace skinbench
