#include "common/scene/pose.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace skinbench {
namespace {

// The two keys around a time and where between them it lies.
struct KeySpan {
    size_t first = 0;
    size_t second = 0;
    double t = 0;        // 0 at `first`, 1 at `second`
    double seconds = 0;  // between the two
};

KeySpan findKeys(const std::vector<float>& times, float seconds) {
    // Written so that a NaN time gives the first key.
    if (!(seconds > times.front())) return {};
    const size_t last = times.size() - 1;
    if (seconds >= times.back()) return {last, last, 0, 0};
    const size_t second = std::upper_bound(times.begin(), times.end(), seconds) - times.begin();
    const double start = times[second - 1];
    const double length = times[second] - start;
    return {second - 1, second, (seconds - start) / length, length};
}

glm::dvec4 normalizeOr(const glm::dvec4& q, const glm::dvec4& fallback) {
    const double length = glm::length(q);
    return length > 0 ? q / length : fallback;
}

glm::dvec4 slerpShort(const glm::dvec4& from, glm::dvec4 to, double t) {
    double cosine = glm::dot(from, to);
    if (cosine < 0) {
        to = -to;
        cosine = -cosine;
    }
    const double angle = std::acos(std::min(cosine, 1.0));
    const double sine = std::sin(angle);
    if (sine < 1e-9) return normalizeOr(glm::mix(from, to, t), from);
    return (std::sin((1 - t) * angle) * from + std::sin(t * angle) * to) / sine;
}

glm::dvec4 sampleCubic(const Channel& channel, const KeySpan& span) {
    const auto value = [&](size_t key, size_t c) { return glm::dvec4(channel.values[key * 3 + c]); };
    if (span.first == span.second) return value(span.first, 1);
    const double t = span.t, t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * value(span.first, 1) + span.seconds * (t3 - 2 * t2 + t) * value(span.first, 2) +
           (-2 * t3 + 3 * t2) * value(span.second, 1) + span.seconds * (t3 - t2) * value(span.second, 0);
}

glm::dvec4 sampleChannel(const Channel& channel, float seconds) {
    const KeySpan span = findKeys(channel.times, seconds);
    const bool rotation = channel.path == ChannelPath::rotation;
    const glm::dvec4 identity(0, 0, 0, 1);
    if (channel.interpolation == Interpolation::cubicSpline) {
        const glm::dvec4 value = sampleCubic(channel, span);
        return rotation ? normalizeOr(value, identity) : value;
    }
    const glm::dvec4 from(channel.values[span.first]);
    if (channel.interpolation == Interpolation::step || span.first == span.second)
        return rotation ? normalizeOr(from, identity) : from;
    const glm::dvec4 to(channel.values[span.second]);
    if (rotation) return slerpShort(normalizeOr(from, identity), normalizeOr(to, identity), span.t);
    return glm::mix(from, to, span.t);
}

glm::dmat4 affine(glm::dmat4 m) {
    for (int column = 0; column < 4; ++column) m[column][3] = column == 3;
    return m;
}

glm::dmat4 localMatrix(const Node& node) {
    if (node.matrix) return affine(glm::dmat4(*node.matrix));
    const glm::dvec4 q =
        normalizeOr({node.rotation.x, node.rotation.y, node.rotation.z, node.rotation.w}, {0, 0, 0, 1});
    glm::dmat4 m = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
    for (int axis = 0; axis < 3; ++axis) m[axis] *= static_cast<double>(node.scale[axis]);
    m[3] = glm::dvec4(glm::dvec3(node.translation), 1);
    return m;
}

}  // namespace

LocalPose sampleClip(const Skeleton& skeleton, const Clip* clip, float seconds) {
    LocalPose pose{skeleton.nodes};
    if (!clip) return pose;
    for (const Channel& channel : clip->channels) {
        const glm::vec4 value(sampleChannel(channel, seconds));
        Node& node = pose.nodes[channel.node];
        node.matrix.reset();
        switch (channel.path) {
            case ChannelPath::translation:
                node.translation = glm::vec3(value);
                break;
            case ChannelPath::rotation:
                node.rotation = glm::quat(value.w, value.x, value.y, value.z);
                break;
            case ChannelPath::scale:
                node.scale = glm::vec3(value);
                break;
        }
    }
    return pose;
}

std::vector<glm::dmat4> toModelSpace(const LocalPose& pose) {
    std::vector<glm::dmat4> modelSpace(pose.nodes.size());
    for (size_t i = 0; i < pose.nodes.size(); ++i) {
        const int32_t parent = pose.nodes[i].parent;
        SKINBENCH_ASSERT(parent < static_cast<int32_t>(i));
        const glm::dmat4 local = localMatrix(pose.nodes[i]);
        modelSpace[i] = parent < 0 ? local : modelSpace[parent] * local;
    }
    return modelSpace;
}

Palette makePalette(const Skeleton& skeleton, std::span<const glm::dmat4> modelSpace) {
    SKINBENCH_ASSERT(modelSpace.size() == skeleton.nodes.size());
    Palette palette(skeleton.joints.size());
    for (size_t i = 0; i < palette.size(); ++i) {
        const Joint& joint = skeleton.joints[i];
        const glm::dmat4 m = modelSpace[joint.node] * affine(glm::dmat4(joint.inverseBind));
        for (int row = 0; row < 3; ++row) palette[i].rows[row] = glm::vec4(m[0][row], m[1][row], m[2][row], m[3][row]);
    }
    return palette;
}

Palette poseScene(const Scene& scene, const Clip* clip, float seconds) {
    // The end itself is a moment of the clip, not the start of the next round.
    if (clip && clip->duration > 0 && std::isfinite(seconds) && (seconds < 0 || seconds > clip->duration)) {
        seconds = std::fmod(seconds, clip->duration);
        if (seconds < 0) seconds += clip->duration;
    }
    return makePalette(scene.skeleton, toModelSpace(sampleClip(scene.skeleton, clip, seconds)));
}

Bounds posedBounds(const Mesh& mesh, const Palette& palette, size_t first, size_t last) {
    Bounds bounds;
    last = std::min(last, mesh.positions.size());
    for (size_t v = first; v < last; ++v) {
        const glm::vec4 p(mesh.positions[v], 1);
        const Influences& influences = mesh.influences[v];
        glm::vec3 skinned(0);
        for (int k = 0; k < kMaxInfluences; ++k) {
            if (influences.weights[k] == 0 || influences.joints[k] == kNoJoint) continue;
            const PaletteEntry& joint = palette[influences.joints[k]];
            skinned += influences.weights[k] *
                       glm::vec3(glm::dot(joint.rows[0], p), glm::dot(joint.rows[1], p), glm::dot(joint.rows[2], p));
        }
        bounds.min = v == first ? skinned : glm::min(bounds.min, skinned);
        bounds.max = v == first ? skinned : glm::max(bounds.max, skinned);
    }
    return bounds;
}

}  // namespace skinbench
