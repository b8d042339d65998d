#include "tests/cases.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

namespace skinbench {
namespace fs = std::filesystem;

namespace {

bool onMeshRoute(const Case& which) { return which.route->dialect != MeshDialect::none; }

Case plainCase(const Route& route, const Variant& variant, const Codec& codec) {
    Case which;
    which.route = &route;
    which.variant = &variant;
    which.codec = &codec;
    if (onMeshRoute(which)) {
        which.builder = findBuilder("meshopt");
        which.layout = findMeshletLayout("redirect");
    } else if (variant.fetches && !feedsAttributes(codec)) {
        which.fetch = VertexFetch::pull;
    }
    return which;
}

// What every variant has: influences, submission, and a second value of whatever the route offers.
void addCommon(std::vector<Case>& cases, const Case& plain) {
    for (int influences : {4, 8})
        for (Submission submission : {Submission::perCopy, Submission::batched})
            for (bool second : {false, true}) {
                Case which = plain;
                which.influences = influences;
                which.submission = submission;
                if (usesPartition(which) && submission == Submission::batched) continue;
                if (second && onMeshRoute(which)) {
                    which.builder = findBuilder("scan");
                    which.packedWrites = false;
                } else if (second && which.variant->fetches) {
                    which.fetch = VertexFetch::pull;
                }
                cases.push_back(which);
            }
}

void addViews(std::vector<Case>& cases, const Case& plain) {
    for (View view : {View::meshlets, View::weights, View::tuples, View::resolution}) {
        Case which = plain;
        which.view = view;
        if (onMeshRoute(which) || (view != View::meshlets && which.variant->fetches)) cases.push_back(which);
    }
}

// One option at a time, and a few together.
void addMeshOptions(std::vector<Case>& cases, const Case& plain) {
    auto add = [&](auto change) {
        Case which = plain;
        change(which);
        cases.push_back(which);
    };
    add([](Case& c) { c.layout = findMeshletLayout("fixed"); });
    add([](Case& c) { c.shape.clampedLoads = true; });
    add([](Case& c) { c.shape.orderedRecords = true; });
    add([](Case& c) { c.shape.orderedRecords = true, c.layout = findMeshletLayout("fixed"); });
    if (!plain.variant->skins) return;
    add([](Case& c) { c.shape.uniformPalette = true; });
    for (Scenario scenario : {Scenario::direct, Scenario::prepass}) {
        for (Cull cull : {Cull::compact, Cull::primitive, Cull::torabi})
            if (cull != Cull::primitive || plain.route->dialect == MeshDialect::ext)
                add([&](Case& c) { c.cull = cull, c.scenario = scenario, c.exchange = Exchange::shared; });
        add([&](Case& c) { c.cull = Cull::compact, c.scenario = scenario, c.exchange = Exchange::shuffle; });
        add([&](Case& c) { c.cull = Cull::compact, c.scenario = scenario, c.limits = {128, 256}; });
    }
    add([](Case& c) { c.scenario = Scenario::prepass, c.submission = Submission::batched; });
    if (sharesJointLists(plain)) {
        add([](Case& c) { c.common.fat = true; });
        add([](Case& c) { c.common.grouping = CiGrouping::triangles, c.common.key = CiKey::ordered; });
        add([](Case& c) { c.common.grouping = CiGrouping::triangles, c.common.minVertices = 4, c.influences = 8; });
        return;
    }
    for (JointSource joints : {JointSource::meshlet, JointSource::staged})
        for (int influences : {4, 8}) {
            add([&](Case& c) { c.shape.joints = joints, c.influences = influences; });
            add([&](Case& c) {
                c.shape = {joints, true, true, true}, c.influences = influences, c.cull = Cull::compact;
            });
        }
}

// Each option alone and all together, with whatever else changes the same shaders.
void addComputeOptions(std::vector<Case>& cases, const Case& plain) {
    auto add = [&](const ComputeOptions& options, auto change) {
        Case which = plain;
        which.compute = options;
        change(which);
        cases.push_back(which);
    };
    const ComputeOptions all{true, true, true, true, true, true}, unstaged{false, true, true, true, true, true};
    auto nothing = [](Case&) {};
    add(all, nothing);
    add({.earlyExit = true}, nothing);
    if (!feedsAttributes(*plain.codec)) return;
    for (const ComputeWord& word : computeWords()) {
        ComputeOptions options;
        options.*word.option = true;
        if (word.option != &ComputeOptions::earlyExit) add(options, nothing);
        add(options, [](Case& c) { c.scenario = Scenario::prepass; });
    }
    add({.staged = true, .packed = true}, nothing);
    add({.previous = true, .halfRate = true}, nothing);
    add(all, [](Case& c) { c.scenario = Scenario::prepass; });
    add(all, [](Case& c) { c.influences = 8; });
    add({.earlyExit = true}, [](Case& c) { c.influences = 8; });
    add(unstaged, [](Case& c) { c.submission = Submission::batched; });
    add({.previous = true}, [](Case& c) { c.view = View::velocity; });
    add(all, [](Case& c) { c.view = View::velocity; });
}

}  // namespace

std::vector<Case> everyCase() {
    std::vector<Case> cases;
    for (const Route& route : routes())
        for (const Variant& variant : variants()) {
            if (!runsOn(variant, route) || route.api == Api::cpu) continue;
            for (const Codec& codec : codecs()) {
                const Case plain = plainCase(route, variant, codec);
                if (feedsAttributes(codec)) {
                    addCommon(cases, plain);
                    addViews(cases, plain);
                    if (onMeshRoute(plain)) addMeshOptions(cases, plain);
                    if (&variant == findVariant("compute")) addComputeOptions(cases, plain);
                    if (variant.prepasses && !onMeshRoute(plain)) {
                        cases.push_back(plain);
                        cases.back().scenario = Scenario::prepass;
                    }
                    continue;
                }
                if (variant.onCpuRoute || unsupported(plain, generousCaps(route.api))) continue;
                cases.push_back(plain);
                if (variant.prepasses) {
                    cases.push_back(plain);
                    cases.back().scenario = Scenario::prepass;
                }
                if (&variant == findVariant("compute")) addComputeOptions(cases, plain);
                if (onMeshRoute(plain) && variant.skins) {
                    cases.push_back(plain);
                    cases.back().shape.orderedRecords = true;
                    cases.back().shape.uniformPalette = true;
                }
                if (codec.name != std::string("uc16") && codec.name != std::string("pc")) continue;
                cases.push_back(plain);
                cases.back().influences = 8;
            }
        }
    return cases;
}

Case makeCase(const char* route, const char* variant, const char* codec) {
    Case which;
    which.route = findRoute(route);
    which.variant = findVariant(variant);
    which.codec = findCodec(codec);
    SKINBENCH_ASSERT(which.route && which.variant && which.codec);
    if (onMeshRoute(which)) {
        which.builder = findBuilder("meshopt");
        which.layout = findMeshletLayout("redirect");
    }
    return which;
}

DeviceCaps generousCaps(Api api) {
    DeviceCaps caps;
    caps.api = api;
    caps.name = "test device";
    caps.timestampBits = 64;
    caps.timestampPeriodNs = 1;
    caps.ext = {true, 256, 256, 128, 65535, 32768, 28672, 32};
    caps.nv = caps.ext;
    caps.subgroupSize = 32;
    caps.meshSubgroups = true;
    caps.subpixelBits = 8;
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
