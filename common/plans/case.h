// Cases: what can be compared. Routes and variants are tables; a case is one of each with a value for every option.
//
// To add a variant: write shaders_glsl/NAME.glsl, a function that fills in a FramePlan, and a row in variants().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/codecs/codec.h"
#include "common/frame/backend.h"
#include "common/meshlets/cluster_bounds.h"
#include "common/meshlets/common_influences.h"
#include "common/meshlets/meshlets.h"
#include "common/scene/palette_rows.h"

namespace skinbench {

// The API with the extension that carries the geometry.
struct Route {
    const char* name;
    Api api;
    MeshDialect dialect = MeshDialect::none;
    const char* what;
};

// vk, vk-ext, vk-nv, gl, gl-ext, gl-nv, cpu
const std::vector<Route>& routes();
const Route* findRoute(const std::string& name);

enum class VertexFetch { attributes, pull };
enum class Submission { perCopy, batched };
enum class View {
    shaded = VIEW_SHADED,
    meshlets = VIEW_MESHLETS,
    weights = VIEW_WEIGHTS,
    tuples = VIEW_TUPLES,
    velocity = VIEW_VELOCITY,
    resolution = VIEW_RESOLUTION,
    normals = VIEW_NORMALS,
    joints = VIEW_JOINTS,
    culled = VIEW_CULLED
};

// Back-face culling in the mesh stage; shaders_glsl/cull.glsl says how each works.
enum class Cull { off = CULL_OFF, compact = CULL_COMPACT, primitive = CULL_PRIMITIVE, torabi = CULL_TORABI };

// How the lanes of a culling mesh work group see each other's positions. automatic: where the device's subgroup is the
// work group by shuffles, or, with Cull::torabi on NV, in the outputs; else through shared memory.
enum class Exchange { automatic, shuffle, shared, outputs };

// When a mesh work group with Cull::compact writes its vertices.
// first: as they are made. EXT has then declared all triangles; those to drop become triangles without an area.
// last:  once it is known how many triangles are left, none where there is no triangle. Lanes hold them until then.
// automatic: first, but last on EXT where vertices are only read.
enum class VertexWrites { automatic, first, last };

// Whole meshlets that cannot be seen are left out.
// task: a task stage in front of the mesh stage tests them.
// list: a compute pass lists those that are drawn, for an indirect draw, or for the pass of `compute-cull` that tests
//       triangles.
enum class ClusterCull { off = CLUSTER_OFF, task = CLUSTER_TASK, list = CLUSTER_LIST };

// direct:  skinned where it is drawn, once.
// prepass: the first pass lays down the depth and keeps the skinned vertices, the second draws them where the depth is
//          equal (Torabi 3.3).
enum class Scenario { direct, prepass };

// async: a second queue skins the next frame while this one is drawn, into a buffer that frames have in turn. It shows
// in
//        the time of a frame within a batch (RunMode::batch) alone.
enum class Queues { one, async };

// Where a mesh work group's vertices name their joints.
// vertex:  each vertex has joint ids.
// meshlet: the meshlet lists its joints, each vertex has one-byte numbers into that list.
// staged:  so too, and the work group first copies the listed palette rows to shared memory.
enum class JointSource { vertex = JOINTS_VERTEX, meshlet = JOINTS_MESHLET, staged = JOINTS_STAGED };

// What skinning does with influences that weigh nothing.
// load:  reads their joints like all others.
// skip:  tests each weight.
// count: the meshlet's header says how many influences its vertices have at the most.
enum class ZeroWeights { load = ZERO_WEIGHTS_LOAD, skip = ZERO_WEIGHTS_SKIP, count = ZERO_WEIGHTS_COUNT };

// Shapes of one mesh shader that compute the same; which is fastest depends on the device.
struct MeshShape {
    JointSource joints = JointSource::vertex;
    bool clampedLoads = false;    // load at min(i, count - 1) instead of under if (i < count)
    bool orderedRecords = false;  // every meshlet has its own vertex records, one behind the other
    bool uniformPalette = false;  // the palette is a uniform block
    bool operator==(const MeshShape&) const = default;
};

// The variant `mesh-ci`.
struct CommonInfluences {
    CiGrouping grouping = CommonInfluenceOptions{}.grouping;
    CiKey key = CommonInfluenceOptions{}.key;
    uint32_t minVertices = CommonInfluenceOptions{}.minVertices;
    bool fat = false;  // vertices keep joint ids that nothing reads (Torabi 5.1.4)
    bool operator==(const CommonInfluences&) const = default;
};

// The variant `compute`; shaders_glsl/compute.glsl says how each works. Any of them go together.
struct ComputeOptions {
    bool staged = false;         // the work group first copies its palette to shared memory
    bool previous = false;       // a vertex keeps its position of one update ago, for motion vectors
    bool tangents = false;       // unit tangents are skinned too
    bool earlyExit = false;      // influences behind the one that completes a weight of 1 are not read
    bool packed = false;         // position and a 32-bit normal; the draw reads the uv from the encoded vertex
    bool halfRate = false;       // copies in the far half of the grid are skinned every second frame
    bool shortTangents = false;  // unit tangents too, 4 bytes each in and out: octahedral, the lowest bit is the side
    bool wicked = false;  // as Wicked Engine keeps them: position and a normal of bytes in 16 bytes, and a tangent of
                          // bytes, 4 in and out
    bool operator==(const ComputeOptions&) const = default;
};

struct Case;
struct PlanInput;

// What the vertex records of a variant are made of.
enum class StoredAs { sceneVertices, commonInfluences, palettePartition };

struct Variant {
    const char* name;
    const char* what;
    bool onPlainRoutes = false;   // vk, gl
    bool onMeshRoutes = false;    // vk-ext, vk-nv, gl-ext, gl-nv
    bool onCpuRoute = false;      // cpu
    bool skins = true;            // its result is compared with the skinned reference, else with the bind pose
    bool skinsOnHost = false;     // FrameInput::skinned brings the vertices
    bool skinsInCompute = false;  // ComputeOptions mean something to it
    bool readsSkinned = false;    // its mesh stage draws what a pass before has skinned
    bool listsTriangles = false;  // a pass before the draw lists those that Case::triangleTests leave
    bool fetches = false;         // VertexFetch means something to it on plain routes
    bool prepasses = false;       // can draw Scenario::prepass
    bool cullsMeshlets = false;   // ClusterCull means something to it
    StoredAs storedAs = StoredAs::sceneVertices;
    uint32_t vertexBlocks = 2;  // storage blocks of its vertex stages on plain routes, with that of verifying plans
    Result<FramePlan> (*plan)(const Case& c, const PlanInput& input, const DeviceCaps& caps);
};

const std::vector<Variant>& variants();
const Variant* findVariant(const std::string& name);

// Whether the variant exists on the route at all, whatever the device.
bool runsOn(const Variant& variant, const Route& route);

// One row of the result table. Pointers refer to rows of the tables and are never null, but for `builder` and
// `layout`, which are null where no meshlets take part.
struct Case {
    const Route* route = nullptr;
    const Variant* variant = nullptr;
    const Codec* codec = nullptr;
    const Builder* builder = nullptr;
    const MeshletLayout* layout = nullptr;
    MeshletLimits limits;
    uint32_t groupSize = 32;  // invocations of a mesh work group
    int influences = 4;       // 4 or 8
    Method method = Method::lbs;
    RowFormat paletteRows = RowFormat::f32;
    ZeroWeights zeroWeights = ZeroWeights::skip;
    bool loadsOnly = false;  // reads all that skinning reads and draws the bind pose: what the loads alone take
    RasterMode raster = RasterMode::full;
    VertexFetch fetch = VertexFetch::attributes;
    Submission submission = Submission::perCopy;
    bool packedWrites = true;    // NV only: four local indices a write
    bool keepBackFaces = false;  // draw without the rasteriser's back-face culling
    Scenario scenario = Scenario::direct;
    Cull cull = Cull::off;
    Exchange exchange = Exchange::automatic;
    VertexWrites vertexWrites = VertexWrites::automatic;
    MeshShape shape;
    CommonInfluences ci;
    uint32_t paletteSlots = 32;  // of the variant `palette`
    ComputeOptions compute;
    uint32_t triangleTests = TEST_FRUSTUM | TEST_BACK | TEST_SMALL;  // of the variant `compute-cull`
    ClusterCull clusterCull = ClusterCull::off;
    uint32_t clusterTests = CLUSTER_TEST_FRUSTUM | CLUSTER_TEST_CONE;
    ClusterBounds clusterBounds = ClusterBounds::jointSpheres;
    View view = View::shaded;
    Queues queues = Queues::one;
    uint32_t views = 1;  // of a frame: the main one, and others that draw depth alone before it
};

bool onMeshRoute(const Case& c);

// Whether the case draws the posed character, not the bind pose.
bool posesVertices(const Case& c);

// The tests (TEST_) that the case makes of each triangle, in a pass or in the mesh stage.
uint32_t triangleTestsOf(const Case& c);

// The verdicts (VERDICT_) that its tests give; VERDICT_DRAWN alone: it culls nothing.
std::vector<uint32_t> verdictsOf(const Case& c);

// Whether the case's vertices share joint lists (`mesh-ci`), and whether its records leave joint ids to the meshlets.
bool sharesJointLists(const Case& c);
bool storesSlim(const Case& c);

// The codec that encodes and decodes the case's vertices: its own, or that one's `slim`.
const Codec& storedCodec(const Case& c);

// Whether `compute` skins tangents, whether each is one word, and whether a skinned vertex is 16 bytes.
bool skinsTangents(const ComputeOptions& options);
bool packsTangents(const ComputeOptions& options);
bool packsVertices(const ComputeOptions& options);

// Whether the case draws joint-palette partitions (`palette`).
bool usesPartition(const Case& c);

// Whether the case's work group is one subgroup of the device, so that lanes may exchange by shuffles or outputs.
bool canShuffle(const Case& c, const DeviceCaps& caps);

// Whether vertices are written first, of a case with Cull::compact.
bool writesFirst(const Case& c);

// Case::exchange without `automatic`, for a case that culls.
Exchange exchangeOf(const Case& c, const DeviceCaps& caps);

}  // namespace skinbench
