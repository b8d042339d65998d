// A case that is ready to be drawn again and again, and what its frames took.
#pragma once

#include <deque>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <span>

#include "common/cases/workload.h"
#include "common/frame/backend.h"
#include "common/plans/plan.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

// The copies' own vertices for skinning on the host, and room for the result.
struct HostSkinning {
    std::vector<Mesh> copies;
    std::vector<Palette> palettes;
    std::vector<SkinnedVertex> out;
};

// A picture, and its passes as passTimes() gives them.
struct DrawnPicture {
    Image image;
    std::vector<std::pair<std::string, double>> passes;
};

// One case that is ready to be drawn again and again.
struct Prepared {
    Backend* backend = nullptr;  // null on route cpu
    std::optional<PlanId> plan;
    std::vector<std::string> labels;  // of the plan's passes
    PlanInput input;                  // of the plan
    std::optional<PaletteBlocks> blocks;
    std::unique_ptr<HostSkinning> host;
    std::deque<DrawnPicture> pictures;  // begun, and not finished, where the host skins
    uint32_t meshlets = 0;
    MemoryBytes memory;
};

// A case before a device takes part.
struct Planned {
    FramePlan plan;
    Prepared ready;
};

// An error is a reason to skip the case, unless it is Fault::program: then the case fails. Null `backend`: route cpu.
Result<Planned> planCase(Workload& workload, const Case& c, Backend* backend, bool capture);

// Nothing is allocated on the device when it fails.
Result<Prepared> prepareCase(Planned planned);
void releaseCase(Prepared& ready);

// What a step of one case throws (the host is out of memory, a library gave up) becomes an error of that case.
template <class Step>
auto attempt(const Step& step) -> decltype(step()) {
    try {
        return step();
    } catch (const std::bad_alloc&) {
        return deviceError("the host is out of memory; use fewer copies or a smaller scene");
    } catch (const std::exception& error) {
        return deviceError(std::string("unexpected: ") + error.what());
    }
}

Result<std::vector<FrameData>> frameRange(Workload& workload, const Case& c, uint32_t first, uint32_t count);

// Frames whose last one shows the pose of frame 0, whatever the case. Where vertices keep their last position, frame 1
// comes first; where some copies are skinned every second frame, each pose is drawn twice. With a second queue frame 1
// comes four times before, so that what is drawn too early shows another pose.
Result<std::vector<FrameData>> framesOfPose(Workload& workload, const Case& c);

// The words of SLOT_VERDICT of a plan that has them, else none.
Result<std::vector<uint32_t>> readVerdicts(const Case& c, const Prepared& ready);

struct DrawnFrame {
    Timing timing;
    double skin = 0;  // milliseconds of the host
};

// Frames that are recorded and submitted together; bounds the memory that their palettes take.
inline constexpr uint32_t kBatch = 16;

// In RunMode::batch all of them are together, whatever kBatch.
Result<std::vector<DrawnFrame>> drawFrames(Prepared& ready, std::span<const FrameData> frames,
                                           RunMode mode = RunMode::timed);

// The verdicts of a verifying plan of the case, in its first pose; none where it culls nothing.
Result<std::vector<uint32_t>> verdictsOfPose(Workload& workload, const Case& c, Backend& backend);

// Begins the picture of the last of these frames, which are those of framesOfPose(): it is on its way as Backend::begin
// has it, or drawn at once where the host skins. finishPicture() gives the one that began first.
Result<void> beginPicture(Prepared& ready, std::span<const FrameData> frames);
Result<DrawnPicture> finishPicture(Prepared& ready);

// The mode that shows what the case is about: RunMode::batch with a second queue, else RunMode::timed.
RunMode modeOf(const Case& c);

// The frame's passes by name, on the host too; passes of one name are one.
std::vector<std::pair<std::string, double>> passTimes(const Prepared& ready, const DrawnFrame& frame);

}  // namespace skinbench
