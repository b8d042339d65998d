#include "common/cases/workload.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <format>
#include <set>

#include "common/scene/clip_bounds.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

static const Clip* clipOf(const Scene& scene, const std::string& name) {
    if (name.empty()) return scene.clips.empty() ? nullptr : &scene.clips.front();
    auto clip = std::ranges::find(scene.clips, name, &Clip::name);
    return clip == scene.clips.end() ? nullptr : &*clip;
}

Result<Workload> makeWorkload(Scene scene, ShaderLibrary shaders, const WorkloadSettings& settings) {
    Workload workload;
    workload.settings = settings;
    workload.shaders = std::move(shaders);
    workload.stored = std::move(scene);
    SKINBENCH_TRY(chooseClip(workload, settings.clip));
    return workload;
}

Result<void> chooseClip(Workload& workload, const std::string& clip) {
    if (!clip.empty() && clip != "none" && !clipOf(workload.stored, clip)) {
        std::set<std::string> known;
        std::string names;
        for (const Clip& other : workload.stored.clips)
            if (known.insert(other.name).second) names += (names.empty() ? "" : ", ") + other.name;
        return inputError(
            std::format("{}: no clip '{}'; there is {}", workload.stored.name, clip, names.empty() ? "none" : names));
    }
    workload.settings.clip = clip;
    workload.bounds.clear();
    workload.stretches.reset();
    return {};
}

const Clip* chosenClip(const Workload& workload) { return clipOf(workload.stored, workload.settings.clip); }

// When `phase` of the frame that is drawn `frame` frames after the first is posed.
static float momentOf(const WorkloadSettings& settings, const Clip* clip, uint32_t phase, uint32_t frame) {
    const double offset = clip ? clip->duration * (phase / static_cast<double>(kPhases)) : 0;
    return static_cast<float>(settings.seconds + (settings.animated ? frame / 60.0 : 0) + offset);
}

Result<const Scene*> sceneFor(Workload& workload, int influences) {
    std::unique_ptr<Scene>& kept = workload.prepared[influences];
    if (!kept) {
        PrepareOptions options = workload.settings.prepare;
        options.influences = influences;
        Result<Scene> scene = prepareScene(workload.stored, options);
        SKINBENCH_TRY(scene);
        kept = std::make_unique<Scene>(std::move(*scene));
    }
    return kept.get();
}

Result<Framing> framingOf(Workload& workload, int influences) {
    auto scene = sceneFor(workload, influences);
    SKINBENCH_TRY(scene);
    const WorkloadSettings& settings = workload.settings;
    if (!workload.bounds.contains(influences)) workload.bounds[influences] = clipBounds(**scene, chosenClip(workload));
    return Framing{
        workload.bounds[influences], settings.copies, settings.width, settings.height, settings.yaw, settings.camera,
        settings.characterPixels};
}

static Result<const MeshletMesh*> meshletsFor(Workload& workload, const Case& c, const Scene& scene) {
    std::unique_ptr<MeshletMesh>& kept = workload.meshlets[keyOf(c, Changes::meshlets)];
    if (!kept) {
        auto built = std::make_unique<MeshletMesh>(c.builder->build(scene.mesh, c.limits));
        if (auto right = checkMeshlets(scene.mesh, *built); !right)
            return programError(std::string(c.builder->name) + ": " + right.error().text);
        kept = std::move(built);
    }
    return kept.get();
}

static Result<Records> partition(const Case& c, const Mesh& mesh) {
    PaletteHardware hardware = *findPaletteHardware("generic");
    hardware.slots = c.paletteSlots;
    auto plan = partitionMesh(mesh, hardware, *findPartitionSolver("cheapest-insertion"), *findGroupOrder("given"));
    if (!plan) return inputError(plan.error().text + " or more slots (--palette-slots)");
    if (auto right = checkPartition(mesh, *plan); !right) return programError("partition: " + right.error().text);
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
        return programError("common influences: " + right.error().text);
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
    if (!c.builder && c.clusterCull == ClusterCull::list) {
        Case usual = c;  // routes without mesh shaders have no meshlets of their own
        usual.builder = findBuilder("meshopt");
        auto meshlets = meshletsFor(workload, usual, **scene);
        SKINBENCH_TRY(meshlets);
        input.meshlets = *meshlets;
    }
    return input;
}

Result<FrameData> makeFrame(Workload& workload, int influences, uint32_t frame) {
    auto scene = sceneFor(workload, influences);
    SKINBENCH_TRY(scene);
    const auto framing = framingOf(workload, influences);
    SKINBENCH_TRY(framing);
    const WorkloadSettings& settings = workload.settings;
    const Clip* clip = chosenClip(workload);
    FrameData data;
    data.constants = frameConstants(*framing, frame, settings.move, settings.overview);

    for (uint32_t phase = 0; phase < std::min(settings.copies, kPhases); ++phase)
        data.phases.push_back(poseScene(**scene, clip, momentOf(settings, clip, phase, frame)));
    return data;
}

glm::dvec4 clipPosition(const FrameConstants& constants, uint32_t copy, const glm::dvec3& position) {
    const auto columns = static_cast<uint32_t>(constants.grid.x);
    const glm::dvec3 offset(copy % columns * constants.grid.y, -(copy / columns * constants.grid.z), 0);
    return glm::dmat4(constants.viewProjection) * glm::dvec4(position + offset, 1);
}

// A bit for each plane of the view volume that the place lies beyond.
static uint32_t planesBeyond(const glm::dvec4& clip) {
    return uint32_t{clip.x > clip.w} | uint32_t{-clip.x > clip.w} << 1 | uint32_t{clip.y > clip.w} << 2 |
           uint32_t{-clip.y > clip.w} << 3 | uint32_t{clip.z > clip.w} << 4 | uint32_t{clip.z < 0} << 5;
}

namespace {

struct Seen {
    size_t vertices = 0, triangles = 0;
};

Seen seenOf(const Mesh& mesh, const std::vector<uint32_t>& planes) {
    Seen seen;
    for (uint32_t bits : planes) seen.vertices += bits == 0;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        seen.triangles += (planes[mesh.indices[i]] & planes[mesh.indices[i + 1]] & planes[mesh.indices[i + 2]]) == 0;
    return seen;
}

}  // namespace

Result<InView> inView(Workload& workload, int influences) {
    const auto scene = sceneFor(workload, influences);
    SKINBENCH_TRY(scene);
    const auto frame = makeFrame(workload, influences, 0);
    SKINBENCH_TRY(frame);
    const uint32_t copies = workload.settings.copies;
    const Mesh& mesh = (*scene)->mesh;
    // By phase: the box spares most copies the look at each vertex.
    std::map<uint32_t, Bounds> boxes;
    std::map<uint32_t, SkinnedReference> posed;
    std::vector<uint32_t> planes(mesh.positions.size());
    size_t vertices = 0, triangles = 0, seenCopies = 0;
    for (uint32_t copy = 0; copy < copies; ++copy) {
        const uint32_t phase = copy % kPhases;
        if (!boxes.contains(phase)) boxes[phase] = posedBounds(mesh, paletteOfCopy(*frame, copy));
        const Bounds& bounds = boxes[phase];
        uint32_t any = 0, all = ~0u;
        for (int corner = 0; corner < 8; ++corner) {
            const uint32_t bits = planesBeyond(
                clipPosition(frame->constants, copy,
                             {corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                              corner & 4 ? bounds.max.z : bounds.min.z}));
            any |= bits, all &= bits;
        }
        Seen seen{mesh.positions.size(), mesh.indices.size() / 3};
        if (all) seen = {};
        if (any && !all) {
            SkinnedReference& skinned = posed[phase];
            if (skinned.positions.empty()) skinned = skinReference(mesh, paletteOfCopy(*frame, copy));
            for (size_t v = 0; v < planes.size(); ++v)
                planes[v] = planesBeyond(clipPosition(frame->constants, copy, skinned.positions[v]));
            seen = seenOf(mesh, planes);
        }
        vertices += seen.vertices, triangles += seen.triangles, seenCopies += seen.triangles > 0;
    }
    auto share = [&](size_t part, size_t ofCopy) {
        return static_cast<double>(part) / (static_cast<double>(copies) * static_cast<double>(ofCopy));
    };
    return InView{share(vertices, mesh.positions.size()), share(triangles, mesh.indices.size() / 3),
                  share(seenCopies, 1)};
}

Result<std::vector<std::byte>> paletteBytes(const PlanInput& input, const std::optional<PaletteBlocks>& blocks,
                                            const FrameData& frame) {
    const size_t phases = frame.phases.size(), bytesOfJoint = input.palette.bytesOfJoint();
    std::vector<std::vector<std::byte>> posed(phases);
    for (size_t phase = 0; phase < phases; ++phase) {
        const auto rows = paletteRows(input.scene->skeleton, frame.phases[phase], input.palette);
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

const Palette& paletteOfCopy(const FrameData& frame, uint32_t copy) { return frame.phases[copy % frame.phases.size()]; }

}  // namespace skinbench
