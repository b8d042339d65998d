#include "common/scene/builtin/rig.h"

namespace skinbench::builtin {

uint32_t Rig::add(const std::string& name, int32_t parent, glm::vec3 position) {
    Node node;
    node.name = name;
    node.parent = parent;
    node.translation = parent < 0 ? position : position - positions[size_t(parent)];
    Joint joint;
    joint.node = uint32_t(skeleton.nodes.size());
    joint.inverseBind[3] = glm::vec4(-position, 1);
    skeleton.nodes.push_back(node);
    skeleton.joints.push_back(joint);
    positions.push_back(position);
    return joint.node;
}

uint32_t Rig::find(const std::string& name) const {
    size_t i = 0;
    while (i < skeleton.nodes.size() && skeleton.nodes[i].name != name) ++i;
    SKINBENCH_ASSERT(i < skeleton.nodes.size());
    return uint32_t(i);
}

void ClipMaker::rotate(const std::string& joint, const RotationCycle& cycle, Interpolation interpolation) {
    std::vector<glm::vec4> values;
    for (int k = 0; k < keys; ++k) {
        const glm::quat q = cycle(double(k) / keys);
        values.emplace_back(q.x, q.y, q.z, q.w);
    }
    add(rig.find(joint), ChannelPath::rotation, interpolation, values);
}

void ClipMaker::move(const std::string& joint, const OffsetCycle& cycle, Interpolation interpolation) {
    const uint32_t node = rig.find(joint);
    std::vector<glm::vec4> values;
    for (int k = 0; k < keys; ++k)
        values.emplace_back(rig.skeleton.nodes[node].translation + cycle(double(k) / keys), 0);
    add(node, ChannelPath::translation, interpolation, values);
}

void ClipMaker::scale(const std::string& joint, const OffsetCycle& cycle, Interpolation interpolation) {
    std::vector<glm::vec4> values;
    for (int k = 0; k < keys; ++k) values.emplace_back(cycle(double(k) / keys), 0);
    add(rig.find(joint), ChannelPath::scale, interpolation, values);
}

void ClipMaker::add(uint32_t node, ChannelPath path, Interpolation interpolation, std::vector<glm::vec4> cycle) {
    Channel channel;
    channel.node = node;
    channel.path = path;
    channel.interpolation = interpolation;
    const size_t count = cycle.size();
    const float step = clip.duration / float(count);
    for (size_t k = 0; k <= count; ++k) {
        channel.times.push_back(k == count ? clip.duration : step * float(k));
        const glm::vec4 value = cycle[k % count];
        if (interpolation != Interpolation::cubicSpline) {
            channel.values.push_back(value);
            continue;
        }
        const glm::vec4 tangent = (cycle[(k + 1) % count] - cycle[(k + count - 1) % count]) / (2 * step);
        channel.values.insert(channel.values.end(), {tangent, value, tangent});
    }
    clip.channels.push_back(std::move(channel));
}

}  // namespace skinbench::builtin
