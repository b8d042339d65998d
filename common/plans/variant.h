// Routes, variants and cases: what can be compared, what a device can run, and how a case becomes a FramePlan.
//
// To add a variant: write shaders_glsl/NAME.glsl, a function that fills in a FramePlan, and a row in variants().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/codecs/codec.h"
#include "common/frame/backend.h"
#include "common/frame/shader_text.h"
#include "common/meshlets/common_influences.h"
#include "common/meshlets/meshlets.h"
#include "common/meshlets/records.h"
#include "common/scene/scene.h"

namespace skinbench {

// The API with the extension that carries the geometry.
struct Route {
    const char* name;
    Api api;
    MeshDialect dialect;
    const char* what;
};

// vk, vk-ext, vk-nv, gl, gl-ext, gl-nv, cpu
const std::vector<Route>& routes();
const Route* findRoute(const std::string& name);

enum class VertexFetch { attributes, pull };
enum class Submission { perCopy, batched };
enum class View { shaded, meshlets, weights, tuples, velocity, resolution };

// Back-face culling in the mesh stage; shaders_glsl/cull.glsl says how each works.
enum class Cull { off, compact, primitive, torabi };

// How the lanes of a culling mesh work group see each other's positions. automatic: by shuffles where the device's
// subgroup is the work group, else through shared memory.
enum class Exchange { automatic, shuffle, shared };

// direct:  skinned where it is drawn, once.
// prepass: the first pass lays down the depth and keeps the skinned vertices, the second draws them where the depth is
//          equal (Torabi 3.3).
enum class Scenario { direct, prepass };

// Where a mesh work group's vertices name their joints.
// vertex:  each vertex has joint ids.
// meshlet: the meshlet lists its joints, each vertex has one-byte numbers into that list.
// staged:  so too, and the work group first copies the listed palette rows to shared memory.
enum class JointSource { vertex, meshlet, staged };

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
    bool staged = false;     // the work group first copies its palette to shared memory
    bool previous = false;   // a vertex keeps its position of one update ago, for motion vectors
    bool tangents = false;   // unit tangents are skinned too
    bool earlyExit = false;  // influences behind the one that completes a weight of 1 are not read
    bool packed = false;     // position and a 32-bit normal; the draw reads the uv from the encoded vertex
    bool halfRate = false;   // copies in the far half of the grid are skinned every second frame
    bool operator==(const ComputeOptions&) const = default;
};

// The options' names, in the order of case ids.
struct ComputeWord {
    const char* name;
    bool ComputeOptions::*option;
};
const std::vector<ComputeWord>& computeWords();

// "staged+packed", or "plain".
std::string computeName(const ComputeOptions& options);

struct Variant;

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
    RasterMode raster = RasterMode::full;
    VertexFetch fetch = VertexFetch::attributes;
    Submission submission = Submission::perCopy;
    bool packedWrites = true;    // NV only: four local indices a write
    bool keepBackFaces = false;  // draw without the rasteriser's back-face culling
    Scenario scenario = Scenario::direct;
    Cull cull = Cull::off;
    Exchange exchange = Exchange::automatic;
    MeshShape shape;
    CommonInfluences common;
    uint32_t paletteSlots = 32;  // of the variant `palette`
    ComputeOptions compute;
    View view = View::shaded;
};

// What a variant is fed: everything that does not depend on the API.
struct PlanInput {
    const ShaderLibrary* shaders = nullptr;
    const Scene* scene = nullptr;      // prepared for the case's number of influences
    const Records* records = nullptr;  // null: the scene's vertices are stored as they are
    const EncodedMesh* encoded = nullptr;
    const MeshletMesh* meshlets = nullptr;  // null where Case::builder is
    uint32_t copies = 1;
    uint32_t width = 1920;
    uint32_t height = 1080;
    bool capture = false;  // a verifying plan
};

struct Variant {
    const char* name;
    const char* what;
    bool onPlainRoutes;  // vk, gl
    bool onMeshRoutes;   // vk-ext, vk-nv, gl-ext, gl-nv
    bool onCpuRoute;     // cpu
    bool skins;          // its result is compared with the skinned reference, else with the bind pose
    bool fetches;        // VertexFetch means something to it on plain routes
    bool prepasses;      // can draw Scenario::prepass
    Result<FramePlan> (*plan)(const Case& which, const PlanInput& input, const DeviceCaps& caps);
};

const std::vector<Variant>& variants();
const Variant* findVariant(const std::string& name);

// Whether the variant exists on the route at all, whatever the device.
bool runsOn(const Variant& variant, const Route& route);

// Whether the case's vertices share joint lists (`mesh-ci`), and whether its records leave joint ids to the meshlets.
bool sharesJointLists(const Case& which);
bool storesSlim(const Case& which);

// Whether the case draws joint-palette partitions (`palette`).
bool usesPartition(const Case& which);

// Whether the case's work group is one subgroup of the device, so that lanes may exchange by shuffles.
bool canShuffle(const Case& which, const DeviceCaps& caps);

// The stable readable name: route/variant/codec[/builder/layout][+option…], options that are the default left out.
std::string caseId(const Case& which);

// The same draws with nothing fetched and nothing skinned: what the device needs at least for such meshlets or indices,
// in the case's raster mode. Mesh stages read meshlet descriptors and local indices, vertex stages the index buffer;
// positions follow from numbers (codec `ids`). Meshlets are those of the builder's plain cut, back faces are left to
// the rasteriser, and a copy of `palette` is one draw. Empty for cases that the host skins and for pre-passes.
std::optional<Case> limitCase(const Case& which);

// Nothing when the device can run the case, else the reason as the user reads it.
std::optional<std::string> unsupported(const Case& which, const DeviceCaps& caps);

// Fails with the reason when a stream is larger than the device can bind.
Result<FramePlan> makePlan(const Case& which, const PlanInput& input, const DeviceCaps& caps);

// The uniform blocks that the palette of one copy is made of, `size` joints each; kNoJoint fills a place that nothing
// reads. A plan with FramePlan::paletteRange is fed such blocks instead of whole palettes.
struct PaletteBlocks {
    uint32_t size = 0;
    std::vector<uint16_t> joints;
    uint64_t stride() const;  // bytes from one block to the next
};
std::optional<PaletteBlocks> paletteBlocks(const Case& which, const PlanInput& input);

// Bytes of device memory for one copy, by what they hold.
struct MemoryBytes {
    uint64_t vertex = 0;
    uint64_t index = 0;
    uint64_t meshlet = 0;
    uint64_t additionalMeshlet = 0;
    uint64_t tuple = 0;
    uint64_t palette = 0;
    uint64_t skinned = 0;
    uint64_t total() const { return vertex + index + meshlet + additionalMeshlet + tuple + palette + skinned; }
};
MemoryBytes memoryOfOneCopy(const FramePlan& plan, uint32_t copies);

// Words for messages and files.
const char* rasterName(RasterMode raster);
const char* viewName(View view);
const char* cullName(Cull cull);
const char* exchangeName(Exchange exchange);
const char* scenarioName(Scenario scenario);
const char* jointSourceName(JointSource joints);
const char* ciGroupingName(CiGrouping grouping);
const char* ciKeyName(CiKey key);

}  // namespace skinbench
