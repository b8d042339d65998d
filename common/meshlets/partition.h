// Joint-palette partitions (F. Paanakker, "Skinned Mesh Export: Optimization"): a mesh whose joints do not fit the
// palette slots of the hardware is drawn in several passes, and between two passes only the joints that are missing
// are loaded. Triangles with the same joints form a group; a solver puts the groups into passes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/scene/scene.h"

namespace skinbench {

// What a draw call can reach and what it costs, in units of one slot upload. The costs are estimates that weigh a
// draw call against an upload; they decide between plans and are no measure of time.
struct PaletteHardware {
    const char* name;
    const char* what;
    uint32_t slots;  // 1 to 65535
    uint32_t uploadCost;
    uint32_t passCost;
};

// generic (its slots are a default that callers overwrite), console, vs1-4x4, vs1, vs2, vs3, rigid.
const std::vector<PaletteHardware>& paletteHardware();
const PaletteHardware* findPaletteHardware(const std::string& name);

// The triangles that use exactly these joints.
struct JointGroup {
    std::vector<uint16_t> joints;     // ascending; those of weight > 0 of the three vertices
    std::vector<uint32_t> triangles;  // of the mesh, ascending
};

// In order of their first triangles. The mesh is one that checkScene accepts.
std::vector<JointGroup> groupByJoints(const Mesh& mesh);

struct GroupOrder {
    const char* name;
    const char* what;
    void (*sort)(std::vector<JointGroup>& groups);  // equal groups stay as given
};

// given, size, lexicographic
const std::vector<GroupOrder>& groupOrders();
const GroupOrder* findGroupOrder(const std::string& name);

// Group numbers by pass, in drawing order. Each group stands in one pass and the joints of a pass fit the slots.
using GroupPasses = std::vector<std::vector<uint32_t>>;

// What solvers minimise: a pass uploads the joints that the pass before it does not use. An upper bound of planCost,
// because slots also keep joints of earlier passes.
uint64_t estimatedCost(const std::vector<JointGroup>& groups, const GroupPasses& passes,
                       const PaletteHardware& hardware);

struct PartitionSolver {
    const char* name;
    const char* what;
    GroupPasses (*solve)(const std::vector<JointGroup>& groups, const PaletteHardware& hardware);
};

// simple:             opens a pass whenever the next group does not fit the current one.
// cheapest-insertion: puts each group where it raises estimatedCost the least: into a pass that has room, or between
//                     two passes as one of its own. Of equal places the first pass with room, else the last new one.
const std::vector<PartitionSolver>& partitionSolvers();
const PartitionSolver* findPartitionSolver(const std::string& name);

struct SlotLoad {
    uint16_t slot = 0;
    uint16_t joint = 0;
    bool operator==(const SlotLoad&) const = default;
};

// One pass: load the slots, then draw the triangles. Slots that are not loaded keep their joints.
struct PartitionCommand {
    std::vector<SlotLoad> loads;
    uint32_t firstTriangle = 0;  // into PartitionPlan::triangles
    uint32_t triangleCount = 0;
    bool operator==(const PartitionCommand&) const = default;
};

struct PartitionPlan {
    uint32_t slots = 0;
    uint32_t groups = 0;
    std::vector<uint32_t> triangles;  // of the mesh, command by command, ascending within one
    std::vector<PartitionCommand> commands;
    uint64_t uploads = 0;  // slots loaded by all commands
    uint32_t passes = 0;   // commands
    bool operator==(const PartitionPlan&) const = default;
};

// The same arguments give the same plan on every machine. Where a slot must be freed, the joint goes that is needed
// again last. Fails when a triangle needs more joints than there are slots.
Result<PartitionPlan> partitionMesh(const Mesh& mesh, const PaletteHardware& hardware, const PartitionSolver& solver,
                                    const GroupOrder& order);

uint64_t planCost(const PartitionPlan& plan, const PaletteHardware& hardware);

// The joint in each slot while `command` draws; kNoJoint where nothing was loaded yet.
std::vector<uint16_t> slotsAfter(const PartitionPlan& plan, size_t command);

// Every triangle exactly once, every joint that it needs in a slot when it is drawn, every load in range, counts right.
Result<void> checkPartition(const Mesh& mesh, const PartitionPlan& plan);

}  // namespace skinbench
