// What the functions of plans.h build their frames from.
#pragma once

#include "common/plans/plans.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

// For each encoded vertex the vertex of the scene that it came from.
std::vector<uint32_t> sourcesOf(const PlanInput& input);

// The vertices that shaders read, in the numbers that triangles and meshlets name.
Mesh decodedMesh(const PlanInput& input);

// Defines that every stage of the case sees.
Defines caseDefines(const Case& c, const PlanInput& input);

// Replaces the value of a define that is there, or adds it.
void setDefine(Defines& defines, const std::string& name, const std::string& value);

struct StageFile {
    Stage stage;
    const char* file;
};
Result<Program> makeProgram(const Case& c, const PlanInput& input, const char* label,
                            const std::vector<StageFile>& stages, const Defines& defines);

// Size, palette and, for a verifying plan, the stream to capture into.
FramePlan startPlan(const Case& c, const PlanInput& input);

// What passes of one program show: the main view, number 0, or some of the others, a pass each. In View::culled the
// numbers are verdicts, and each makes a part of the image.
struct Shown {
    bool image = false;  // else depth alone
    uint32_t firstView = 0;
    uint32_t views = 1;
};

// What the drawing passes of a case show, one behind the other: each view but the main one, the depth of a pre-pass,
// the image. `firstAlone` gives the first pass an entry of its own. View::culled has nothing but the image.
std::vector<Shown> shownBy(const Case& c, bool firstAlone = false);

// Above the numbers of all that is shown.
uint32_t numbersShown(const Case& c);

// A drawing pass: "draw" makes the image, after a pre-pass where the depth is equal; "depth" and "views" are depth
// only.
Pass startPass(const Case& c, PassKind kind, const Shown& shown);

// What the stages of such passes see of it. Only those that make the image capture, and only those of the main view or
// of View::culled store verdicts.
void setView(Defines& defines, const Shown& shown);

// The program of a drawing pass: the geometry stage, and the fragment stage where it makes the image.
Result<Program> makeDrawing(const Case& c, const PlanInput& input, const Shown& shown, StageFile geometry,
                            Defines defines);

// How many commands of indirect draws each view has, view after view; 0: the plan has none.
uint32_t commandsOfView(const FramePlan& plan, const Case& c);

// Adds the program, and `pass` once for each view that is shown. Its draws carry the view's number, and where they are
// indirect they take that view's commands.
void addPasses(FramePlan& plan, const Case& c, Program program, const Pass& pass, const Shown& shown);

// Orders the passes from that one on by their views, the main one last, or by their verdicts, what is drawn first. All
// have one list of triangles or meshlets, so each is drawn before the next one is listed.
void orderByView(FramePlan& plan, const Case& c, size_t firstPass);

// A copy of the bytes for every character; nothing for null or empty bytes.
void addStream(FramePlan& plan, uint32_t slot, uint32_t use, const Bytes& bytes, uint32_t copies);

// The encoded vertices and what belongs to them, for stages that read storage blocks.
void addEncoded(FramePlan& plan, const PlanInput& input);

// One vertex of SLOT_SKINNED, in bytes: a SkinnedVertex, or 16 bytes where packsVertices(); then a vec4 each for
// what the case keeps beside. `previous` and `tangent` are offsets, 0 where there is none.
struct SkinnedLayout {
    uint32_t stride = 0;
    uint32_t previous = 0;
    uint32_t tangent = 0;
};
SkinnedLayout skinnedLayout(const Case& c);

// Room for every vertex of every copy.
void addSkinnedStream(FramePlan& plan, const PlanInput& input, uint32_t use, uint32_t stride = sizeof(SkinnedVertex));

// The vertices that the triangles name, as the case stores them; in the order of the meshlets where there are any.
std::vector<uint32_t> drawnIndices(const PlanInput& input);

// An indexed draw a copy, or one for all: then the indices of copy c already count from c * vertexCount. The index
// stream is added once.
void addIndexedDraws(FramePlan& plan, Pass& pass, const Case& c, const PlanInput& input);

// A draw a copy, or one for all, by the commands from `firstCommand` on.
void addListedDraws(Pass& pass, const Case& c, const PlanInput& input, uint32_t firstCommand);

// The steps of a pixel that the rasteriser rounds positions to, or fewer.
uint32_t rasterSubpixels(const DeviceCaps& caps);

// Work groups for every copy, or for all at once; draws are split where the device allows fewer groups.
void addGroupDraws(Pass& pass, const Case& c, const PlanInput& input, uint32_t groupsOfCopy, uint32_t groupsOfAll,
                   uint32_t most);

// Work groups for all copies at once, or for `each` things of one.
Pass dispatchPass(const char* label, const Case& c, const PlanInput& input, const DeviceCaps& caps, uint64_t each,
                  uint32_t groupSize);

// The most triangles of a meshlet that mesh stages declare: whole fours, as packed index writes store them.
uint32_t declaredTriangles(const Case& c);

// Whether a plan of the case has SLOT_VERDICT, and for how many triangles of a meshlet it then stores whether they are
// drawn: 0 where no mesh stage of the main view culls.
bool storesVerdicts(const Case& c, const PlanInput& input);
uint32_t storedTriangles(const Case& c);

// What ClusterCull reads and writes, the verdicts, and the defines of its stages. A list's counts are a view's commands
// from 0 on or, with Variant::listsTriangles, those behind the draws'.
void addClusters(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps, Defines& defines);

// The pass "bounds" of ClusterBounds::instance, and a pass "cluster" for each view where meshlets are listed.
Result<void> addInstanceBounds(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                               const Defines& defines);
Result<void> addClusterList(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                            Defines defines, const Shown& shown);

// The pass "skin": a compute work group for every COMPUTE_GROUP vertices writes SLOT_SKINNED, which must be there.
// More defines than the case's go to its shader.
Result<void> addSkinPass(FramePlan& plan, const Case& c, const PlanInput& input, const DeviceCaps& caps,
                         const Defines& more = {});

// Queues::async: the passes "skin" in front run ahead, and what they write lies in streams in turn.
void runAhead(FramePlan& plan, const Case& c);

// A pass with a plain vertex stage over the attributes of SLOT_SKINNED: the same for every variant that
// has skinned before.
Result<void> addSkinnedDraw(FramePlan& plan, const Case& c, const PlanInput& input, const Shown& shown);

}  // namespace skinbench
