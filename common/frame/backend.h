// The boundary between skinbench and a graphics API. A whole frame crosses it as data: bytes, GLSL text, words and
// numbers. Handles, barriers, queues and windows stay behind it, so that both APIs draw the very same FramePlan.
//
// A backend must:
//  * bind every stream that a program's text declares, at the binding number of its slot (shaders_glsl/shared.h);
//    SLOT_PALETTE and SLOT_FRAME are bound at the current frame's part of what run() uploaded; with
//    FramePlan::paletteRange the palette is a uniform block and each draw sees its own part;
//  * pass Draw::constants to every stage as the block of platform.glsl (Vulkan: push constants, 16 bytes at offset 0;
//    OpenGL: the uniform uvec4 named `drawConstants`);
//  * place a full execution and memory barrier before and after every pass, outside the pass's two timestamps, and
//    clear the targets outside them too (RunMode::timed);
//  * draw into an RGBA8 (UNORM) colour target and a D32F depth target of the plan's size, with clip space y down and
//    depth 0..1, so that row 0 of readImage() is the top row; front faces are counter-clockwise as seen on screen;
//  * refuse a plan, a batch, a slot or an image with the sentence of check_plan.h, before it does anything;
//  * report what goes wrong as one sentence; never print, throw or exit;
//  * list the devices that it sees with their identities, and open the one whose number it is given: which one a run
//    takes is decided in devices.h, for all APIs alike.
// tests/frame/test_backend_contract.cpp holds every backend to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/core/result.h"
#include "shaders_glsl/shared.h"

namespace skinbench {

enum class Api { vulkan, opengl, cpu };

// What an API is called.
struct ApiNames {
    const char* name;    // for people: "Vulkan"
    const char* key;     // in files: "vulkan"
    const char* prefix;  // of its extensions: "VK"
};
const ApiNames& namesOf(Api api);

// Which extension's dialect the mesh stages of a plan are written in.
enum class MeshDialect { none, ext, nv };

// --- what a device is ------------------------------------------------------------------------------------------

// Limits of one mesh-shader extension; all zero where it is not offered.
struct MeshLimitsOfDevice {
    bool available = false;
    uint32_t maxVertices = 0;
    uint32_t maxTriangles = 0;
    uint32_t maxGroupSize = 0;    // invocations of one mesh work group
    uint32_t maxGroupCount = 0;   // groups of one draw (x)
    uint32_t maxOutputBytes = 0;  // all outputs of one work group
    uint32_t maxSharedBytes = 0;
    uint32_t preferredGroupSize = 0;  // 0: the driver does not say
    bool taskStages = false;          // a task stage may start the mesh work groups
};

// Facts only; what follows from them is decided in common/plans/supported.cpp and common/frame/devices.cpp.
struct DeviceCaps {
    Api api = Api::vulkan;
    std::string name;       // "NVIDIA H200"
    std::string uuid;       // uuidText() of what the API calls the device's UUID; empty: not known
    std::string pci;        // pciText() of its address; empty: not known, or no PCI device
    uint32_t vendor = 0;    // of PCI; 0: not known
    size_t number = 0;      // of the physical device; this and the next are set by capsOf() of devices.h
    std::string label;      // the name, and what tells it from others of that name
    std::string driver;     // name and version of the driver
    std::string version;    // of the API on this device: "Vulkan 1.4.305", "OpenGL 4.6"
    bool software = false;  // a CPU pretends to be the device: times say nothing about a GPU
    double timestampPeriodNs = 0;
    uint32_t timestampBits = 0;  // 0: passes cannot be timed
    MeshLimitsOfDevice ext;      // VK_EXT_mesh_shader, GL_EXT_mesh_shader
    MeshLimitsOfDevice nv;       // VK_NV_mesh_shader, GL_NV_mesh_shader
    uint32_t subgroupSize = 0;   // 0: unknown
    bool meshSubgroups = false;  // mesh and task stages can shuffle and vote, and every subgroup has subgroupSize lanes
    uint32_t subpixelBits = 0;   // of the rasteriser's fixed-point positions
    uint32_t maxComputeGroupSize = 0;
    uint32_t maxComputeSharedBytes = 0;
    uint32_t maxComputeGroupCount = 0;     // x
    uint32_t maxImageSize = UINT32_MAX;    // width and height of a target
    uint64_t maxBufferBytes = UINT64_MAX;  // of one buffer
    uint64_t maxStorageBytes = 0;          // of one storage buffer binding
    uint64_t maxUniformBytes = 0;          // of one uniform buffer binding
    uint32_t storageBlocksVertex = 0;      // storage blocks a vertex stage may have
    uint64_t deviceBytes = 0;              // memory of the device's largest heap; 0: the driver does not say
    bool pipelineStatistics = false;
    bool meshCounters = false;            // statistics of task and mesh stages in the EXT dialect
    bool secondQueue = false;             // a queue of another family computes beside the one that draws
    std::vector<std::string> extensions;  // sorted

    // Faults of drivers. The first two are found by a test draw. The third shows in few of many triangles, so it is
    // taken for granted of a software device, where it was seen (Mesa 26.1).
    bool lastMeshOutputLost = false;    // the last location that mesh stages write never reaches the fragment stage
    bool primitiveCullIgnored = false;  // gl_CullPrimitiveEXT drops nothing
    bool meshDepthDiffers = false;  // a mesh and a vertex stage that write equal positions get depths that differ in
                                    // the last bit
};

inline const MeshLimitsOfDevice& meshLimits(const DeviceCaps& caps, MeshDialect dialect) {
    return dialect == MeshDialect::nv ? caps.nv : caps.ext;
}

// --- what a frame is -------------------------------------------------------------------------------------------

enum class Stage { vertex, fragment, compute, task, mesh };
const char* stageName(Stage stage);

// Complete GLSL: nothing is left to prepend. `name` is for messages.
struct ShaderText {
    Stage stage = Stage::vertex;
    std::string name;
    std::string text;
};

enum class AttributeFormat { float2, float3, float4, uint4 };

struct VertexAttribute {
    uint32_t location = 0;
    AttributeFormat format = AttributeFormat::float4;
    uint32_t offset = 0;  // bytes into one vertex
};

struct Program {
    std::string label;
    std::vector<ShaderText> stages;
    std::vector<VertexAttribute> attributes;  // empty: the vertex stage pulls what it needs
    uint32_t attributeSlot = SLOT_VERTEX;     // the stream that feeds the attributes
    uint32_t attributeStride = 0;             // bytes
};

bool hasStage(const Program& program, Stage stage);

enum StreamUse : uint32_t {
    useStorage = 1,     // a storage block
    useUniform = 2,     // a uniform block
    useAttributes = 4,  // feeds vertex attributes
    useIndices = 8,     // feeds indexed draws, 32 bits an index
    useIndirect = 16,   // holds the commands of indirect draws and dispatches
};

// One buffer. Its size is bytes->size() * replicas, each replica a copy of its own in device memory, or `gpuBytes`
// for a buffer that only the device writes (zero at first). SLOT_FRAME and SLOT_PALETTE are no streams: FrameInput
// carries them, their size is given in FramePlan. A plan has one stream at most for a slot, one that feeds indexed
// draws, one with useIndirect and one that is hostWritten.
struct Stream {
    uint32_t slot = 0;
    uint32_t use = useStorage;
    std::shared_ptr<const std::vector<std::byte>> bytes{};
    uint32_t replicas = 1;
    uint32_t replicaAdd = 0;  // added to every 32-bit word, times the replica's number: indices of a batched draw;
                              // `bytes` are whole words then
    uint64_t gpuBytes = 0;
    bool hostWritten = false;  // FrameInput::skinned replaces the whole content before each frame
    bool inTurn = false;       // two buffers with such a content: a batch's frames 0, 2, 4, … have the first one, the
                               // others the second one; in a plan with passesAhead only
};

enum class PassKind { dispatch, drawIndexed, drawMesh };

// Raster of one pass. noFragments rasterises but lets the depth test fail always, so that no fragment is shaded;
// discard stops before rasterisation. Fragment stages stay linked in all three, so outputs stay alive.
enum class RasterMode { full, noFragments, discard };

enum class DepthTest { lessWrite, equalKeep };

// What the device reads of an indirect draw or dispatch; the stream with useIndirect is an array of them. For indexed
// draws it is what VkDrawIndexedIndirectCommand and OpenGL's DrawElementsIndirectCommand are, and a program that writes
// one keeps within the indices that there are. For work groups only its first words count: the numbers of groups in x,
// y and z, or, for mesh stages of the NV dialect, their number and the first one; groupCommand() makes both. A program
// that writes one keeps within what the device starts at once.
struct DrawCommand {
    uint32_t count = 0;
    uint32_t instances = 1;
    uint32_t firstIndex = 0;
    int32_t baseVertex = 0;
    uint32_t firstInstance = 0;
};
static_assert(sizeof(DrawCommand) == 20);

// `count` work groups of a pass of that dialect; MeshDialect::none: of a dispatch.
inline DrawCommand groupCommand(uint32_t count, MeshDialect dialect) {
    return dialect == MeshDialect::nv ? DrawCommand{.count = count, .instances = 0} : DrawCommand{count, 1, 1, 0, 0};
}

// dispatch: `count` work groups (x).  drawMesh: `count` work groups (task or mesh).
// drawIndexed: `count` indices from `firstIndex`, all of them in the stream, `baseVertex` added to each.
struct Draw {
    uint32_t count = 0;
    uint32_t firstIndex = 0;
    int32_t baseVertex = 0;
    std::array<uint32_t, 4> constants{};
    uint64_t paletteOffset = 0;  // bytes into one frame's palettes, a multiple of kPaletteAlignment; the range that
                                 // starts here ends within them
    std::optional<uint32_t> command{};  // the number of a DrawCommand, which counts instead of the first three
};

struct Pass {
    std::string label;  // "skin", "cluster", "cull", "views", "depth", "draw": the key of passes_ms; those of one label
                        // are summed
    PassKind kind = PassKind::drawIndexed;
    uint32_t program = 0;  // into FramePlan::programs
    RasterMode raster = RasterMode::full;
    DepthTest depth = DepthTest::lessWrite;
    bool writeColor = true;
    bool clear = true;          // colour to FramePlan::background and depth to 1, before the first timestamp
    bool cullBackFaces = true;  // by the fixed-function rasteriser
    std::vector<Draw> draws;
};

// No device asks for a coarser alignment of uniform blocks.
inline constexpr uint64_t kPaletteAlignment = 256;

struct FramePlan {
    std::string label;  // the case id, for messages and debug tools
    MeshDialect dialect = MeshDialect::none;
    uint32_t width = 1920;
    uint32_t height = 1080;
    std::array<float, 4> background{0.13f, 0.15f, 0.18f, 1};  // red, green, blue, alpha
    uint64_t paletteBytes = 0;                                // of one frame: all copies
    uint32_t paletteRange = 0;  // bytes that a draw sees as uniform block, from Draw::paletteOffset on; 0: the
                                // palette is a storage block and every draw sees it all
    std::vector<Stream> streams;
    std::vector<Program> programs;
    std::vector<Pass> passes;
    uint32_t passesAhead = 0;  // the first so many passes, dispatches all; RunMode::batch does them on a second queue,
                               // those of frame f + 1 while the rest of frame f is done. What they write lies in
                               // streams in turn, and they read nothing that other passes write
};

// Bytes of one buffer of a stream, of device memory that the stream takes, and all streams of a plan.
uint64_t streamBytes(const Stream& stream);
uint64_t memoryOf(const Stream& stream);
uint64_t planBytes(const FramePlan& plan);

// The bytes from `from` on of what a stream with bytes holds at first: all replicas, one behind the other. With
// replicaAdd, `from` is a multiple of 4, and so is the size of `out`.
void copyReplicas(const Stream& stream, uint64_t from, std::span<std::byte> out);

// --- running it ------------------------------------------------------------------------------------------------

struct FrameInput {
    FrameConstants constants{};
    std::span<const std::byte> palette;  // paletteBytes bytes; must stay alive during run()
    std::span<const std::byte> skinned;  // all of the hostWritten stream, else empty; copied as pass "upload"
};

// How run() draws its frames.
// timed:   a full barrier around every pass and two timestamps at each.
// overlap: between the passes of a frame only what the next one reads or overwrites is waited for; two timestamps
// around the whole frame, with full barriers outside. The first pass that draws clears before the first timestamp, a
// later pass in its turn.
// batch: as a renderer draws, frame behind frame. Only what a pass reads or overwrites is waited for, between frames
// too, and every pass clears in its turn; two timestamps around all frames, with full barriers outside. Where the host
// writes before each frame it is RunMode::overlap.
// counted: pipeline statistics instead of timestamps; nothing is drawn where the device has none.
enum class RunMode { timed, overlap, batch, counted };

// What the pipeline did for one frame, all passes together; empty where the API does not count it for these passes.
struct Counters {
    std::optional<uint64_t> inputVertices, inputPrimitives, vertexInvocations, clippingInvocations, clippingPrimitives,
        fragmentInvocations, computeInvocations, taskInvocations, meshInvocations, meshPrimitives;
};

// Milliseconds. `passes` has one element for each pass of the plan, one in all in RunMode::overlap, in RunMode::batch
// one that is the time of all frames divided by their number, and none in RunMode::counted. `upload` is the host time
// that the copy of FrameInput::skinned into device memory took, fenced; 0 where there is none. `record` and `submit`
// are host times of the whole batch divided by its frames.
struct Timing {
    std::vector<double> passes;
    double upload = 0;
    double record = 0;
    double submit = 0;
    std::optional<Counters> counters;  // RunMode::counted, where DeviceCaps::pipelineStatistics
};

struct Image {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint8_t> rgba;  // row 0 is the top row
};

// A frame that was drawn while the host went on.
struct FinishedFrame {
    Timing timing;  // as of RunMode::timed
    Image image;
};

// Frames of one plan that may have begun and not finished.
inline constexpr size_t kFramesInFlight = 2;

struct BackendOptions {
    std::optional<size_t> device{};  // number in the API's own list; empty: the first hardware device, else the first
    bool validation = false;         // Vulkan validation layers with synchronisation checks, OpenGL debug output
};

using PlanId = uint32_t;

class Backend {
public:
    virtual ~Backend() = default;

    virtual const DeviceCaps& caps() const = 0;

    // Compiles and uploads; never timed. The id stays valid until release(). Fails where checkPlan does, with the
    // compiler's first error line, or when the device is out of memory; nothing is left allocated then.
    virtual Result<PlanId> prepare(const FramePlan& plan) = 0;

    // Uploads every palette first, then renders all frames in order and waits; one Timing a frame, none and nothing
    // done without frames. The first frame may be rendered once more in front of it, so what a frame leaves behind must
    // not depend on how often it ran. Fails where checkFrames does. Never fails because of what an earlier plan did; a
    // lost device is an error of this and every later call.
    virtual Result<std::vector<Timing>> run(PlanId plan, std::span<const FrameInput> frames,
                                            RunMode mode = RunMode::timed) = 0;

    // run() of one frame in RunMode::timed and readImage(), cut in two so that the host can go on in between: begin()
    // hands the device the frame and the copy of its image, and waits for neither; finish() waits for the frame of this
    // plan that began first. Up to kFramesInFlight frames of each plan are on the way, each with its own input and
    // image, whatever else is drawn. All other calls come after what has begun, and release() drops it. begin() fails
    // where checkBegin does and where memory is short, and then nothing has begun; finish() fails where nothing has
    // begun, and as run() does where the device is lost or hangs.
    virtual Result<void> begin(PlanId plan, const FrameInput& frame) = 0;
    virtual Result<FinishedFrame> finish(PlanId plan) = 0;

    // The colour target and a whole stream as the last run() of this plan left them; of a stream in turn the buffer
    // of the last frame. Plans of one size share their targets: the image is an error before a run, and once another of
    // them has run. Before a run, a stream holds what prepare() put there.
    virtual Result<Image> readImage(PlanId plan) = 0;
    virtual Result<std::vector<std::byte>> readStream(PlanId plan, uint32_t slot) = 0;

    // Ids are never used again; to release one that is not there does nothing.
    virtual void release(PlanId plan) = 0;

    // What the validation layer or the debug output said since the last call; empty without validation.
    virtual std::vector<std::string> takeMessages() = 0;
};

// --- the backends ----------------------------------------------------------------------------------------------

// Every device that the API offers on this machine, with its caps, always in the same order within a process. An API
// without a device is an error that says why: no loader, no driver, or what each of its devices and displays said.
Result<std::vector<DeviceCaps>> listVulkanDevices();
Result<std::vector<DeviceCaps>> listGlDevices();

Result<std::unique_ptr<Backend>> openVulkan(const BackendOptions& options);
Result<std::unique_ptr<Backend>> openGl(const BackendOptions& options);

// Keeps the plan and draws nothing: streams read back as uploaded, images as zero, all times are 0, nothing is counted.
// The pattern for a new backend.
std::unique_ptr<Backend> openNull(const DeviceCaps& caps);

// What BackendOptions::device says of a list that is not empty.
Result<size_t> deviceNumber(const std::vector<DeviceCaps>& devices, std::optional<size_t> number);

}  // namespace skinbench
