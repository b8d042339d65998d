#include "common/scene/clip_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

namespace skinbench {
namespace {

constexpr size_t kMaxMoments = 4096;
constexpr size_t kMaxNodes = 1u << 25;  // over all moments
constexpr size_t kBlock = 64;           // vertices; neighbours share their joints

struct Box {
    glm::dvec3 min{std::numeric_limits<double>::infinity()};
    glm::dvec3 max{-std::numeric_limits<double>::infinity()};
};

void grow(Box& box, const glm::dvec3& p) {
    box.min = glm::min(box.min, p);
    box.max = glm::max(box.max, p);
}

void grow(Box& box, const Box& other) {
    box.min = glm::min(box.min, other.min);
    box.max = glm::max(box.max, other.max);
}

bool holds(const Box& outer, const Box& inner) {
    return glm::all(glm::lessThanEqual(outer.min, inner.min)) && glm::all(glm::lessThanEqual(inner.max, outer.max));
}

// A joint and the bind positions that it moves.
struct JointBox {
    uint16_t joint = 0;
    Box box;
};

// The box around a transformed box.
Box transformed(const PaletteEntry& joint, const Box& box) {
    const glm::dvec3 middle = (box.min + box.max) * 0.5, half = (box.max - box.min) * 0.5;
    Box out;
    for (int row = 0; row < 3; ++row) {
        const glm::dvec4 r(joint.rows[row]);
        const double centre = glm::dot(glm::dvec3(r), middle) + r.w;
        const double reach = glm::dot(glm::abs(glm::dvec3(r)), half);
        out.min[row] = centre - reach;
        out.max[row] = centre + reach;
    }
    return out;
}

// A skinned vertex lies between the places that its joints move it to, so this box holds all that `boxes` describe.
Box around(const std::vector<JointBox>& boxes, const Palette& palette) {
    Box out;
    for (const JointBox& one : boxes) grow(out, transformed(palette[one.joint], one.box));
    return out;
}

std::vector<JointBox> jointBoxes(const Mesh& mesh, size_t first, size_t last) {
    std::vector<JointBox> boxes;
    for (size_t v = first; v < last; ++v)
        for (int k = 0; k < kMaxInfluences; ++k) {
            const uint16_t joint = mesh.influences[v].joints[k];
            if (mesh.influences[v].weights[k] == 0 || joint == kNoJoint) continue;
            auto box = std::ranges::find(boxes, joint, &JointBox::joint);
            if (box == boxes.end()) box = boxes.insert(box, {joint, {}});
            grow(box->box, glm::dvec3(mesh.positions[v]));
        }
    return boxes;
}

std::vector<JointBox> merged(const std::vector<std::vector<JointBox>>& blocks, size_t joints) {
    std::vector<JointBox> all(joints), used;
    for (const auto& block : blocks)
        for (const JointBox& one : block) {
            all[one.joint].joint = one.joint;
            grow(all[one.joint].box, one.box);
        }
    for (const JointBox& one : all)
        if (one.box.min.x <= one.box.max.x) used.push_back(one);
    return used;
}

std::vector<float> momentsOf(const Scene& scene, const Clip& clip) {
    std::set<float> all;
    const size_t frames = static_cast<size_t>(std::min(clip.duration * 60.0, static_cast<double>(kMaxMoments)));
    for (size_t frame = 0; frame <= frames; ++frame)
        all.insert(std::min(static_cast<float>(static_cast<double>(frame) / 60.0), clip.duration));
    for (const Channel& channel : clip.channels)
        for (const float time : channel.times) all.insert(std::clamp(time, 0.0f, clip.duration));
    const size_t nodes = std::max<size_t>(scene.skeleton.nodes.size(), 1);
    const size_t most = std::clamp<size_t>(kMaxNodes / nodes, 16, kMaxMoments);
    std::vector<float> moments(all.begin(), all.end());
    if (moments.empty()) return {0};
    std::vector<float> chosen;
    const size_t count = std::min(most, moments.size());
    for (size_t i = 0; i < count; ++i)
        chosen.push_back(moments[count < 2 ? 0 : i * (moments.size() - 1) / (count - 1)]);
    // Far apart first: what comes later is then mostly inside, and costs little.
    for (size_t i = 0, step = std::max<size_t>(count / 8, 1); i * step < count; ++i)
        std::swap(chosen[i], chosen[i * step]);
    return chosen;
}

}  // namespace

Bounds clipBounds(const Scene& scene, const Clip* clip) {
    const Mesh& mesh = scene.mesh;
    if (!clip || mesh.positions.empty()) return posedBounds(mesh, poseScene(scene, clip, 0));
    std::vector<std::vector<JointBox>> blocks;
    for (size_t first = 0; first < mesh.positions.size(); first += kBlock)
        blocks.push_back(jointBoxes(mesh, first, std::min(first + kBlock, mesh.positions.size())));
    const std::vector<JointBox> whole = merged(blocks, scene.skeleton.joints.size());
    Box bounds;
    for (const float seconds : momentsOf(scene, *clip)) {
        const Palette palette = poseScene(scene, clip, seconds);
        if (holds(bounds, around(whole, palette))) continue;
        for (size_t block = 0; block < blocks.size(); ++block) {
            if (holds(bounds, around(blocks[block], palette))) continue;
            const size_t first = block * kBlock, last = std::min(first + kBlock, mesh.positions.size());
            const Bounds posed = posedBounds(mesh, palette, first, last);
            grow(bounds, Box{posed.min, posed.max});
        }
    }
    return {glm::vec3(bounds.min), glm::vec3(bounds.max)};
}

}  // namespace skinbench
