#include "common/meshlets/partition.h"

#include <algorithm>
#include <array>
#include <bit>
#include <format>
#include <iterator>
#include <map>

#include "common/core/text.h"

namespace skinbench {

const std::vector<PaletteHardware>& paletteHardware() {
    static const std::vector<PaletteHardware> rows = {
        {"generic", "as many slots as are asked for", 32, 1, 8},
        {"console", "a console's vector unit with room for 8 joints", 8, 1, 2},
        {"vs1-4x4", "vs_1_1: 80 of 96 constants, 4 a joint", 20, 1, 16},
        {"vs1", "vs_1_1: 84 of 96 constants, 3 a joint", 28, 1, 16},
        {"vs2", "vs_2_0: 210 of 256 constants, 3 a joint", 70, 1, 16},
        {"vs3", "vs_3_0: 240 of 256 constants, 3 a joint", 80, 1, 16},
        {"rigid", "one joint a draw", 1, 1, 4},
    };
    return rows;
}

const PaletteHardware* findPaletteHardware(const std::string& name) {
    for (const PaletteHardware& hardware : paletteHardware())
        if (name == hardware.name) return &hardware;
    return nullptr;
}

static std::vector<uint16_t> jointsOfTriangle(const Mesh& mesh, size_t triangle) {
    std::array<uint16_t, 3 * kMaxInfluences> found;
    size_t count = 0;
    for (size_t corner = 0; corner < 3; ++corner) {
        const Influences& influences = mesh.influences[mesh.indices[triangle * 3 + corner]];
        for (size_t i = 0; i < kMaxInfluences; ++i) {
            const uint16_t joint = influences.joints[i];
            if (influences.weights[i] <= 0 || joint == kNoJoint) continue;
            if (std::find(found.data(), found.data() + count, joint) == found.data() + count) found[count++] = joint;
        }
    }
    std::sort(found.data(), found.data() + count);
    return {found.data(), found.data() + count};
}

std::vector<JointGroup> groupByJoints(const Mesh& mesh) {
    std::vector<JointGroup> groups;
    std::map<std::vector<uint16_t>, size_t> numbers;
    for (size_t triangle = 0; triangle < mesh.indices.size() / 3; ++triangle) {
        const auto [found, isNew] = numbers.try_emplace(jointsOfTriangle(mesh, triangle), groups.size());
        if (isNew) groups.push_back({found->first, {}});
        groups[found->second].triangles.push_back(static_cast<uint32_t>(triangle));
    }
    return groups;
}

const std::vector<GroupOrder>& groupOrders() {
    static const std::vector<GroupOrder> rows = {
        {"given", "by first triangle", [](std::vector<JointGroup>&) {}},
        {"size", "most joints first",
         [](std::vector<JointGroup>& groups) {
             std::ranges::stable_sort(groups, std::ranges::greater{},
                                      [](const JointGroup& g) { return g.joints.size(); });
         }},
        {"lexicographic", "by joint numbers",
         [](std::vector<JointGroup>& groups) { std::ranges::stable_sort(groups, {}, &JointGroup::joints); }},
    };
    return rows;
}

const GroupOrder* findGroupOrder(const std::string& name) {
    for (const GroupOrder& order : groupOrders())
        if (name == order.name) return &order;
    return nullptr;
}

static std::vector<uint16_t> jointsOfPass(const std::vector<JointGroup>& groups, const std::vector<uint32_t>& pass) {
    std::vector<uint16_t> joints;
    for (uint32_t group : pass) joints.insert(joints.end(), groups[group].joints.begin(), groups[group].joints.end());
    std::ranges::sort(joints);
    joints.erase(std::ranges::unique(joints).begin(), joints.end());
    return joints;
}

uint64_t estimatedCost(const std::vector<JointGroup>& groups, const GroupPasses& passes,
                       const PaletteHardware& hardware) {
    uint64_t cost = 0;
    std::vector<uint16_t> before;
    for (const std::vector<uint32_t>& pass : passes) {
        const std::vector<uint16_t> joints = jointsOfPass(groups, pass);
        std::vector<uint16_t> missing;
        std::ranges::set_difference(joints, before, std::back_inserter(missing));
        cost += missing.size() * hardware.uploadCost + hardware.passCost;
        before = joints;
    }
    return cost;
}

static GroupPasses solveSimple(const std::vector<JointGroup>& groups, const PaletteHardware& hardware) {
    GroupPasses passes;
    std::vector<uint16_t> current;
    for (uint32_t group = 0; group < groups.size(); ++group) {
        const std::vector<uint16_t>& joints = groups[group].joints;
        std::vector<uint16_t> both;
        std::ranges::set_union(current, joints, std::back_inserter(both));
        if (passes.empty() || both.size() > hardware.slots) {
            passes.emplace_back();
            both = joints;
        }
        passes.back().push_back(group);
        current = std::move(both);
    }
    return passes;
}

namespace {

struct InsertionPass {
    std::vector<uint64_t> bits;  // joint j: bit j % 64 of word j / 64
    uint32_t joints = 0;
    uint32_t uploads = 0;  // joints that the pass before does not use
    std::vector<uint32_t> groups;
};

struct Position {
    size_t pass = 0;
    bool opens = true;  // a new pass before `pass`, else the group joins `pass`
};

}  // namespace

// In each pass, and in the two empty ones around them, which of the group's joints it uses: bit i for joint i. A group
// has at most 3 * kMaxInfluences = 24 joints.
static void findMembers(const std::vector<InsertionPass>& passes, const std::vector<uint16_t>& joints,
                        std::vector<uint32_t>& members) {
    members.assign(passes.size() + 2, 0);
    for (size_t p = 0; p < passes.size(); ++p)
        for (size_t i = 0; i < joints.size(); ++i)
            members[p + 1] |= static_cast<uint32_t>(passes[p].bits[joints[i] / 64] >> joints[i] % 64 & 1) << i;
}

// Only the uploads of the pass at the position and of the one after it change, and only by the group's joints.
static Position cheapestPosition(const std::vector<InsertionPass>& passes, const std::vector<uint32_t>& members,
                                 uint32_t jointCount, const PaletteHardware& hardware) {
    const uint32_t all = (1u << jointCount) - 1;
    int64_t least = INT64_MAX;
    Position cheapest;
    auto offer = [&](const Position& position, int64_t uploads, uint32_t newPasses) {
        const int64_t cost = uploads * hardware.uploadCost + int64_t{newPasses} * hardware.passCost;
        if (cost >= least) return;
        least = cost;
        cheapest = position;
    };
    for (size_t p = 0; p < passes.size(); ++p) {
        const uint32_t missing = all & ~members[p + 1];
        if (passes[p].joints + std::popcount(missing) > hardware.slots) continue;
        offer({p, false}, std::popcount(missing & ~members[p]) - std::popcount(missing & members[p + 2]), 0);
    }
    for (size_t p = passes.size() + 1; p-- > 0;) {
        int64_t uploads = std::popcount(all & ~members[p]);
        if (p < passes.size()) uploads += int64_t{passes[p].joints} - std::popcount(members[p + 1]) - passes[p].uploads;
        offer({p, true}, uploads, 1);
    }
    return cheapest;
}

static void countUploads(std::vector<InsertionPass>& passes, size_t p) {
    if (p >= passes.size()) return;
    passes[p].uploads = 0;
    for (size_t word = 0; word < passes[p].bits.size(); ++word)
        passes[p].uploads += std::popcount(passes[p].bits[word] & ~(p > 0 ? passes[p - 1].bits[word] : 0));
}

static GroupPasses solveCheapestInsertion(const std::vector<JointGroup>& groups, const PaletteHardware& hardware) {
    uint32_t words = 1;
    for (const JointGroup& group : groups)
        if (!group.joints.empty()) words = std::max(words, group.joints.back() / 64u + 1);
    std::vector<InsertionPass> passes;
    std::vector<uint32_t> members;
    for (uint32_t group = 0; group < groups.size(); ++group) {
        const std::vector<uint16_t>& joints = groups[group].joints;
        findMembers(passes, joints, members);
        const Position at = cheapestPosition(passes, members, static_cast<uint32_t>(joints.size()), hardware);
        if (at.opens)
            passes.insert(passes.begin() + static_cast<std::ptrdiff_t>(at.pass),
                          InsertionPass{std::vector<uint64_t>(words), 0, 0, {}});
        InsertionPass& pass = passes[at.pass];
        for (uint16_t joint : joints) {
            pass.joints += ~pass.bits[joint / 64] >> joint % 64 & 1;
            pass.bits[joint / 64] |= uint64_t{1} << joint % 64;
        }
        pass.groups.push_back(group);
        countUploads(passes, at.pass);
        countUploads(passes, at.pass + 1);
    }
    GroupPasses result;
    for (InsertionPass& pass : passes) result.push_back(std::move(pass.groups));
    return result;
}

const std::vector<PartitionSolver>& partitionSolvers() {
    static const std::vector<PartitionSolver> rows = {
        {"simple", "fills one pass after the other in the order of the groups", solveSimple},
        {"cheapest-insertion", "puts each group where it adds the least cost", solveCheapestInsertion},
    };
    return rows;
}

const PartitionSolver* findPartitionSolver(const std::string& name) {
    for (const PartitionSolver& solver : partitionSolvers())
        if (name == solver.name) return &solver;
    return nullptr;
}

static std::vector<SlotLoad> loadMissing(std::vector<uint16_t>& slots, const std::vector<uint16_t>& joints,
                                         const std::map<uint16_t, std::vector<size_t>>& uses, size_t pass) {
    std::vector<uint16_t> missing;
    std::vector<bool> needed(slots.size());
    for (uint16_t joint : joints) {
        const auto slot = std::ranges::find(slots, joint);
        if (slot == slots.end())
            missing.push_back(joint);
        else
            needed[static_cast<size_t>(slot - slots.begin())] = true;
    }
    // Larger is freed earlier: empty slots, then joints that are never needed again, then by distance.
    auto nextUse = [&](uint16_t joint) {
        if (joint == kNoJoint) return SIZE_MAX;
        const std::vector<size_t>& passes = uses.at(joint);
        const auto next = std::ranges::upper_bound(passes, pass);
        return next == passes.end() ? SIZE_MAX - 1 : *next;
    };
    std::vector<std::pair<size_t, uint16_t>> free;
    for (size_t slot = 0; slot < slots.size(); ++slot)
        if (!needed[slot]) free.emplace_back(nextUse(slots[slot]), static_cast<uint16_t>(slot));
    std::ranges::stable_sort(free, std::ranges::greater{}, [](const auto& entry) { return entry.first; });

    std::vector<SlotLoad> loads;
    for (size_t i = 0; i < missing.size(); ++i) {
        loads.push_back({free[i].second, missing[i]});
        slots[free[i].second] = missing[i];
    }
    return loads;
}

static PartitionPlan planPasses(const std::vector<JointGroup>& groups, const GroupPasses& passes, uint32_t slotCount) {
    std::vector<std::vector<uint16_t>> joints;
    std::map<uint16_t, std::vector<size_t>> uses;
    for (const std::vector<uint32_t>& pass : passes) {
        joints.push_back(jointsOfPass(groups, pass));
        SKINBENCH_ASSERT(joints.back().size() <= slotCount);
        for (uint16_t joint : joints.back()) uses[joint].push_back(joints.size() - 1);
    }
    PartitionPlan plan;
    plan.slots = slotCount;
    plan.groups = static_cast<uint32_t>(groups.size());
    plan.passes = static_cast<uint32_t>(passes.size());
    std::vector<uint16_t> slots(slotCount, kNoJoint);
    for (size_t pass = 0; pass < passes.size(); ++pass) {
        PartitionCommand command;
        command.loads = loadMissing(slots, joints[pass], uses, pass);
        command.firstTriangle = static_cast<uint32_t>(plan.triangles.size());
        for (uint32_t group : passes[pass])
            plan.triangles.insert(plan.triangles.end(), groups[group].triangles.begin(), groups[group].triangles.end());
        command.triangleCount = static_cast<uint32_t>(plan.triangles.size()) - command.firstTriangle;
        // Mesh order keeps what the vertex cache gained.
        std::sort(plan.triangles.begin() + command.firstTriangle, plan.triangles.end());
        plan.uploads += command.loads.size();
        plan.commands.push_back(std::move(command));
    }
    return plan;
}

Result<PartitionPlan> partitionMesh(const Mesh& mesh, const PaletteHardware& hardware, const PartitionSolver& solver,
                                    const GroupOrder& order) {
    SKINBENCH_ASSERT(hardware.slots >= 1 && hardware.slots <= UINT16_MAX);
    std::vector<JointGroup> groups = groupByJoints(mesh);
    const auto largest = std::ranges::max_element(groups, {}, [](const JointGroup& g) { return g.joints.size(); });
    if (largest != groups.end() && largest->joints.size() > hardware.slots)
        return inputError(std::format(
            "triangle {} needs {} at once, but a draw has {}; choose fewer influences a vertex (--influences)",
            largest->triangles[0], counted(largest->joints.size(), "joint"), counted(hardware.slots, "palette slot")));
    order.sort(groups);
    return planPasses(groups, solver.solve(groups, hardware), hardware.slots);
}

uint64_t planCost(const PartitionPlan& plan, const PaletteHardware& hardware) {
    return plan.uploads * hardware.uploadCost + uint64_t{plan.passes} * hardware.passCost;
}

std::vector<uint16_t> slotsAfter(const PartitionPlan& plan, size_t command) {
    SKINBENCH_ASSERT(command < plan.commands.size());
    std::vector<uint16_t> slots(plan.slots, kNoJoint);
    for (size_t c = 0; c <= command; ++c)
        for (const SlotLoad& load : plan.commands[c].loads) slots[load.slot] = load.joint;
    return slots;
}

Result<void> checkPartition(const Mesh& mesh, const PartitionPlan& plan) {
    std::vector<bool> drawn(mesh.indices.size() / 3);
    std::vector<uint16_t> slots(plan.slots, kNoJoint);
    uint64_t uploads = 0, end = 0;
    for (size_t c = 0; c < plan.commands.size(); ++c) {
        const PartitionCommand& command = plan.commands[c];
        auto fault = [&](const std::string& what) { return inputError(std::format("command {}: {}", c, what)); };
        std::vector<bool> loaded(plan.slots);
        for (const SlotLoad& load : command.loads) {
            if (load.slot >= plan.slots) return fault(std::format("loads slot {} of {}", load.slot, plan.slots));
            if (load.joint == kNoJoint) return fault(std::format("loads no joint into slot {}", load.slot));
            if (loaded[load.slot]) return fault(std::format("loads slot {} twice", load.slot));
            loaded[load.slot] = true;
            slots[load.slot] = load.joint;
        }
        uploads += command.loads.size();
        if (command.triangleCount == 0) return fault("draws nothing");
        if (command.firstTriangle != end) return fault("does not begin where the command before it ends");
        end += command.triangleCount;
        if (end > plan.triangles.size()) return fault("reaches past the end of the triangle list");

        std::vector<uint16_t> held = slots;
        std::ranges::sort(held);
        for (uint64_t i = command.firstTriangle; i < end; ++i) {
            const uint32_t triangle = plan.triangles[i];
            if (triangle >= drawn.size()) return fault(std::format("triangle {} does not exist", triangle));
            if (drawn[triangle]) return fault(std::format("triangle {} is drawn a second time", triangle));
            drawn[triangle] = true;
            for (uint16_t joint : jointsOfTriangle(mesh, triangle))
                if (!std::ranges::binary_search(held, joint))
                    return fault(std::format("triangle {} needs joint {}, which is in no slot", triangle, joint));
        }
    }
    if (end != plan.triangles.size() || std::ranges::find(drawn, false) != drawn.end())
        return inputError("the commands do not draw every triangle exactly once");
    if (uploads != plan.uploads || plan.commands.size() != plan.passes)
        return inputError(std::format("the plan counts {} uploads and {} passes, but its commands make {} and {}",
                                      plan.uploads, plan.passes, uploads, plan.commands.size()));
    return {};
}

}  // namespace skinbench
