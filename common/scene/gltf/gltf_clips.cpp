#include "common/scene/gltf/gltf_clips.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <set>

#include "common/core/text.h"
#include "common/core/utf8.h"

namespace skinbench {
namespace {

constexpr uint64_t kMaxKeys = 1u << 25;

// glTF 2.0, section 3.11: times and all but rotations are floats, rotations may be normalised integers.
bool isAllowed(const GltfColumn& column, bool rotation) {
    if (column.component == kGltfF32) return true;
    return rotation && column.normalized && column.component != kGltfU32;
}

void noteTimes(const std::vector<float>& times, GltfNotes& notes) {
    for (size_t k = 0; k < times.size(); ++k) {
        if (times[k] < 0) notes.add(GltfNote::negativeKeyTimes);
        if (k > 0 && times[k] == times[k - 1]) notes.add(GltfNote::equalKeyTimes);
    }
}

// Rounding to a byte moves a unit quaternion by less than 0.8 %.
void noteRotations(const Channel& channel, GltfNotes& notes) {
    const bool cubic = channel.interpolation == Interpolation::cubicSpline;
    for (size_t i = cubic ? 1 : 0; i < channel.values.size(); i += cubic ? 3 : 1)
        if (!(std::abs(glm::length(glm::dvec4(channel.values[i])) - 1) <= 0.01)) notes.add(GltfNote::longRotationKeys);
}

Result<Channel> makeChannel(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& source,
                            GltfData& data, GltfNotes& notes) {
    if (!contains(animation.samplers, source.sampler))
        return inputError(std::format("sampler {} does not exist", source.sampler));
    const tinygltf::AnimationSampler& sampler = animation.samplers[source.sampler];
    Channel channel;
    if (source.target_path == "rotation") channel.path = ChannelPath::rotation;
    if (source.target_path == "scale") channel.path = ChannelPath::scale;
    if (sampler.interpolation == "STEP")
        channel.interpolation = Interpolation::step;
    else if (sampler.interpolation == "CUBICSPLINE")
        channel.interpolation = Interpolation::cubicSpline;
    else if (sampler.interpolation != "LINEAR")
        return inputError("interpolation \"" + shortText(sampler.interpolation, 40) + "\" is not known");

    const bool rotation = channel.path == ChannelPath::rotation;
    const int components = rotation ? 4 : 3;
    auto times = at("input", readFloats(data, sampler.input, 1));
    SKINBENCH_TRY(times);
    auto values = at("output", readFloats(data, sampler.output, components, rotation));
    SKINBENCH_TRY(values);
    if (times->empty()) return inputError("has no key");
    SKINBENCH_TRY(spend(data.budget, values->size() / components, sizeof(glm::vec4)));
    if (!isAllowed(**openColumn(data, sampler.input, 1), false)) notes.add(GltfNote::forbiddenFormats);
    if (!isAllowed(**openColumn(data, sampler.output, components), rotation)) notes.add(GltfNote::forbiddenFormats);
    noteTimes(*times, notes);
    const auto [first, last] = std::ranges::minmax(*times);
    noteBounds(data, sampler.input, {{first}, {last}}, true, notes);
    channel.times = std::move(*times);
    channel.values.resize(values->size() / components, glm::vec4(0));
    for (size_t i = 0; i < values->size(); ++i) channel.values[i / components][i % components] = (*values)[i];
    if (rotation) noteRotations(channel, notes);
    return channel;
}

Result<Clip> makeClip(const tinygltf::Model& model, size_t number, GltfData& data, const NodeOrder& order,
                      GltfNotes& notes) {
    const tinygltf::Animation& animation = model.animations[number];
    Clip clip{animation.name.empty() ? std::format("animation {}", number) : animation.name, 0, {}};
    std::set<std::pair<uint32_t, ChannelPath>> targets;
    for (size_t c = 0; c < animation.channels.size(); ++c) {
        const tinygltf::AnimationChannel& source = animation.channels[c];
        const std::string place = std::format("channel {}", c);
        const std::string& path = source.target_path;
        const bool known = path == "translation" || path == "rotation" || path == "scale";
        if (path == "weights") notes.add(GltfNote::morphs);
        // KHR_animation_pointer has its own warning.
        if (!known && path != "weights" && path != "pointer") notes.add(GltfNote::unknownTargets);
        if (!known || source.target_node < 0) continue;
        if (!contains(model.nodes, source.target_node))
            return inputError(std::format("{}: node {} does not exist", place, source.target_node));
        auto channel = at(place, makeChannel(animation, source, data, notes));
        SKINBENCH_TRY(channel);
        channel->node = order.place[source.target_node];
        if (auto ok = checkChannel(*channel, model.nodes.size()); !ok)
            return inputError(std::format("{}: {}", place, ok.error().text));
        if (!targets.emplace(channel->node, channel->path).second) notes.add(GltfNote::repeatedTargets);
        for (const float time : channel->times) clip.duration = std::max(clip.duration, time);
        clip.channels.push_back(std::move(*channel));
    }
    return clip;
}

}  // namespace

Result<void> addClips(const tinygltf::Model& model, const GltfFaults& faults, GltfData& data, const NodeOrder& order,
                      Scene& scene, GltfNotes& notes) {
    uint64_t keys = 0;
    std::vector<std::string> broken;
    for (size_t a = 0; a < model.animations.size(); ++a) {
        const auto fault = faults.find(a);
        if (fault != faults.end()) {
            broken.push_back(fault->second);
            continue;
        }
        auto clip = at(std::format("animation {}", a), makeClip(model, a, data, order, notes));
        if (!clip) {
            broken.push_back(clip.error().text);
            continue;
        }
        for (const Channel& channel : clip->channels) {
            keys += channel.values.size();
            Node& node = scene.skeleton.nodes[channel.node];
            if (!node.matrix) continue;
            splitMatrix(node);
            notes.add(GltfNote::splitMatrices);
        }
        if (keys > kMaxKeys) return inputError(std::format("its animations hold more than {} keys", kMaxKeys));
        if (!clip->channels.empty()) scene.clips.push_back(std::move(*clip));
    }
    if (broken.empty() && scene.clips.empty() && !model.animations.empty())
        scene.warnings.emplace_back("its animations move no node; the rest pose is drawn");
    if (broken.empty()) return {};
    if (scene.clips.empty()) return inputError(broken.front());
    scene.warnings.push_back(broken.front() +
                             (broken.size() == 1
                                  ? "; the clip was left out"
                                  : "; it and " + counted(broken.size() - 1, "more clip") + " were left out"));
    return {};
}

}  // namespace skinbench
