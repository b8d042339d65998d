// Every codec on degenerate meshes: what decodes lies within the bounds that the codec states (CodecBounds), and the
// first influence weighs the most.
#include <algorithm>
#include <cmath>

#include <catch2/catch_test_macros.hpp>

#include "common/codecs/codec.h"
#include "tests/codec_test.h"

using namespace skinbench;
using namespace skinbench::test;

namespace {

double weightOf(const Influences& influences, uint16_t joint) {
    double sum = 0;
    for (int i = 0; i < kMaxInfluences; ++i)
        if (influences.joints[i] == joint) sum += influences.weights[i];
    return sum;
}

// Sum of the absolute differences, joint by joint.
double weightDifference(const Influences& a, const Influences& b) {
    double sum = 0;
    for (int i = 0; i < kMaxInfluences; ++i) {
        if (a.joints[i] != kNoJoint) sum += std::abs(weightOf(a, a.joints[i]) - weightOf(b, a.joints[i]));
        if (b.joints[i] != kNoJoint && weightOf(a, b.joints[i]) == 0) sum += std::abs(b.weights[i]);
    }
    return sum;
}

void checkWithinBounds(const Codec& codec, const Mesh& mesh) {
    INFO("codec " << codec.name);
    const MeshletMesh cut = cutMeshlets(mesh);
    const auto encoded = codec.encode({mesh, &cut, 4});
    REQUIRE(encoded);
    const Mesh decoded = decodeOnCpu(mesh, *encoded);
    const CodecBounds bounds = encoded->bounds.value_or(CodecBounds{});
    CHECK(encoded->bounds.has_value() == (encoded->decode != nullptr));
    REQUIRE(decoded.positions.size() == encoded->vertexCount);
    uint32_t wrong = 0;
    for (size_t v = 0; v < decoded.positions.size(); ++v) {
        const size_t source = encoded->sources.empty() ? v : encoded->sources[v];
        const glm::dvec3 moved = glm::abs(glm::dvec3(decoded.positions[v]) - glm::dvec3(mesh.positions[source]));
        wrong += glm::any(glm::greaterThan(moved, bounds.position));
        wrong += weightDifference(mesh.influences[source], decoded.influences[v]) > bounds.weights;
        wrong += std::ranges::max(decoded.influences[v].weights) > decoded.influences[v].weights[0] + 0.01f;
    }
    CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("degenerate meshes decode within every codec's bounds") {
    for (const auto& [name, mesh] : degenerateMeshes()) {
        CAPTURE(name);
        for (const Codec& codec : codecs()) checkWithinBounds(codec, mesh);
        checkWithinBounds(*findCodec("wicked"), mesh);
    }
}

TEST_CASE("a mesh with every joint decodes within the bounds of the codecs that can count its tuples") {
    const Mesh mesh = everyJointMesh();
    for (const Codec& codec : codecs()) {
        if (codec.name != std::string("oss22")) {
            checkWithinBounds(codec, mesh);
            continue;
        }
        const auto refused = codec.encode({mesh, nullptr, 4});
        REQUIRE(!refused);
        CHECK(refused.error().text.find("65535 joint tuples, the limit is 1024") != std::string::npos);
    }
}

TEST_CASE("no mesh has more joints than 16 bits name beside the one that means none") {
    Scene scene;
    scene.name = "joints";
    scene.mesh = randomMesh(9, 3, 1);
    scene.skeleton.nodes.resize(1);
    scene.skeleton.joints.resize(kMaxJoints);
    CHECK(checkScene(scene));
    scene.skeleton.joints.resize(65536);
    const auto refused = checkScene(scene);
    REQUIRE(!refused);
    CHECK(refused.error().text.find("65536 joints are more than the limit of 65535") != std::string::npos);
}
