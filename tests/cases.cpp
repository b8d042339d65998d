#include "tests/cases.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <set>

namespace skinbench {
namespace fs = std::filesystem;

namespace {

// Options that meet in one shader or one buffer, beside each on its own.
const std::vector<AxisWords>& together() {
    static const std::vector<AxisWords> all = {
        {{"builder", {"scan"}},
         {"index_writes", {"single"}},
         {"vertex_fetch", {"pull"}},
         {"influences", {"4", "8"}},
         {"submission", {"per-copy", "batched"}}},
        {{"cull", {"compact", "primitive", "torabi"}},
         {"exchange", {"shared", "shuffle"}},
         {"scenario", {"direct", "prepass"}}},
        {{"cull", {"compact"}}, {"vertex_writes", {"first", "last"}}},
        {{"cluster_cull", {"list"}}, {"cluster_bounds", {"one-sphere", "joint-boxes", "instance"}}},
        {{"cluster_cull", {"task"}}, {"cluster_bounds", {"instance"}}, {"palette", {"uniform"}}},
        {{"cluster_cull", {"task"}}, {"cluster_tests", {"none", "cone"}}},
        {{"cluster_cull", {"task", "list"}}, {"cull", {"compact"}}, {"palette", {"uniform"}}},
        {{"cluster_cull", {"task"}}, {"submission", {"batched"}}},
        {{"cluster_cull", {"task", "list"}}, {"cull", {"compact"}}, {"view", {"culled"}}},
        {{"cluster_cull", {"task"}}, {"submission", {"batched"}}, {"view", {"culled"}}},
        {{"cull", {"torabi"}}, {"view", {"culled"}}},
        {{"cull", {"compact"}}, {"meshlet_limits", {"128/256"}}, {"scenario", {"direct", "prepass"}}},
        {{"scenario", {"prepass"}}, {"submission", {"batched"}}},
        {{"views", {"2"}}, {"scenario", {"prepass"}}},
        {{"queues", {"async"}}, {"submission", {"batched"}}},
        {{"queues", {"async"}}, {"cluster_cull", {"list"}}, {"views", {"2"}}},
        {{"views", {"2"}}, {"cluster_cull", {"task", "list"}}},
        {{"records", {"ordered"}}, {"layout", {"fixed"}}},
        {{"records", {"ordered"}}, {"palette", {"uniform"}}},
        {{"joints", {"meshlet", "staged"}}, {"influences", {"8"}}},
        {{"joints", {"meshlet", "staged"}},
         {"loads", {"clamped"}},
         {"records", {"ordered"}},
         {"palette", {"uniform"}},
         {"cull", {"compact"}},
         {"influences", {"4", "8"}}},
        {{"ci_grouping", {"triangles"}}, {"ci_key", {"ordered"}}},
        {{"ci_grouping", {"triangles"}}, {"ci_min", {"4"}}, {"influences", {"8"}}},
        {{"compute", {"staged+packed", "previous+half-rate"}}},
        {{"compute", {"staged", "previous", "tangents", "early-exit", "packed", "half-rate"}},
         {"scenario", {"prepass"}}},
        {{"compute", {"staged+previous+tangents+early-exit+packed+half-rate"}},
         {"scenario", {"direct", "prepass"}},
         {"influences", {"4", "8"}}},
        {{"compute", {"early-exit"}}, {"influences", {"8"}}},
        {{"compute", {"previous+tangents+early-exit+packed+half-rate"}}, {"submission", {"batched"}}},
        {{"compute", {"previous", "staged+previous+tangents+early-exit+packed+half-rate"}}, {"view", {"velocity"}}},
    };
    return all;
}

// What a view needs beside a device.
bool isSeen(const Case& c) {
    if (c.view == View::shaded) return true;
    if (c.view == View::velocity) return c.compute.previous;
    if (c.view == View::culled) return verdictsOf(c).size() > 1 && c.scenario == Scenario::direct;
    return c.builder || (c.view != View::meshlets && c.variant->fetches);
}

struct Collected {
    std::vector<Case> cases;
    std::set<std::string> known;
};

void collect(Collected& all, const Case& plain, const AxisWords& words) {
    const auto crossed = crossCases({plain}, words);
    SKINBENCH_ASSERT(crossed.has_value());
    for (const Case& c : *crossed)
        if (isSeen(c) && !unsupported(c, generousCaps(c.route->api)) && all.known.insert(caseId(c)).second)
            all.cases.push_back(c);
}

// Codecs that attributes cannot carry meet few options that the uncompressed one does not.
bool concernsPackedCodecs(const std::string& axis) {
    return axis == "influences" || axis == "scenario" || axis == "compute" || axis == "records" || axis == "palette";
}

bool concernsPackedCodecs(const AxisWords& words) {
    return std::ranges::all_of(words, [](const auto& named) { return concernsPackedCodecs(named.first); });
}

// One value stands for the others of an axis that does more of the same.
std::vector<std::string> wordsToTest(const Axis& axis) {
    if (axis.name == "meshlet_limits") return {axis.words.back()};
    return axis.name == "views" ? std::vector<std::string>{"2"} : axis.words;
}

}  // namespace

std::vector<Case> everyCase() {
    const auto plain = crossCases({{"codec", findAxis("codec")->words}, {"vertex_fetch", {"attributes"}}});
    SKINBENCH_ASSERT(plain.has_value());
    Collected all;
    for (Case c : *plain) {
        if (c.route->api == Api::cpu) continue;
        if (!c.codec->feedsAttributes && c.variant->fetches && !onMeshRoute(c)) c.fetch = VertexFetch::pull;
        collect(all, c, {});
        for (const Axis& axis : axes())
            if (!axis.words.empty() && !axis.inPath && axis.changes != Changes::raster &&
                (c.codec->feedsAttributes || concernsPackedCodecs(axis.name)))
                collect(all, c, {{axis.name, wordsToTest(axis)}});
        if (c.codec->feedsAttributes) collect(all, c, {{"layout", {"fixed"}}});
        for (const AxisWords& words : together())
            if (c.codec->feedsAttributes || concernsPackedCodecs(words)) collect(all, c, words);
    }
    return std::move(all.cases);
}

Case makeCase(const char* route, const char* variant, const char* codec) {
    Case c;
    c.route = findRoute(route);
    c.variant = findVariant(variant);
    c.codec = findCodec(codec);
    SKINBENCH_ASSERT(c.route && c.variant && c.codec);
    if (onMeshRoute(c)) {
        c.builder = findBuilder("meshopt");
        c.layout = findMeshletLayout("redirect");
    }
    return c;
}

DeviceCaps generousCaps(Api api) {
    DeviceCaps caps;
    caps.api = api;
    caps.name = "test device";
    caps.timestampBits = 64;
    caps.timestampPeriodNs = 1;
    caps.ext = {true, 256, 256, 128, 65535, 32768, 28672, 32, true};
    caps.nv = caps.ext;
    caps.subgroupSize = 32;
    caps.meshSubgroups = true;
    caps.subpixelBits = 8;
    caps.secondQueue = api == Api::vulkan;
    caps.maxComputeGroupCount = 65535;
    caps.maxComputeSharedBytes = 49152;
    caps.maxStorageBytes = uint64_t{1} << 32;
    caps.maxUniformBytes = 65536;
    caps.storageBlocksVertex = 8;
    return caps;
}

ShaderLibrary testShaders() {
    auto library = loadShaders(SKINBENCH_SOURCE_DIR "/shaders_glsl");
    return library ? *library : ShaderLibrary{};
}

Scene tinyScene(uint32_t segments) {
    Scene scene;
    scene.name = "bar";
    Mesh& mesh = scene.mesh;
    const uint32_t sides = 8, rings = segments * 2 + 1;
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t side = 0; side < sides; ++side) {
            const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(side) / sides;
            const glm::vec3 normal(std::cos(angle), 0, std::sin(angle));
            mesh.positions.push_back(normal * 0.3f + glm::vec3(0, ring * 0.25f, 0));
            mesh.normals.push_back(normal);
            mesh.uvs.emplace_back(side / static_cast<float>(sides), ring / static_cast<float>(rings));
            Influences influences;
            for (uint32_t i = 0; i < kMaxInfluences; ++i) {
                influences.joints[i] = static_cast<uint16_t>((ring / 2 + i) % segments);
                influences.weights[i] = i <= side ? 1.0f / static_cast<float>(1 + i + (ring + side) % 3) : 0.0f;
            }
            mesh.influences.push_back(influences);
        }
    for (uint32_t ring = 0; ring + 1 < rings; ++ring)
        for (uint32_t side = 0; side < sides; ++side) {
            const uint32_t a = ring * sides + side, b = ring * sides + (side + 1) % sides;
            for (uint32_t index : {a, a + sides, b, b, a + sides, b + sides}) mesh.indices.push_back(index);
        }
    scene.parts.push_back({"bar", 0, static_cast<uint32_t>(mesh.indices.size()), false});
    Clip bend{"bend", 2, {}};
    for (uint32_t s = 0; s < segments; ++s) {
        Node node;
        node.name = "joint" + std::to_string(s);
        node.parent = static_cast<int32_t>(s) - 1;
        node.translation = {0, s ? 0.5f : 0.0f, 0};
        scene.skeleton.nodes.push_back(node);
        glm::mat4 inverse(1);
        inverse[3] = glm::vec4(0, -0.5f * static_cast<float>(s), 0, 1);
        scene.skeleton.joints.push_back({s, inverse});
        const float half = 0.06f + 0.01f * static_cast<float>(s % 3);
        bend.channels.push_back({s,
                                 ChannelPath::rotation,
                                 Interpolation::linear,
                                 {0, 1, 2},
                                 {{0, 0, -std::sin(half), std::cos(half)},
                                  {std::sin(half), 0, 0, std::cos(half)},
                                  {0, 0, -std::sin(half), std::cos(half)}}});
    }
    scene.clips.push_back(bend);
    return scene;
}

Workload tinyWorkload(uint32_t copies) {
    WorkloadSettings settings;
    settings.copies = copies;
    settings.width = 320;
    settings.height = 180;
    auto workload = makeWorkload(tinyScene(), testShaders(), settings);
    SKINBENCH_ASSERT(workload);
    return std::move(*workload);
}

std::string modelFolder() {
    const char* given = std::getenv("SKINBENCH_MODELS");
    const std::string folder = given ? given : SKINBENCH_SOURCE_DIR "/../shared/models";
    std::error_code none;
    return fs::is_directory(folder, none) ? folder : "";
}

std::vector<std::string> modelFiles() {
    std::vector<std::string> files;
    const std::string folder = modelFolder();
    if (folder.empty()) return files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf")
            files.push_back(entry.path().string());
    std::ranges::sort(files);
    return files;
}

}  // namespace skinbench
