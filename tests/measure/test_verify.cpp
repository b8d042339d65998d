// The bound of a codec's position error under a pose: it holds, it is not empty words, and damaged bits exceed it.
#include <cmath>
#include <limits>

#include <catch2/catch_test_macros.hpp>

#include "common/codecs/packed.h"
#include "common/measure/verify.h"
#include "tests/cases.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;

namespace {

constexpr double kTolerance = 2e-6;  // of the skinning itself, in single precision

Case meshCase(const Codec& codec, int influences) {
    Case c;
    c.route = findRoute("vk-ext");
    c.variant = findVariant("mesh");
    c.codec = &codec;
    c.builder = findBuilder("meshopt");
    c.layout = findMeshletLayout("redirect");
    c.influences = influences;
    return c;
}

// What a variant without a fault would capture of the first and the last copy.
std::vector<SkinnedVertex> skinDecoded(const PlanInput& input, const FrameData& frame) {
    const Mesh decoded = decodeOnCpu(input.scene->mesh, *input.encoded);
    std::vector<SkinnedVertex> captured;
    for (uint32_t copy : {0u, input.copies - 1}) {
        const Palette& palette = paletteOfCopy(frame, copy);
        std::vector<SkinnedVertex> out(decoded.positions.size());
        skinOnCpu({{&decoded, 1}, {&palette, 1}, out}, 1);
        captured.insert(captured.end(), out.begin(), out.end());
    }
    return captured;
}

struct Figures {
    double error = 0;
    double bound = 0;
};

Figures figuresOf(const Case& c, const PlanInput& input, const FrameData& frame) {
    const auto bound = codecPositionBound(c, input, frame);
    REQUIRE(bound);
    return {capturedError(makeReferences(c, input, frame), skinDecoded(input, frame)).source.position, *bound};
}

Workload workloadOf(Result<Scene> scene) {
    REQUIRE(scene);
    WorkloadSettings settings;
    settings.copies = 3;
    auto workload = makeWorkload(std::move(*scene), testShaders(), settings);
    REQUIRE(workload);
    return std::move(*workload);
}

// How often the smallest bound exceeds the error that it bounds.
double requireBounded(Workload& workload, int influences) {
    const auto frame = makeFrame(workload, influences, 3);
    REQUIRE(frame);
    double tightest = 1e30;
    size_t bounded = 0;
    for (const Codec& codec : codecs()) {
        const Case c = meshCase(codec, influences);
        const auto input = planInput(workload, c);
        if (!input) continue;  // too many tuples, or 4 influences only
        const Figures figures = figuresOf(c, *input, *frame);
        INFO(workload.stored.name << " " << codec.name << ": error " << figures.error << ", bound " << figures.bound);
        CHECK(figures.error <= figures.bound + kTolerance);
        if (!input->encoded->decode) {
            CHECK(figures.bound == 0);
            continue;
        }
        CHECK(figures.bound < 0.05);
        tightest = std::min(tightest, figures.bound / figures.error);
        ++bounded;
    }
    CHECK(bounded >= (influences == 4 ? 7 : 2));
    return tightest;
}

}  // namespace

TEST_CASE("the bound of a codec's position error holds and is near the error") {
    double tightest = 1e30;
    for (const char* name : {"biped", "robot", "creature"}) {
        Workload workload = workloadOf(makeBuiltin(name, 3000));
        tightest = std::min(tightest, requireBounded(workload, 4));
    }
    Workload bar = workloadOf(tinyScene());
    for (int influences : {4, 8}) tightest = std::min(tightest, requireBounded(bar, influences));
    CHECK(tightest < 20);
}

TEST_CASE("the bound of a codec's position error holds on models") {
    if (modelFolder().empty()) SKIP("no model folder: set SKINBENCH_MODELS to run this test");
    for (const char* name : {"fox.glb", "cesium_man.glb", "dragon.glb"}) {
        Workload workload = workloadOf(loadScene(modelFolder() + "/" + name));
        CHECK(requireBounded(workload, 4) < 20);
    }
}

TEST_CASE("vertices that are not skinned are bounded by the grid alone") {
    Workload workload = workloadOf(makeBuiltin("biped", 3000));
    const auto frame = makeFrame(workload, 4, 0);
    REQUIRE(frame);
    Case c = meshCase(*findCodec("pc"), 4);
    const auto skinned = planInput(workload, c);
    REQUIRE(skinned);
    const double posed = *codecPositionBound(c, *skinned, *frame);
    Variant still = *c.variant;
    still.skins = false;
    c.variant = &still;
    const double resting = *codecPositionBound(c, *skinned, *frame);
    CHECK(resting > 0.5 / 65535 / 2);
    CHECK(resting < 1.0 / 65535);
    CHECK(posed > 10 * resting);
}

TEST_CASE("damaged bits exceed the bound, and a codec without a promise has none") {
    Workload workload = workloadOf(makeBuiltin("biped", 3000));
    const auto frame = makeFrame(workload, 4, 3);
    REQUIRE(frame);
    const Case c = meshCase(*findCodec("pc"), 4);
    auto input = planInput(workload, c);
    REQUIRE(input);
    const auto packed = packPc(input->scene->mesh);
    REQUIRE(packed);
    EncodedMesh encoded = *input->encoded;
    input->encoded = &encoded;
    auto errorWith = [&](auto damage) {
        encoded.decode = [&] {
            Mesh mesh;
            for (uint32_t v = 0; v < packed->vertexCount; ++v) {
                PackedVertices bad;
                bad.vertexCount = 1;
                bad.stride = packed->stride;
                bad.grids = packed->grids;
                const auto first = packed->vertices.begin() + v * packed->stride;
                bad.vertices.assign(first, first + packed->stride);
                bad.tuples = packed->tuples;
                if (v % 500 == 7) damage(bad);
                const auto vertex = readPc(bad, 0);
                REQUIRE(vertex);
                mesh.positions.push_back(vertex->position);
                mesh.normals.push_back(vertex->normal);
                mesh.uvs.push_back(vertex->uv);
                mesh.influences.push_back(vertex->influences);
            }
            return mesh;
        };
        return figuresOf(c, *input, *frame);
    };
    const Figures good = errorWith([](PackedVertices&) {});
    CHECK(good.error <= good.bound + kTolerance);
    // One bit of a position; the joints of a tuple.
    for (const Figures& bad : {errorWith([](PackedVertices& p) { p.vertices[3] ^= 0x10; }),
                               errorWith([](PackedVertices& p) { std::ranges::reverse(p.tuples); })}) {
        CHECK(bad.bound == good.bound);
        CHECK(bad.error > bad.bound + kTolerance);
    }
    encoded.bounds.reset();
    CHECK(!codecPositionBound(c, *input, *frame));
}

TEST_CASE("far from the origin the scale of errors is that of the coordinates") {
    Mesh mesh;
    mesh.positions = {{0, 3, 0}, {0.06f, 3, 0.08f}};
    mesh.influences = {{{0}, {1}}, {{0}, {1}}};
    CHECK(std::abs(errorScale(mesh, Palette(1)) - 1.5) < 1e-6);
    Palette back(1);
    back[0].rows[1].w = -3;  // the sum of 3 and -3 is rounded as 3 is
    CHECK(std::abs(errorScale(mesh, back) - 3) < 1e-6);
    for (glm::vec3& p : mesh.positions) p.y = 0;
    CHECK(std::abs(errorScale(mesh, Palette(1)) - 0.1) < 1e-6);
    back[0].rows[0] = {1e30f, 0, 0, 0};
    CHECK(errorScale(mesh, back) == std::numeric_limits<double>::infinity());
}
