// Routes, variants and cases: what can be compared, what a device can run, and how a case becomes a FramePlan.
//
// To add a variant: write shaders_glsl/NAME.glsl, a function that fills in a FramePlan, and a row in variants().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/backend.h"
#include "common/codec.h"
#include "common/meshlets.h"
#include "common/scene.h"
#include "common/shader_text.h"

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
enum class View { shaded, meshlets, weights, tuples };

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
    View view = View::shaded;
};

// What a variant is fed: everything that does not depend on the API.
struct PlanInput {
    const ShaderLibrary* shaders = nullptr;
    const Scene* scene = nullptr;  // prepared for the case's number of influences
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
    Result<FramePlan> (*plan)(const Case& which, const PlanInput& input, const DeviceCaps& caps);
};

const std::vector<Variant>& variants();
const Variant* findVariant(const std::string& name);

// Whether the variant exists on the route at all, whatever the device.
bool runsOn(const Variant& variant, const Route& route);

// The stable readable name: route/variant/codec[/builder/layout][+option…], options that are the default left out.
std::string caseId(const Case& which);

// Nothing when the device can run the case, else the reason as the user reads it.
std::optional<std::string> unsupported(const Case& which, const DeviceCaps& caps);

// Fails with the reason when a stream is larger than the device can bind.
Result<FramePlan> makePlan(const Case& which, const PlanInput& input, const DeviceCaps& caps);

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

}  // namespace skinbench
