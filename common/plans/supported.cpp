// What a device must have for a case.
#include <format>

#include "common/plans/plan_parts.h"

namespace skinbench {

// What one work group keeps in shared memory when it culls.
static uint32_t exchangeBytes(const Case& c) {
    if (c.cull == Cull::off) return 0;
    return c.limits.vertices * 12 + (c.limits.triangles + c.groupSize * 4);
}

static std::optional<std::string> unsupportedClusters(const Case& c, const DeviceCaps& caps) {
    const bool plain = c.route->dialect == MeshDialect::none;
    if (c.method != Method::lbs) return "the bounds of meshlets hold for linear blending";
    if (c.loadsOnly) return "loads-only draws the bind pose, and the bounds are those of posed meshlets";
    if (c.scenario == Scenario::prepass) return "meshlets that are left out keep no vertices for the second pass";
    if (c.clusterTests & CLUSTER_TEST_CONE && c.keepBackFaces)
        return "the test of cones drops what kept back faces draw";
    if (c.clusterCull == ClusterCull::list && c.submission == Submission::batched)
        return "a list has one command a copy, so copies cannot be drawn at once";
    if (c.clusterCull == ClusterCull::task && plain) return "there is no task stage without a mesh stage";
    if (c.clusterCull == ClusterCull::task && !meshLimits(caps, c.route->dialect).taskStages)
        return caps.name + " has no task stages";
    return std::nullopt;
}

static std::optional<std::string> unsupportedOptions(const Case& c, const DeviceCaps& caps) {
    if (c.cull == Cull::primitive && c.route->dialect == MeshDialect::nv)
        return "gl_CullPrimitive exists in the EXT dialect only";
    if ((c.cull == Cull::primitive || c.cull == Cull::torabi) && c.route->dialect == MeshDialect::ext &&
        caps.primitiveCullIgnored)
        return caps.name + " ignores gl_CullPrimitiveEXT";
    if (c.exchange == Exchange::shuffle && c.cull != Cull::compact) return "only --cull compact exchanges by shuffles";
    if (c.exchange == Exchange::outputs && (c.cull != Cull::torabi || c.route->dialect != MeshDialect::nv))
        return "only --cull torabi on an NV route reads positions from the outputs";
    if ((c.exchange == Exchange::shuffle || c.exchange == Exchange::outputs) && !canShuffle(c, caps))
        return std::format("{} invocations a work group are not one subgroup that can shuffle: {} has {}", c.groupSize,
                           caps.name, caps.subgroupSize);
    const MeshLimitsOfDevice& limits = meshLimits(caps, c.route->dialect);
    if (exchangeBytes(c) > limits.maxSharedBytes)
        return std::format("{} bytes of shared memory: {} allows {}", exchangeBytes(c), caps.name,
                           limits.maxSharedBytes);
    if (storesSlim(c) && !c.codec->slim)
        return std::string("codec ") + c.codec->name + " has no record without joint ids";
    if (sharesJointLists(c) && c.shape.joints != JointSource::vertex) return "mesh-ci lists joints its own way";
    return std::nullopt;
}

static std::optional<std::string> unsupportedMeshlets(const Case& c, const DeviceCaps& caps) {
    const MeshLimitsOfDevice& limits = meshLimits(caps, c.route->dialect);
    const char* prefix = namesOf(c.route->api).prefix;
    const char* vendor = c.route->dialect == MeshDialect::nv ? "NV" : "EXT";
    if (!limits.available) return std::format("{} has no {}_{}_mesh_shader", caps.name, prefix, vendor);
    if (c.limits.vertices > limits.maxVertices)
        return std::format("{} vertices a meshlet: {} allows {}", c.limits.vertices, caps.name, limits.maxVertices);
    if (c.limits.triangles > limits.maxTriangles)
        return std::format("{} triangles a meshlet: {} allows {}", c.limits.triangles, caps.name, limits.maxTriangles);
    if (c.groupSize > limits.maxGroupSize)
        return std::format("{} invocations a mesh work group: {} allows {}", c.groupSize, caps.name,
                           limits.maxGroupSize);
    return unsupportedOptions(c, caps);
}

DeviceCaps unlimitedCaps(Api api) {
    DeviceCaps caps;
    caps.api = api;
    caps.timestampBits = 64;
    caps.ext = {true, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, UINT32_MAX, 0, true};
    caps.nv = caps.ext;
    caps.subgroupSize = Case{}.groupSize;
    caps.meshSubgroups = true;
    caps.secondQueue = api == Api::vulkan;  // an OpenGL context has one queue
    caps.storageBlocksVertex = UINT32_MAX;
    return caps;
}

bool canShuffle(const Case& c, const DeviceCaps& caps) {
    return caps.meshSubgroups && caps.subgroupSize == c.groupSize;
}

Exchange exchangeOf(const Case& c, const DeviceCaps& caps) {
    // The outputs of the view `culled` hold positions of the overview.
    const bool shared = c.view == View::culled && c.cull == Cull::torabi;
    if (c.exchange != Exchange::automatic && !shared) return c.exchange;
    if (!canShuffle(c, caps) || shared) return Exchange::shared;
    if (c.cull == Cull::compact) return Exchange::shuffle;
    return c.cull == Cull::torabi && c.route->dialect == MeshDialect::nv ? Exchange::outputs : Exchange::shared;
}

std::optional<std::string> unsupported(const Case& c, const DeviceCaps& caps) {
    if (c.route->api == Api::cpu) return std::nullopt;
    if (caps.timestampBits == 0) return caps.name + " offers no timestamps, so passes cannot be timed";
    if (c.codec->needsMeshlets && c.route->dialect == MeshDialect::none)
        return std::string("codec ") + c.codec->name + " decodes in mesh stages only";
    if (auto reason = cannotHold(*c.codec, c.influences)) return reason;
    if (!c.codec->storesJoints && c.variant->skins) return std::string("codec ") + c.codec->name + " stores no joints";
    if (usesPartition(c) && !c.codec->takesSlots)
        return std::string("codec ") + c.codec->name + " stores joints, and palette draws need slots";
    if (c.variant->fetches && c.route->dialect == MeshDialect::none && c.fetch == VertexFetch::attributes &&
        !c.codec->feedsAttributes)
        return std::string("no attribute format carries codec ") + c.codec->name;
    if ((c.shape.uniformPalette || usesPartition(c)) && c.submission == Submission::batched)
        return "a uniform block holds one copy's palette, so copies cannot be drawn at once";
    if (c.loadsOnly && (c.compute.previous || skinsTangents(c.compute)))
        return "loads-only skins neither tangents nor positions that could be kept";
    if (c.variant->listsTriangles && (c.triangleTests & TEST_BACK) && c.keepBackFaces)
        return "the test for back faces drops what kept back faces draw";
    if (c.variant->readsSkinned && c.codec->needsMeshlets)
        return std::string("codec ") + c.codec->name + " decodes in mesh stages only";
    if (c.zeroWeights == ZeroWeights::count && (c.route->dialect == MeshDialect::none || c.variant->readsSkinned))
        return "influences are counted in the headers of meshlets";
    if (c.clusterCull != ClusterCull::off)
        if (auto reason = unsupportedClusters(c, caps)) return reason;
    if (c.queues == Queues::async && !caps.secondQueue)
        return c.route->api == Api::opengl ? "OpenGL has no second queue" : caps.name + " has no second queue";
    if (c.queues == Queues::async && (c.compute.previous || c.compute.halfRate))
        return "frames skin into two buffers in turn, so a vertex does not find what an update before has kept";
    if (c.compute.tangents + c.compute.shortTangents + c.compute.wicked > 1)
        return "tangents are kept in one way: long, short, or as wicked";
    if (c.compute.packed && c.compute.wicked) return "vertices are kept in one way: packed, or as wicked";
    if (c.compute.staged && c.submission == Submission::batched)
        return "a work group of a batched dispatch spans copies, so it cannot stage the palette of one";
    if (c.route->dialect != MeshDialect::none) return unsupportedMeshlets(c, caps);
    // A vertex stage reads the palette, and the vertices when it pulls; verifying plans add the capture buffer.
    const uint32_t blocks = c.variant->vertexBlocks + (c.fetch == VertexFetch::pull);
    if (caps.storageBlocksVertex < blocks)
        return std::format("{} storage blocks in the vertex stage: {} allows {}", blocks, caps.name,
                           caps.storageBlocksVertex);
    return std::nullopt;
}

}  // namespace skinbench
