// How a case becomes a FramePlan, and what a device must have for it.
#pragma once

#include <optional>
#include <string>

#include "common/meshlets/records.h"
#include "common/plans/case.h"
#include "common/scene/scene.h"

namespace skinbench {

// What a variant is fed: everything that does not depend on the API.
struct PlanInput {
    const ShaderLibrary* shaders = nullptr;
    Defines defines;                   // of the case's options
    const Scene* scene = nullptr;      // prepared for the case's number of influences
    const Records* records = nullptr;  // null: the scene's vertices are stored as they are
    const EncodedMesh* encoded = nullptr;
    const MeshletMesh* meshlets = nullptr;  // null where Case::builder is
    PaletteForm palette;                    // of the rows that the frames bring
    uint32_t copies = 1;
    uint32_t width = 1920;
    uint32_t height = 1080;
    bool capture = false;  // a verifying plan
};

// Nothing when the device can run the case, else the reason as the user reads it.
std::optional<std::string> unsupported(const Case& c, const DeviceCaps& caps);

// The best of devices of the API: what it cannot run, none can.
DeviceCaps unlimitedCaps(Api api);

// Fails with the reason when the device cannot hold what the copies need.
Result<FramePlan> makePlan(const Case& c, const PlanInput& input, const DeviceCaps& caps);

// The uniform blocks that the palette of one copy is made of, `size` joints each; kNoJoint fills a place that nothing
// reads. A plan with FramePlan::paletteRange is fed such blocks instead of whole palettes.
struct PaletteBlocks {
    uint32_t size = 0;
    std::vector<uint16_t> joints;
    uint32_t bytesOfJoint = 0;
    uint32_t bytes() const;   // of a block
    uint64_t stride() const;  // from one block to the next
};
std::optional<PaletteBlocks> paletteBlocks(const Case& c, const PlanInput& input);

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

}  // namespace skinbench
