#include "common/cases/workload.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <format>

#include "common/scene/clip_bounds.h"
#include "common/scene/skin_cpu.h"

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

// When `phase` of the frame that is drawn `frame` frames after the first is posed.
static float momentOf(const WorkloadSettings& settings, const Clip* clip, uint32_t phase, uint32_t frame) {
    const double offset = clip ? clip->duration * (phase / static_cast<double>(kPhases)) : 0;
    return static_cast<float>(settings.seconds + (settings.animated ? frame / 60.0 : 0) + offset);
}

// Of the frames that a run draws first; later ones repeat the clip.
static std::vector<float> drawnMoments(const WorkloadSettings& settings, const Clip* clip) {
    constexpr uint32_t kFrames = 120;
    std::vector<float> moments;
    for (uint32_t frame = 0; frame < (settings.animated ? kFrames : 1); ++frame)
        for (uint32_t phase = 0; phase < std::min(settings.copies, kPhases); ++phase)
            moments.push_back(momentOf(settings, clip, phase, frame));
    return moments;
}

Result<const Scene*> sceneFor(Workload& workload, int influences) {
    std::unique_ptr<Scene>& kept = workload.prepared[influences];
    if (!kept) {
        PrepareOptions options = workload.settings.prepare;
        options.influences = influences;
        Result<Scene> scene = prepareScene(workload.stored, options);
        SKINBENCH_TRY(scene);
        kept = std::make_unique<Scene>(std::move(*scene));
        const Clip* clip = chosenClip(workload);
        workload.bounds[influences] = clipBounds(*kept, clip, drawnMoments(workload.settings, clip));
    }
    return kept.get();
}

static Result<const MeshletMesh*> meshletsFor(Workload& workload, const Case& c, const Scene& scene) {
    std::unique_ptr<MeshletMesh>& kept = workload.meshlets[keyOf(c, Changes::meshlets)];
    if (!kept) {
        auto built = std::make_unique<MeshletMesh>(c.builder->build(scene.mesh, c.limits));
        if (auto right = checkMeshlets(scene.mesh, *built); !right)
            return inputError(std::string(c.builder->name) + ": " + right.error().text);
        kept = std::move(built);
    }
    return kept.get();
}

static Result<Records> partition(const Case& c, const Mesh& mesh) {
    PaletteHardware hardware = *findPaletteHardware("generic");
    hardware.slots = c.paletteSlots;
    auto plan = partitionMesh(mesh, hardware, *findPartitionSolver("cheapest-insertion"), *findGroupOrder("given"));
    SKINBENCH_TRY(plan);
    SKINBENCH_TRY(checkPartition(mesh, *plan));
    return partitionedRecords(mesh, *plan);
}

static Result<Records> makeRecords(Workload& workload, const Case& c, const Scene& scene) {
    if (usesPartition(c)) return partition(c, scene.mesh);
    if (!sharesJointLists(c)) {
        auto meshlets = meshletsFor(workload, c, scene);
        SKINBENCH_TRY(meshlets);
        return orderedRecords(scene.mesh, **meshlets);
    }
    const CommonInfluenceCut cut = buildCommonInfluences(
        scene.mesh, {c.builder, c.limits, c.influences, c.ci.grouping, c.ci.key, c.ci.minVertices});
    if (auto right = checkCommonInfluences(scene.mesh, cut); !right)
        return inputError("common influences: " + right.error().text);
    const Records records = commonRecords(cut);
    return c.shape.orderedRecords ? orderedRecords(records) : records;
}

static Result<const Records*> recordsFor(Workload& workload, const Case& c, const Scene& scene) {
    if (storesSceneVertices(c)) return nullptr;
    std::unique_ptr<Records>& kept = workload.records[keyOf(c, Changes::records)];
    if (!kept) {
        auto made = makeRecords(workload, c, scene);
        SKINBENCH_TRY(made);
        kept = std::make_unique<Records>(std::move(*made));
    }
    return kept.get();
}

static Result<EncodedMesh> encode(const Case& c, const Mesh& mesh, const PlanInput& input) {
    EncodeInput in{mesh, input.meshlets, c.influences};
    const bool lists = storesSlim(c) && sharesJointLists(c);
    if (storesSlim(c))
        in.slimRecords = lists ? input.records->commonRecords : static_cast<uint32_t>(mesh.positions.size());
    in.fat = lists && c.ci.fat;
    auto encoded = storedCodec(c).encode(in);
    if (encoded && lists) encoded->meshletExtra = toBytes(packJointLists(input.records->joints, c.influences));
    return encoded;
}

static PaletteForm paletteForm(Workload& workload, const Case& c, const Scene& scene) {
    if (c.method == Method::lbs) return {c.method, c.paletteRows};
    if (!workload.stretches) workload.stretches = stretches(scene, chosenClip(workload));
    return {c.method, c.paletteRows, *workload.stretches};
}

Result<PlanInput> planInput(Workload& workload, const Case& c) {
    PlanInput input;
    input.shaders = &workload.shaders;
    input.defines = definesOf(c);
    input.copies = workload.settings.copies;
    input.width = workload.settings.width;
    input.height = workload.settings.height;
    auto scene = sceneFor(workload, c.influences);
    SKINBENCH_TRY(scene);
    input.scene = *scene;
    input.palette = paletteForm(workload, c, **scene);
    auto records = recordsFor(workload, c, **scene);
    SKINBENCH_TRY(records);
    input.records = *records;
    if (c.builder && input.records) {
        input.meshlets = &input.records->meshlets;
    } else if (c.builder) {
        auto meshlets = meshletsFor(workload, c, **scene);
        SKINBENCH_TRY(meshlets);
        input.meshlets = *meshlets;
    }

    std::unique_ptr<EncodedMesh>& kept = workload.encoded[keyOf(c, Changes::encoding)];
    if (!kept) {
        auto encoded = encode(c, input.records ? input.records->mesh : (*scene)->mesh, input);
        SKINBENCH_TRY(encoded);
        kept = std::make_unique<EncodedMesh>(std::move(*encoded));
    }
    input.encoded = kept.get();
    if (kept->meshlets) input.meshlets = &*kept->meshlets;
    return input;
}

Result<FrameData> makeFrame(Workload& workload, int influences, uint32_t frame) {
    auto scene = sceneFor(workload, influences);
    SKINBENCH_TRY(scene);
    const WorkloadSettings& settings = workload.settings;
    const Clip* clip = chosenClip(workload);
    FrameData data;
    data.constants = frameConstants(
        {workload.bounds[influences], settings.copies, settings.width, settings.height, settings.yaw, settings.camera},
        frame);

    const uint32_t phases = std::min(settings.copies, kPhases);
    std::vector<Palette> posed(phases);
    for (uint32_t phase = 0; phase < phases; ++phase)
        posed[phase] = poseScene(**scene, clip, momentOf(settings, clip, phase, frame));
    data.palettes.reserve(size_t{settings.copies} * (*scene)->skeleton.joints.size());
    for (uint32_t copy = 0; copy < settings.copies; ++copy) {
        const Palette& palette = posed[copy % phases];
        data.palettes.insert(data.palettes.end(), palette.begin(), palette.end());
    }
    return data;
}

glm::dvec4 clipPosition(const FrameConstants& constants, uint32_t copy, const glm::dvec3& position) {
    const auto columns = static_cast<uint32_t>(constants.grid.x);
    const glm::dvec3 offset(copy % columns * constants.grid.y, -(copy / columns * constants.grid.z), 0);
    return glm::dmat4(constants.viewProjection) * glm::dvec4(position + offset, 1);
}

static bool isInView(const FrameConstants& constants, uint32_t copy, const glm::dvec3& position) {
    const glm::dvec4 clip = clipPosition(constants, copy, position);
    return clip.w > 0 && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && clip.z >= 0 && clip.z <= clip.w;
}

Result<double> shareOutOfView(Workload& workload, int influences) {
    const auto scene = sceneFor(workload, influences);
    SKINBENCH_TRY(scene);
    const auto frame = makeFrame(workload, influences, 0);
    SKINBENCH_TRY(frame);
    const uint32_t copies = workload.settings.copies;
    const Mesh& mesh = (*scene)->mesh;
    // By phase: the box spares most copies the look at each vertex.
    std::map<uint32_t, Bounds> boxes;
    std::map<uint32_t, SkinnedReference> posed;
    size_t outside = 0;
    for (uint32_t copy = 0; copy < copies; ++copy) {
        const uint32_t phase = copy % kPhases;
        if (!boxes.contains(phase)) boxes[phase] = posedBounds(mesh, paletteOfCopy(*frame, copies, copy));
        const Bounds& bounds = boxes[phase];
        bool whole = true;
        for (int corner = 0; corner < 8; ++corner)
            whole =
                whole && isInView(frame->constants, copy,
                                  {corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                                   corner & 4 ? bounds.max.z : bounds.min.z});
        if (whole) continue;
        SkinnedReference& skinned = posed[phase];
        if (skinned.positions.empty()) skinned = skinReference(mesh, paletteOfCopy(*frame, copies, copy));
        outside += std::ranges::count_if(skinned.positions,
                                         [&](const glm::dvec3& p) { return !isInView(frame->constants, copy, p); });
    }
    return static_cast<double>(outside) / (static_cast<double>(copies) * static_cast<double>(mesh.positions.size()));
}

Result<std::vector<std::byte>> paletteBytes(const PlanInput& input, const std::optional<PaletteBlocks>& blocks,
                                            const FrameData& frame) {
    const uint32_t phases = std::min(input.copies, kPhases), bytesOfJoint = input.palette.bytesOfJoint();
    std::vector<std::vector<std::byte>> posed(phases);
    for (uint32_t phase = 0; phase < phases; ++phase) {
        const auto rows = paletteRows(input.scene->skeleton, paletteOfCopy(frame, input.copies, phase), input.palette);
        SKINBENCH_TRY(rows);
        appendRows(posed[phase], *rows, input.palette.format);
    }
    std::vector<std::byte> bytes;
    if (!blocks) {
        bytes.reserve(posed[0].size() * input.copies);
        for (uint32_t copy = 0; copy < input.copies; ++copy)
            bytes.insert(bytes.end(), posed[copy % phases].begin(), posed[copy % phases].end());
        return bytes;
    }
    const size_t blocksOfCopy = blocks->joints.size() / blocks->size;
    bytes.resize(blocks->stride() * blocksOfCopy * input.copies);
    for (uint32_t copy = 0; copy < input.copies; ++copy)
        for (size_t i = 0; i < blocks->joints.size(); ++i) {
            if (blocks->joints[i] == kNoJoint) continue;
            std::byte* block = &bytes[(copy * blocksOfCopy + i / blocks->size) * blocks->stride()];
            std::memcpy(block + i % blocks->size * bytesOfJoint,
                        &posed[copy % phases][size_t{blocks->joints[i]} * bytesOfJoint], bytesOfJoint);
        }
    return bytes;
}

Palette paletteOfCopy(const FrameData& frame, uint32_t copies, uint32_t copy) {
    const size_t joints = frame.palettes.size() / copies;
    auto first = frame.palettes.begin() + static_cast<std::ptrdiff_t>(joints * copy);
    return Palette(first, first + static_cast<std::ptrdiff_t>(joints));
}

}  // namespace skinbench
