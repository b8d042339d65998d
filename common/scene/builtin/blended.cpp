#include <algorithm>

#include "common/scene/builtin/characters.h"

namespace skinbench::builtin {

namespace {

constexpr size_t kInfluences = 4;

// For each joint the nearest ones in the tree of joints, itself first.
std::vector<std::vector<uint16_t>> nearestJoints(const Skeleton& skeleton) {
    const size_t joints = skeleton.joints.size();
    std::vector<int32_t> jointOfNode(skeleton.nodes.size(), -1);
    for (size_t j = 0; j < joints; ++j) jointOfNode[skeleton.joints[j].node] = static_cast<int32_t>(j);
    std::vector<std::vector<uint16_t>> beside(joints);
    for (size_t j = 0; j < joints; ++j) {
        int32_t node = skeleton.nodes[skeleton.joints[j].node].parent;
        while (node >= 0 && jointOfNode[node] < 0) node = skeleton.nodes[node].parent;
        if (node < 0) continue;
        beside[j].push_back(static_cast<uint16_t>(jointOfNode[node]));
        beside[jointOfNode[node]].push_back(static_cast<uint16_t>(j));
    }
    std::vector<std::vector<uint16_t>> nearest(joints);
    for (size_t j = 0; j < joints; ++j) {
        nearest[j] = {static_cast<uint16_t>(j)};
        for (size_t i = 0; i < nearest[j].size() && nearest[j].size() < 2 * kInfluences; ++i)
            for (uint16_t other : beside[nearest[j][i]])
                if (std::ranges::find(nearest[j], other) == nearest[j].end()) nearest[j].push_back(other);
    }
    return nearest;
}

}  // namespace

Scene makeBlended(uint32_t vertices, uint32_t seed) {
    constexpr float kAdded = 0.0625f;
    Scene scene = makeBiped(vertices, seed);
    const auto nearest = nearestJoints(scene.skeleton);
    for (Influences& influences : scene.mesh.influences) {
        const uint16_t heaviest = influences.joints[0];
        size_t count = 0;
        while (count < kInfluences && influences.weights[count] > 0) ++count;
        for (uint16_t joint : nearest[heaviest]) {
            const auto end = influences.joints.begin() + static_cast<std::ptrdiff_t>(count);
            if (count == kInfluences || std::find(influences.joints.begin(), end, joint) != end) continue;
            // Weights descend, of equal ones the smaller joint comes first.
            const auto isBehind = [&](size_t i) {
                return influences.weights[i] < kAdded ||
                       (influences.weights[i] == kAdded && influences.joints[i] > joint);
            };
            size_t place = count++;
            for (; place > 0 && isBehind(place - 1); --place) {
                influences.joints[place] = influences.joints[place - 1];
                influences.weights[place] = influences.weights[place - 1];
            }
            influences.joints[place] = joint;
            influences.weights[place] = kAdded;
        }
        float sum = 0;
        for (float weight : influences.weights) sum += weight;
        for (float& weight : influences.weights) weight /= sum;
    }
    return scene;
}

}  // namespace skinbench::builtin
