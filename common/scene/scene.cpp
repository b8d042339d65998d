#include "common/scene/scene.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <format>
#include <limits>
#include <numeric>
#include <span>

#include <meshoptimizer.h>

#include "common/core/text.h"

namespace skinbench {
namespace {

constexpr double kWeightEpsilon = 1e-7;  // docs/codecs.md 2
constexpr uint32_t kUnused = ~0u;        // meshoptimizer's mark for vertices that no index names

template <int N, class T>
bool isFinite(const glm::vec<N, T>& v) {
    for (int i = 0; i < N; ++i)
        if (!std::isfinite(v[i])) return false;
    return true;
}

bool isFinite(const glm::mat4& m) { return isFinite(m[0]) && isFinite(m[1]) && isFinite(m[2]) && isFinite(m[3]); }

// --- checks -----------------------------------------------------------------------------------------------------

Result<void> checkMesh(const Mesh& mesh, size_t joints) {
    const size_t vertices = mesh.positions.size();
    if (mesh.normals.size() != vertices || mesh.uvs.size() != vertices || mesh.influences.size() != vertices)
        return inputError(
            std::format("the vertex arrays differ in length: {} positions, {} normals, {} uvs, {} influences", vertices,
                        mesh.normals.size(), mesh.uvs.size(), mesh.influences.size()));
    if (mesh.indices.empty()) return inputError("the mesh has no triangle");
    if (mesh.indices.size() % 3 != 0)
        return inputError(counted(mesh.indices.size(), "index", "indices") + ", which is no multiple of 3");
    for (size_t i = 0; i < mesh.indices.size(); ++i)
        if (mesh.indices[i] >= vertices)
            return inputError(std::format("triangle {} names vertex {} of {}", i / 3, mesh.indices[i], vertices));
    for (size_t v = 0; v < vertices; ++v) {
        if (!isFinite(mesh.positions[v])) return inputError(std::format("vertex {}: the position is not finite", v));
        if (!isFinite(mesh.normals[v])) return inputError(std::format("vertex {}: the normal is not finite", v));
        if (!isFinite(mesh.uvs[v])) return inputError(std::format("vertex {}: the uv is not finite", v));
        for (int k = 0; k < kMaxInfluences; ++k) {
            const uint16_t joint = mesh.influences[v].joints[k];
            const float weight = mesh.influences[v].weights[k];
            if (!std::isfinite(weight)) return inputError(std::format("vertex {}: a weight is not finite", v));
            if (joint >= joints && !(joint == kNoJoint && weight == 0))
                return inputError(std::format("vertex {} names joint {} of {}", v, joint, joints));
        }
    }
    return {};
}

Result<void> checkSkeleton(const Skeleton& skeleton) {
    for (size_t i = 0; i < skeleton.nodes.size(); ++i) {
        const Node& node = skeleton.nodes[i];
        if (node.parent < -1 || node.parent >= static_cast<int32_t>(i))
            return inputError(std::format("node {}: its parent {} does not stand before it", i, node.parent));
        const glm::vec4 rotation(node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w);
        if (!isFinite(node.translation) || !isFinite(rotation) || !isFinite(node.scale) ||
            (node.matrix && !isFinite(*node.matrix)))
            return inputError(std::format("node {}: its transform is not finite", i));
    }
    if (skeleton.joints.size() > kMaxJoints)
        return inputError(std::format("{} joints are more than the limit of {}", skeleton.joints.size(), kMaxJoints));
    for (size_t j = 0; j < skeleton.joints.size(); ++j) {
        if (skeleton.joints[j].node >= skeleton.nodes.size())
            return inputError(
                std::format("joint {} names node {} of {}", j, skeleton.joints[j].node, skeleton.nodes.size()));
        if (!isFinite(skeleton.joints[j].inverseBind))
            return inputError(std::format("joint {}: its inverse bind matrix is not finite", j));
    }
    return {};
}

// Geometry is full of squares of lengths, and floats end at 3e38 and 1e-38.
Result<void> checkExtent(const Mesh& mesh) {
    constexpr double kLargest = 1e18, kSmallest = 1e-20;
    glm::dvec3 low(mesh.positions.front()), high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
    const double farthest = std::max({far.x, far.y, far.z}), diagonal = glm::length(high - low);
    if (farthest > kLargest)
        return inputError(
            std::format("its positions reach {:.3g}; scale the file to less than {:.0e}", farthest, kLargest));
    if (diagonal > 0 && diagonal < kSmallest)
        return inputError(std::format("it is {:.3g} large; scale the file to more than {:.0e}", diagonal, kSmallest));
    return {};
}

// --- influences -------------------------------------------------------------------------------------------------

struct Cleaned {
    Influences influences;
    double dropped = 0;  // share of the weight
};

Cleaned clean(const Influences& in, int keep) {
    struct Entry {
        uint16_t joint;
        double weight;
    };
    std::array<Entry, kMaxInfluences> entries;
    int count = 0;
    for (int i = 0; i < kMaxInfluences; ++i) {
        const double weight = in.weights[i];
        if (!(weight >= kWeightEpsilon) || !std::isfinite(weight)) continue;
        const auto same = std::find_if(entries.begin(), entries.begin() + count,
                                       [&](const Entry& entry) { return entry.joint == in.joints[i]; });
        if (same != entries.begin() + count)
            same->weight += weight;
        else
            entries[count++] = {in.joints[i], weight};
    }
    const auto before = [](const Entry& a, const Entry& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
    };
    for (int i = 1; i < count; ++i)
        for (int j = i; j > 0 && before(entries[j], entries[j - 1]); --j) std::swap(entries[j], entries[j - 1]);

    Cleaned out;
    out.influences.joints.fill(kNoJoint);
    if (count == 0) {
        out.influences.joints[0] = in.joints[0] == kNoJoint ? uint16_t{0} : in.joints[0];
        out.influences.weights[0] = 1;
        return out;
    }
    double sum = 0, lost = 0;
    for (int i = 0; i < count; ++i) (i < keep ? sum : lost) += entries[i].weight;
    out.dropped = lost / (sum + lost);
    for (int i = 0; i < std::min(count, keep); ++i) {
        const float weight = static_cast<float>(entries[i].weight / sum);
        if (weight == 0) break;
        out.influences.joints[i] = entries[i].joint;
        out.influences.weights[i] = weight;
    }
    return out;
}

// --- geometry ---------------------------------------------------------------------------------------------------

// Adding +0 turns -0 into +0, so that the two compare equal as bits.
void canonicalizeZeros(Mesh& mesh) {
    for (glm::vec3& p : mesh.positions) p += 0.0f;
    for (glm::vec3& n : mesh.normals) n += 0.0f;
    for (glm::vec2& uv : mesh.uvs) uv += 0.0f;
}

uint32_t normalizeNormals(Mesh& mesh) {
    uint32_t repaired = 0;
    for (glm::vec3& n : mesh.normals) {
        const double length = glm::length(glm::dvec3(n));
        const bool good = std::isfinite(length) && length > 0;
        n = good ? glm::vec3(glm::dvec3(n) / length) : glm::vec3(0, 0, 1);
        repaired += !good;
    }
    return repaired;
}

template <class T>
void remapArray(std::vector<T>& array, std::span<const uint32_t> remap, size_t count) {
    std::vector<T> moved(count);
    for (size_t i = 0; i < array.size(); ++i)
        if (remap[i] != kUnused) moved[remap[i]] = array[i];
    array = std::move(moved);
}

void remapVertices(Mesh& mesh, std::span<const uint32_t> remap, size_t count) {
    remapArray(mesh.positions, remap, count);
    remapArray(mesh.normals, remap, count);
    remapArray(mesh.uvs, remap, count);
    remapArray(mesh.influences, remap, count);
    for (uint32_t& index : mesh.indices) index = remap[index];
}

void weld(Mesh& mesh) {
    const std::array<meshopt_Stream, 4> streams = {{
        {mesh.positions.data(), sizeof(glm::vec3), sizeof(glm::vec3)},
        {mesh.normals.data(), sizeof(glm::vec3), sizeof(glm::vec3)},
        {mesh.uvs.data(), sizeof(glm::vec2), sizeof(glm::vec2)},
        {mesh.influences.data(), sizeof(Influences), sizeof(Influences)},
    }};
    std::vector<uint32_t> remap(mesh.positions.size());
    const size_t count = meshopt_generateVertexRemapMulti(remap.data(), mesh.indices.data(), mesh.indices.size(),
                                                          remap.size(), streams.data(), streams.size());
    remapVertices(mesh, remap, count);
}

template <class T>
void spread(std::vector<T>& array, std::span<const uint32_t> indices) {
    std::vector<T> corners(indices.size());
    for (size_t i = 0; i < indices.size(); ++i) corners[i] = array[indices[i]];
    array = std::move(corners);
}

void unweld(Mesh& mesh) {
    spread(mesh.positions, mesh.indices);
    spread(mesh.normals, mesh.indices);
    spread(mesh.uvs, mesh.indices);
    spread(mesh.influences, mesh.indices);
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
}

void orderTriangles(Mesh& mesh, uint32_t first, uint32_t count) {
    if (count == 0) return;
    const std::span<uint32_t> range(mesh.indices.data() + first, count);
    const auto [low, high] = std::ranges::minmax(range);
    // The optimiser's memory is by vertex count, so a part sees its own vertices only.
    std::vector<uint32_t> local(range.begin(), range.end());
    for (uint32_t& index : local) index -= low;
    std::vector<uint32_t> ordered(count);
    meshopt_optimizeVertexCache(ordered.data(), local.data(), count, size_t{high} - low + 1);
    std::ranges::transform(ordered, range.begin(), [low](uint32_t index) { return index + low; });
}

void orderForCache(Mesh& mesh, const std::vector<Part>& parts) {
    if (parts.empty()) orderTriangles(mesh, 0, static_cast<uint32_t>(mesh.indices.size()));
    for (const Part& part : parts) orderTriangles(mesh, part.firstIndex, part.indexCount);
    std::vector<uint32_t> remap(mesh.positions.size());
    size_t count =
        meshopt_optimizeVertexFetchRemap(remap.data(), mesh.indices.data(), mesh.indices.size(), remap.size());
    for (uint32_t& place : remap)
        if (place == kUnused) place = static_cast<uint32_t>(count++);
    remapVertices(mesh, remap, count);
}

Result<Scene> loadBuiltin(const std::string& name) {
    const std::string rest = name.substr(name.find(':') + 1);
    const size_t colon = rest.find(':');
    const std::string c = rest.substr(0, colon);
    std::string known;
    for (const BuiltinScene& scene : builtinScenes()) {
        known += (known.empty() ? "" : ", ") + std::string(scene.name);
        if (c != scene.name) continue;
        uint32_t vertices = scene.defaultVertices;
        if (colon != rest.npos) {
            const char* end = rest.data() + rest.size();
            const auto [stop, error] = std::from_chars(rest.data() + colon + 1, end, vertices);
            if (error != std::errc{} || stop != end || vertices < kMinBuiltinVertices || vertices > kMaxBuiltinVertices)
                return inputError(std::format("{}: \"{}\" is not a number of vertices from {} to {}", name,
                                              rest.substr(colon + 1), kMinBuiltinVertices, kMaxBuiltinVertices));
        }
        return makeBuiltin(c, vertices);
    }
    return inputError(std::format("{}: there is no built-in scene \"{}\"; choose one of {}", name, c, known));
}

}  // namespace

Result<Scene> loadScene(const std::string& name) {
    if (name.empty()) return inputError("the name of an input file is empty");
    return name.starts_with("builtin:") ? loadBuiltin(name) : loadGltf(name);
}

Result<void> checkChannel(const Channel& channel, size_t nodes) {
    if (channel.node >= nodes) return inputError(std::format("names node {} of {}", channel.node, nodes));
    if (channel.times.empty()) return inputError("has no key");
    const size_t perKey = channel.interpolation == Interpolation::cubicSpline ? 3 : 1;
    if (channel.values.size() != channel.times.size() * perKey)
        return inputError(std::format("has {} for {}", counted(channel.values.size(), "value"),
                                      counted(channel.times.size(), "key")));
    for (size_t k = 0; k < channel.times.size(); ++k) {
        if (!std::isfinite(channel.times[k])) return inputError(std::format("the time of key {} is not finite", k));
        if (k > 0 && channel.times[k] < channel.times[k - 1])
            return inputError(std::format("the key times do not ascend at key {}", k));
    }
    for (const glm::vec4& value : channel.values)
        if (!isFinite(value)) return inputError("a value is not finite");
    return {};
}

Result<void> checkScene(const Scene& scene) {
    if (auto ok = checkMesh(scene.mesh, scene.skeleton.joints.size()); !ok) return ok;
    if (auto ok = checkExtent(scene.mesh); !ok) return ok;
    if (auto ok = checkSkeleton(scene.skeleton); !ok) return ok;
    uint64_t end = 0;
    for (const Part& part : scene.parts) {
        if (part.firstIndex < end || part.firstIndex % 3 != 0 || part.indexCount % 3 != 0 ||
            uint64_t{part.firstIndex} + part.indexCount > scene.mesh.indices.size())
            return inputError("part " + part.name + ": its index range is broken");
        end = uint64_t{part.firstIndex} + part.indexCount;
    }
    for (const Clip& clip : scene.clips) {
        if (!std::isfinite(clip.duration)) return inputError("clip " + clip.name + ": its duration is not finite");
        for (size_t c = 0; c < clip.channels.size(); ++c)
            if (auto ok = checkChannel(clip.channels[c], scene.skeleton.nodes.size()); !ok)
                return inputError(std::format("clip {}: channel {}: {}", clip.name, c, ok.error().text));
    }
    return {};
}

Result<void> checkSkinned(const Scene& scene) {
    if (scene.parts.empty() || !std::ranges::all_of(scene.parts, &Part::rigid)) return {};
    return inputError(scene.name + ": no vertex is skinned: no mesh has both a skin and JOINTS_0 and WEIGHTS_0");
}

DroppedWeight cleanWeights(Mesh& mesh, int keep) {
    SKINBENCH_ASSERT(keep >= 1 && keep <= kMaxInfluences);
    double max = 0, sum = 0;
    for (Influences& influences : mesh.influences) {
        const Cleaned cleaned = clean(influences, keep);
        influences = cleaned.influences;
        max = std::max(max, cleaned.dropped);
        sum += cleaned.dropped;
    }
    return {static_cast<float>(max), mesh.influences.empty() ? 0 : sum / static_cast<double>(mesh.influences.size())};
}

Result<Scene> prepareScene(Scene scene, const PrepareOptions& options) {
    if (options.influences < 1 || options.influences > kMaxInfluences)
        return inputError(
            std::format("{} influences a vertex cannot be kept; choose 1 to {}", options.influences, kMaxInfluences));
    const uint32_t repaired = normalizeNormals(scene.mesh);
    SKINBENCH_TRY(checkScene(scene));
    if (repaired > 0) scene.warnings.push_back(counted(repaired, "normal") + " had no direction; set to +z");

    const DroppedWeight dropped = cleanWeights(scene.mesh, options.influences);
    if (dropped.max > 0)
        scene.warnings.push_back(
            std::format("only the {} largest influences of a vertex were kept; a vertex lost up to "
                        "{:.3g} of its weight, {:.3g} on average",
                        options.influences, dropped.max, dropped.mean));
    canonicalizeZeros(scene.mesh);
    if (options.geometry == Geometry::welded) weld(scene.mesh);
    // Corners share nothing, so their triangles are put into the order of the welded mesh.
    if (options.geometry == Geometry::unwelded && options.cacheOrder) weld(scene.mesh);
    if (options.cacheOrder) orderForCache(scene.mesh, scene.parts);
    if (options.geometry == Geometry::unwelded) unweld(scene.mesh);
    return scene;
}

SceneStats sceneStats(const Scene& scene) {
    SceneStats stats;
    stats.vertices = static_cast<uint32_t>(scene.mesh.positions.size());
    stats.triangles = static_cast<uint32_t>(scene.mesh.indices.size() / 3);
    stats.joints = static_cast<uint32_t>(scene.skeleton.joints.size());
    std::vector<std::array<uint16_t, kMaxInfluences>> tuples;
    tuples.reserve(scene.mesh.influences.size());
    uint64_t influences = 0;
    for (const Influences& stored : scene.mesh.influences) {
        const Influences cleaned = clean(stored, kMaxInfluences).influences;
        const auto end = std::ranges::find(cleaned.joints, kNoJoint);
        const uint32_t count = static_cast<uint32_t>(end - cleaned.joints.begin());
        influences += count;
        stats.maxInfluences = std::max(stats.maxInfluences, count);
        if (tuples.empty() || tuples.back() != cleaned.joints) tuples.push_back(cleaned.joints);
    }
    std::ranges::sort(tuples);
    stats.uniqueTuples = static_cast<uint32_t>(std::ranges::unique(tuples).begin() - tuples.begin());
    if (stats.vertices > 0) stats.meanInfluences = static_cast<double>(influences) / stats.vertices;
    return stats;
}

const char* geometryName(Geometry geometry) {
    constexpr const char* kNames[] = {"welded", "stored", "unwelded"};
    return kNames[static_cast<size_t>(geometry)];
}

}  // namespace skinbench
