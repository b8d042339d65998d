// What the cases of one run share: the scene prepared for 4 and 8 influences, its meshlets per builder and its
// encodings per codec, each made once; and the palettes of every frame.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>

#include "common/cases/axes.h"
#include "common/cases/camera.h"
#include "common/plans/plan.h"

namespace skinbench {

struct WorkloadSettings {
    PrepareOptions prepare;  // its influences are replaced by those of each case
    std::string clip;        // empty: the scene's first; "none": the rest pose
    bool animated = true;    // false: every frame shows the pose of `seconds`
    float seconds = 0.4f;    // time of frame 0
    uint32_t copies = 1;
    uint32_t width = 1920;
    uint32_t height = 1080;
    float yaw = 0;
    Camera camera = Camera::crowd;
    float characterPixels = 0;  // of Camera::crowd: how tall a character is drawn; 0: so that all are in view
    CameraMove move;            // of every view but the overview, from where it usually is
    CameraMove overview;        // of the overview alone
};

struct Workload {
    WorkloadSettings settings;
    ShaderLibrary shaders;
    Scene stored;

    // By keyOf: what of a case changes the content.
    std::map<int, std::unique_ptr<Scene>> prepared;
    std::map<std::string, std::unique_ptr<MeshletMesh>> meshlets;
    std::map<std::string, std::unique_ptr<Records>> records;
    std::map<std::string, std::unique_ptr<EncodedMesh>> encoded;
    std::map<int, Bounds> bounds;   // of the clip, by influences
    std::optional<bool> stretches;  // whether joints of the clip do; known once a case asks
};

// Fails when the clip does not exist; the error names the clips that do.
Result<Workload> makeWorkload(Scene scene, ShaderLibrary shaders, const WorkloadSettings& settings);

// The prepared scene; made on first use and kept, like everything below.
Result<const Scene*> sceneFor(Workload& workload, int influences);

// Everything a plan of the case needs; `capture` is left false.
Result<PlanInput> planInput(Workload& workload, const Case& c);

const Clip* chosenClip(const Workload& workload);

// Another clip of the scene. Fails as makeWorkload does, and changes nothing then.
Result<void> chooseClip(Workload& workload, const std::string& clip);

// How the settings place the copies of the scene as it is prepared for so many influences: the same at every moment of
// the clip, and however many copies and frames are drawn.
Result<Framing> framingOf(Workload& workload, int influences);

// Copies run through the clip with sixteen different offsets, so that neighbours differ and a wrong copy number shows.
inline constexpr uint32_t kPhases = 16;

// One frame's constants, and its palettes by phase: as many as there are, or as there are copies.
struct FrameData {
    FrameConstants constants;
    std::vector<Palette> phases;
};
Result<FrameData> makeFrame(Workload& workload, int influences, uint32_t frame);

// As clipPosition of shaders_glsl/frame.glsl: a copy's skinned position before the division by w.
glm::dvec4 clipPosition(const FrameConstants& constants, uint32_t copy, const glm::dvec3& position);

// Shares of all copies' vertices, triangles, and of the copies, that the first frame does not place outside of the
// image, where nothing is rasterised. A triangle is outside where all its corners lie beyond one plane of the view
// volume, a copy where all its triangles are.
struct InView {
    double vertices = 1;
    double triangles = 1;
    double copies = 1;
};
Result<InView> inView(Workload& workload, int influences);

// What FrameInput::palette brings for a plan of that input: the rows of all copies, or, with blocks, those of each
// copy's blocks, each block at a multiple of kPaletteAlignment. Fails as paletteRows does.
Result<std::vector<std::byte>> paletteBytes(const PlanInput& input, const std::optional<PaletteBlocks>& blocks,
                                            const FrameData& frame);

const Palette& paletteOfCopy(const FrameData& frame, uint32_t copy);

}  // namespace skinbench
