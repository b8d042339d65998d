#include "common/workload.h"

#include <algorithm>
#include <format>

namespace skinbench {

Result<Workload> makeWorkload(Scene scene, ShaderLibrary shaders, const WorkloadSettings& settings) {
    Workload workload;
    workload.settings = settings;
    workload.shaders = std::move(shaders);
    workload.stored = std::move(scene);
    if (!settings.clip.empty() && settings.clip != "none" && !chosenClip(workload)) {
        std::string names;
        for (const Clip& clip : workload.stored.clips) names += (names.empty() ? "" : ", ") + clip.name;
        return inputError(std::format("{}: no clip '{}'; there is {}", workload.stored.name, settings.clip,
                                      names.empty() ? "none" : names));
    }
    return workload;
}

const Clip* chosenClip(const Workload& workload) {
    const std::vector<Clip>& clips = workload.stored.clips;
    if (workload.settings.clip.empty()) return clips.empty() ? nullptr : &clips.front();
    auto clip = std::ranges::find(clips, workload.settings.clip, &Clip::name);
    return clip == clips.end() ? nullptr : &*clip;
}

Result<const Scene*> sceneFor(Workload& workload, int influences) {
    std::unique_ptr<Scene>& kept = workload.prepared[influences];
    if (!kept) {
        PrepareOptions options = workload.settings.prepare;
        options.influences = influences;
        Result<Scene> scene = prepareScene(workload.stored, options);
        if (!scene) return std::unexpected(scene.error());
        kept = std::make_unique<Scene>(std::move(*scene));
        workload.bounds[influences] = clipBounds(*kept, chosenClip(workload));
    }
    return kept.get();
}

static Result<const MeshletMesh*> meshletsFor(Workload& workload, const Case& which, const Scene& scene) {
    const Workload::MeshletKey key{which.influences, which.builder, which.limits.vertices, which.limits.triangles};
    std::unique_ptr<MeshletMesh>& kept = workload.meshlets[key];
    if (!kept) {
        auto built = std::make_unique<MeshletMesh>(which.builder->build(scene.mesh, which.limits));
        if (auto right = checkMeshlets(scene.mesh, *built); !right)
            return inputError(std::string(which.builder->name) + ": " + right.error().text);
        kept = std::move(built);
    }
    return kept.get();
}

Result<PlanInput> planInput(Workload& workload, const Case& which) {
    PlanInput input;
    input.shaders = &workload.shaders;
    input.copies = workload.settings.copies;
    input.width = workload.settings.width;
    input.height = workload.settings.height;
    auto scene = sceneFor(workload, which.influences);
    if (!scene) return std::unexpected(scene.error());
    input.scene = *scene;

    Workload::MeshletKey meshletKey{};
    if (which.builder) {
        auto meshlets = meshletsFor(workload, which, **scene);
        if (!meshlets) return std::unexpected(meshlets.error());
        input.meshlets = *meshlets;
        if (which.codec->needsMeshlets)
            meshletKey = {which.influences, which.builder, which.limits.vertices, which.limits.triangles};
    }
    std::unique_ptr<EncodedMesh>& kept = workload.encoded[{which.influences, which.codec, meshletKey}];
    if (!kept) {
        auto encoded = which.codec->encode((*scene)->mesh, input.meshlets, which.influences);
        if (!encoded) return std::unexpected(encoded.error());
        kept = std::make_unique<EncodedMesh>(std::move(*encoded));
    }
    input.encoded = kept.get();
    if (kept->meshlets) input.meshlets = &*kept->meshlets;
    return input;
}

Result<FrameData> makeFrame(Workload& workload, int influences, uint32_t frame) {
    auto scene = sceneFor(workload, influences);
    if (!scene) return std::unexpected(scene.error());
    const WorkloadSettings& settings = workload.settings;
    const Clip* clip = chosenClip(workload);
    const double seconds = settings.seconds + (settings.animated ? frame / 60.0 : 0);
    FrameData data;
    data.constants = frameConstants(
        {workload.bounds[influences], settings.copies, settings.width, settings.height, settings.yaw}, seconds);

    const uint32_t phases = std::min(settings.copies, kPhases);
    std::vector<Palette> posed(phases);
    for (uint32_t phase = 0; phase < phases; ++phase) {
        const double offset = clip ? clip->duration * (phase / static_cast<double>(kPhases)) : 0;
        posed[phase] = poseScene(**scene, clip, static_cast<float>(seconds + offset));
    }
    data.palettes.reserve(size_t{settings.copies} * (*scene)->skeleton.joints.size());
    for (uint32_t copy = 0; copy < settings.copies; ++copy) {
        const Palette& palette = posed[copy % phases];
        data.palettes.insert(data.palettes.end(), palette.begin(), palette.end());
    }
    return data;
}

Palette paletteOfCopy(const FrameData& frame, uint32_t copies, uint32_t copy) {
    const size_t joints = frame.palettes.size() / copies;
    auto first = frame.palettes.begin() + static_cast<std::ptrdiff_t>(joints * copy);
    return Palette(first, first + static_cast<std::ptrdiff_t>(joints));
}

}  // namespace skinbench
