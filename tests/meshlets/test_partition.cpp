// Joint-palette partitions: groups, solvers beside plain ones, command lists made by hand, the check of a plan.
#include <algorithm>
#include <bit>
#include <random>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/meshlets/partition.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

using Joints = std::vector<uint16_t>;

const PartitionSolver& kSimple = *findPartitionSolver("simple");
const PartitionSolver& kInsertion = *findPartitionSolver("cheapest-insertion");
const GroupOrder& kGiven = *findGroupOrder("given");

PaletteHardware generic(uint32_t slots, uint32_t passCost = 8) {
    PaletteHardware hardware = *findPaletteHardware("generic");
    hardware.slots = slots;
    hardware.passCost = passCost;
    return hardware;
}

// One triangle a set; its joints are spread over the three vertices.
Mesh meshOf(const std::vector<Joints>& sets) {
    Mesh mesh;
    for (const Joints& joints : sets) {
        std::array<Influences, 3> corners;
        for (Influences& corner : corners) corner.joints.fill(kNoJoint);
        for (size_t i = 0; i < joints.size(); ++i) {
            corners[i % 3].joints[i / 3] = joints[i];
            corners[i % 3].weights[i / 3] = 0.5f;
        }
        for (const Influences& corner : corners) {
            mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
            mesh.positions.emplace_back(0);
            mesh.influences.push_back(corner);
        }
    }
    return mesh;
}

PartitionPlan planOf(const Mesh& mesh, const PaletteHardware& hardware, const PartitionSolver& solver,
                     const GroupOrder& order = kGiven) {
    const auto plan = partitionMesh(mesh, hardware, solver, order);
    if (!plan) FAIL(plan.error().text);
    const auto right = checkPartition(mesh, *plan);
    if (!right) FAIL(right.error().text);
    return *plan;
}

Joints jointsOf(const std::vector<JointGroup>& groups, const std::vector<uint32_t>& pass) {
    Joints joints;
    for (uint32_t group : pass) {
        Joints both;
        std::ranges::set_union(joints, groups[group].joints, std::back_inserter(both));
        joints = both;
    }
    return joints;
}

// The solver as its description says: every position is tried on the whole sequence.
GroupPasses insertPlainly(const std::vector<JointGroup>& groups, const PaletteHardware& hardware) {
    GroupPasses passes;
    for (uint32_t group = 0; group < groups.size(); ++group) {
        std::vector<GroupPasses> candidates;
        for (size_t p = 0; p < passes.size(); ++p) {
            candidates.push_back(passes);
            candidates.back()[p].push_back(group);
            if (jointsOf(groups, candidates.back()[p]).size() > hardware.slots) candidates.pop_back();
        }
        for (size_t p = passes.size() + 1; p-- > 0;) {
            candidates.push_back(passes);
            candidates.back().insert(candidates.back().begin() + static_cast<std::ptrdiff_t>(p), {group});
        }
        passes = *std::ranges::min_element(
            candidates, {}, [&](const GroupPasses& candidate) { return estimatedCost(groups, candidate, hardware); });
    }
    return passes;
}

// The fewest uploads for passes in this order, over everything that the slots could hold; joints are below 8.
uint64_t fewestUploads(const std::vector<uint32_t>& passes, int slots) {
    std::vector<uint64_t> least(256, UINT64_MAX);
    least[0] = 0;
    for (uint32_t pass : passes) {
        std::vector<uint64_t> next(256, UINT64_MAX);
        for (uint32_t before = 0; before < 256; ++before)
            for (uint32_t after = 0; least[before] != UINT64_MAX && after < 256; ++after)
                if ((after & pass) == pass && (after & ~(before | pass)) == 0 && std::popcount(after) <= slots)
                    next[after] = std::min(next[after], least[before] + std::popcount(pass & ~before));
        least = next;
    }
    return std::ranges::min(least);
}

std::vector<Joints> randomSets(std::mt19937& random, size_t count, uint32_t joints, uint32_t most) {
    std::vector<Joints> sets(count);
    for (Joints& set : sets) {
        const uint32_t size = random() % (most + 1), near = random() % joints;
        // Neighbours, as on a skeleton, with a joint from anywhere now and then.
        while (set.size() < size) {
            const uint32_t joint = random() % 5 ? near + random() % (most + 2) : random();
            set.push_back(static_cast<uint16_t>(joint % joints));
        }
    }
    return sets;
}

}  // namespace

TEST_CASE("hardware, orders and solvers are found by name") {
    for (const PaletteHardware& row : paletteHardware()) CHECK(findPaletteHardware(row.name) == &row);
    for (const GroupOrder& row : groupOrders()) CHECK(findGroupOrder(row.name) == &row);
    for (const PartitionSolver& row : partitionSolvers()) CHECK(findPartitionSolver(row.name) == &row);
    CHECK(findPaletteHardware("abacus") == nullptr);
    CHECK(findGroupOrder("random") == nullptr);
    CHECK(findPartitionSolver("exact") == nullptr);
}

TEST_CASE("triangles with the same joints form a group") {
    Mesh mesh = meshOf({{7, 3}, {1, 2, 3, 4}, {3, 7}, {}, {4, 3, 2, 1}, {7, 3, 7}});
    // Places of weight 0 and kNoJoint do not count, whatever stands beside them.
    mesh.influences[0].joints[5] = 9;
    mesh.influences[1].weights[7] = 0.25f;
    const std::vector<JointGroup> groups = groupByJoints(mesh);
    REQUIRE(groups.size() == 3);
    CHECK(groups[0].joints == Joints{3, 7});
    CHECK(groups[0].triangles == std::vector<uint32_t>{0, 2, 5});
    CHECK(groups[1].joints == Joints{1, 2, 3, 4});
    CHECK(groups[1].triangles == std::vector<uint32_t>{1, 4});
    CHECK(groups[2].joints.empty());
    CHECK(groups[2].triangles == std::vector<uint32_t>{3});
}

TEST_CASE("orders of groups") {
    auto ordered = [](const char* order) {
        std::vector<JointGroup> groups = groupByJoints(meshOf({{5}, {2, 9}, {1, 2, 3}, {2, 4}, {1}}));
        findGroupOrder(order)->sort(groups);
        std::vector<uint32_t> numbers;
        for (const JointGroup& group : groups) numbers.push_back(group.triangles[0]);
        return numbers;
    };
    CHECK(ordered("given") == std::vector<uint32_t>{0, 1, 2, 3, 4});
    CHECK(ordered("size") == std::vector<uint32_t>{2, 1, 3, 0, 4});
    CHECK(ordered("lexicographic") == std::vector<uint32_t>{4, 2, 3, 1, 0});
}

TEST_CASE("eight slots and three partitions of five joints: load five, then one, then five") {
    // The first two share four joints and lie in one palette of six; with the third it would be eleven.
    const std::vector<Joints> sets = {{0, 1, 2, 3, 4}, {1, 2, 3, 4, 5}, {6, 7, 8, 9, 10}};
    const std::vector<uint64_t> uploads = {5, 5 + 1, 5 + 1 + 5};
    const std::vector<uint32_t> passes = {1, 1, 2};
    const PaletteHardware& console = *findPaletteHardware("console");
    REQUIRE(console.slots == 8);
    for (const PartitionSolver& solver : partitionSolvers()) {
        INFO(solver.name);
        for (size_t count = 1; count <= 3; ++count) {
            const Mesh mesh = meshOf({sets.begin(), sets.begin() + static_cast<std::ptrdiff_t>(count)});
            const PartitionPlan plan = planOf(mesh, console, solver);
            CHECK(plan.groups == count);
            CHECK(plan.uploads == uploads[count - 1]);
            CHECK(plan.passes == passes[count - 1]);
            CHECK(planCost(plan, console) ==
                  uploads[count - 1] * console.uploadCost + uint64_t{passes[count - 1]} * console.passCost);
        }
    }
    // The two empty slots go first, then those of the joints that are not needed again.
    const PartitionPlan plan = planOf(meshOf(sets), console, kSimple);
    const std::vector<PartitionCommand> wanted = {
        {{{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}}, 0, 2},
        {{{6, 6}, {7, 7}, {0, 8}, {1, 9}, {2, 10}}, 2, 1},
    };
    CHECK(plan.commands == wanted);
    CHECK(plan.triangles == std::vector<uint32_t>{0, 1, 2});
    CHECK(slotsAfter(plan, 0) == Joints{0, 1, 2, 3, 4, 5, kNoJoint, kNoJoint});
    CHECK(slotsAfter(plan, 1) == Joints{8, 9, 10, 3, 4, 5, 6, 7});
}

TEST_CASE("a joint that stays in its slot is not loaded again") {
    // Three slots: 2 is freed for 3, because 0 and 1 come back; then 3 for 4.
    const Mesh mesh = meshOf({{0, 1, 2}, {3}, {0, 1, 4}});
    const PartitionPlan plan = planOf(mesh, generic(3), kSimple);
    const std::vector<PartitionCommand> wanted = {{{{0, 0}, {1, 1}, {2, 2}}, 0, 1}, {{{2, 3}}, 1, 1}, {{{2, 4}}, 2, 1}};
    CHECK(plan.commands == wanted);
    CHECK(plan.uploads == 5);
    // The estimate knows only the pass before: 3, 1 and 3 uploads.
    const std::vector<JointGroup> groups = groupByJoints(mesh);
    CHECK(estimatedCost(groups, {{0}, {1}, {2}}, generic(3)) == 7 + 3 * 8);
    CHECK(planCost(plan, generic(3)) == 5 + 3 * 8);
}

TEST_CASE("the slot whose joint is needed again last is freed first") {
    // For 3 and 4 go 2 (never needed again) and 1 (in the last pass), not 0 (in the next).
    const PartitionPlan plan = planOf(meshOf({{0, 1, 2}, {3, 4}, {0, 5, 6}, {1, 7, 8}}), generic(3), kSimple);
    const std::vector<PartitionCommand> wanted = {{{{0, 0}, {1, 1}, {2, 2}}, 0, 1},
                                                  {{{2, 3}, {1, 4}}, 1, 1},
                                                  {{{1, 5}, {2, 6}}, 2, 1},
                                                  {{{0, 1}, {1, 7}, {2, 8}}, 3, 1}};
    CHECK(plan.commands == wanted);
}

TEST_CASE("cheapest insertion joins passes that have room and opens passes beside their like") {
    // 1 2 3 shares two joints with 0 1 2: one upload more beside it, three at the end. 6 costs nothing where it is
    // used.
    const Mesh mesh = meshOf({{0, 1, 2}, {5, 6, 7}, {1, 2, 3}, {6}});
    const std::vector<JointGroup> groups = groupByJoints(mesh);
    CHECK(kInsertion.solve(groups, generic(3)) == GroupPasses{{0}, {2}, {1, 3}});
    CHECK(kSimple.solve(groups, generic(3)) == GroupPasses{{0}, {1}, {2}, {3}});
    const PartitionPlan plan = planOf(mesh, generic(3), kInsertion);
    CHECK(plan.uploads == 3 + 1 + 3);
    CHECK(plan.triangles == std::vector<uint32_t>{0, 2, 1, 3});
    CHECK(plan.commands[2].triangleCount == 2);
    CHECK(planOf(mesh, generic(3), kSimple).uploads == 3 + 3 + 3 + 1);
    // In a wide palette everything is one pass.
    for (const PartitionSolver& solver : partitionSolvers()) {
        const PartitionPlan wide = planOf(mesh, generic(7), solver);
        CHECK(wide.passes == 1);
        CHECK(wide.uploads == 7);
    }
}

TEST_CASE("cheapest insertion finds what trying every position finds") {
    std::mt19937 random(7);
    size_t opened = 0, better = 0;
    for (int round = 0; round < 400; ++round) {
        const uint32_t joints = round % 4 == 0 ? 200 : 6 + random() % 30, most = 1 + random() % 6;
        std::vector<JointGroup> groups = groupByJoints(meshOf(randomSets(random, 1 + random() % 24, joints, most)));
        const PaletteHardware hardware = generic(most + random() % 6, std::array{0u, 1u, 8u}[random() % 3]);
        for (const GroupOrder& order : groupOrders()) {
            INFO("round " << round << ", " << order.name << ", " << hardware.slots << " slots");
            order.sort(groups);
            const GroupPasses passes = kInsertion.solve(groups, hardware);
            const GroupPasses plain = insertPlainly(groups, hardware);
            CHECK(passes == plain);
            const uint64_t cost = estimatedCost(groups, passes, hardware);
            CHECK(cost == estimatedCost(groups, plain, hardware));
            opened += passes.size() > 1;
            better += cost < estimatedCost(groups, kSimple.solve(groups, hardware), hardware);
        }
    }
    CHECK(opened > 600);
    CHECK(better > 300);
}

TEST_CASE("plans of random meshes are right and load as little as their order of passes allows") {
    std::mt19937 random(11);
    size_t belowEstimate = 0;
    for (int round = 0; round < 60; ++round) {
        const uint32_t most = 1 + random() % 4;
        const Mesh mesh = meshOf(randomSets(random, 1 + random() % 40, 8, most));
        const PaletteHardware hardware = generic(most + random() % 4);
        for (const PartitionSolver& solver : partitionSolvers()) {
            INFO("round " << round << ", " << solver.name);
            const PartitionPlan plan = planOf(mesh, hardware, solver);
            CHECK(plan.triangles.size() == mesh.indices.size() / 3);
            const std::vector<JointGroup> groups = groupByJoints(mesh);
            const GroupPasses passes = solver.solve(groups, hardware);
            std::vector<uint32_t> masks;
            for (const auto& pass : passes) {
                masks.push_back(0);
                for (uint16_t joint : jointsOf(groups, pass)) masks.back() |= 1u << joint;
            }
            CHECK(plan.uploads == fewestUploads(masks, static_cast<int>(hardware.slots)));
            CHECK(planCost(plan, hardware) <= estimatedCost(groups, passes, hardware));
            belowEstimate += planCost(plan, hardware) < estimatedCost(groups, passes, hardware);
        }
    }
    CHECK(belowEstimate > 0);
}

TEST_CASE("slotsAfter follows the loads") {
    std::mt19937 random(3);
    const Mesh mesh = meshOf(randomSets(random, 60, 40, 5));
    const PartitionPlan plan = planOf(mesh, generic(6), kInsertion);
    REQUIRE(plan.passes > 3);
    Joints slots(6, kNoJoint);
    for (size_t c = 0; c < plan.commands.size(); ++c) {
        for (const SlotLoad& load : plan.commands[c].loads) {
            CHECK(slots.at(load.slot) != load.joint);
            slots[load.slot] = load.joint;
        }
        CHECK(slotsAfter(plan, c) == slots);
    }
}

TEST_CASE("a mesh without triangles or without joints has a plan") {
    CHECK(planOf(meshOf({}), generic(4), kSimple).commands.empty());
    for (const PartitionSolver& solver : partitionSolvers()) {
        const PartitionPlan plan = planOf(meshOf({{}, {}}), generic(4), solver);
        CHECK(plan.passes == 1);
        CHECK(plan.uploads == 0);
        CHECK(plan.commands[0].triangleCount == 2);
    }
}

TEST_CASE("a triangle that does not fit is one clear error") {
    const Mesh mesh = meshOf({{0}, {1, 2, 3}, {4, 5, 6, 7}});
    for (const PartitionSolver& solver : partitionSolvers())
        for (const GroupOrder& order : groupOrders()) {
            const auto plan = partitionMesh(mesh, generic(3), solver, order);
            REQUIRE(!plan);
            CHECK(plan.error().fault == Fault::input);
            CHECK_THAT(plan.error().text,
                       ContainsSubstring("triangle 2 needs 4 joints at once, but a draw has 3 palette slots"));
            CHECK_THAT(plan.error().text, ContainsSubstring("--influences"));
        }
    const auto rigid = partitionMesh(mesh, *findPaletteHardware("rigid"), kSimple, kGiven);
    REQUIRE(!rigid);
    CHECK_THAT(rigid.error().text, ContainsSubstring("a draw has 1 palette slot;"));
}

TEST_CASE("rigid hardware draws a robot joint by joint") {
    auto stored = makeBuiltin("robot", 5000);
    REQUIRE(stored);
    auto scene = prepareScene(std::move(*stored), {});
    REQUIRE(scene);
    for (const PartitionSolver& solver : partitionSolvers()) {
        const PartitionPlan plan = planOf(scene->mesh, *findPaletteHardware("rigid"), solver);
        CHECK(plan.groups > 20);
        CHECK(plan.passes == plan.groups);
        CHECK(plan.uploads == plan.groups);
        for (const PartitionCommand& command : plan.commands) CHECK(command.loads.size() == 1);
    }
}

TEST_CASE("plans of the built-in scenes and of the shared models") {
    std::vector<std::string> names = modelFiles();
    for (const BuiltinScene& row : builtinScenes()) names.push_back("builtin:" + std::string(row.name) + ":8000");
    size_t fitting = 0, unfit = 0;
    for (const std::string& name : names) {
        auto stored = loadScene(name);
        if (!stored) continue;
        INFO(name);
        auto scene = prepareScene(std::move(*stored), {.influences = 8});
        REQUIRE(scene);
        const std::vector<JointGroup> groups = groupByJoints(scene->mesh);
        size_t most = 0;
        for (const JointGroup& group : groups) most = std::max(most, group.joints.size());
        for (uint32_t slots : {4u, 20u, 28u, 80u})
            for (const PartitionSolver& solver : partitionSolvers()) {
                INFO(solver.name << ", " << slots << " slots, " << most << " joints in a triangle");
                const auto plan = partitionMesh(scene->mesh, generic(slots), solver, kGiven);
                REQUIRE(plan.has_value() == (most <= slots));
                (plan ? fitting : unfit)++;
                if (!plan) continue;
                const auto right = checkPartition(scene->mesh, *plan);
                if (!right) FAIL(right.error().text);
                CHECK(plan->groups == groups.size());
                if (slots == 28) CHECK(partitionMesh(scene->mesh, generic(slots), solver, kGiven).value() == *plan);
            }
    }
    CHECK(fitting >= 18);
    CHECK(unfit >= 2);
}

TEST_CASE("the check of a plan refuses each kind of damage") {
    const Mesh mesh = meshOf({{0, 1, 2}, {5, 6, 7}, {1, 2, 3}, {6}});
    const PartitionPlan good = planOf(mesh, generic(3), kSimple);
    REQUIRE(good.commands.size() == 4);
    auto refused = [&](const char* why, auto damage) {
        PartitionPlan bad = good;
        damage(bad);
        const auto checked = checkPartition(mesh, bad);
        INFO(why);
        REQUIRE(!checked);
        CHECK_THAT(checked.error().text, ContainsSubstring(why));
    };
    refused("command 0: loads slot 3 of 3", [](PartitionPlan& p) { p.commands[0].loads[0].slot = 3; });
    refused("command 0: loads slot 0 twice", [](PartitionPlan& p) { p.commands[0].loads[1].slot = 0; });
    refused("command 0: loads no joint into slot 0", [](PartitionPlan& p) { p.commands[0].loads[0].joint = kNoJoint; });
    refused("triangle 0 needs joint 0, which is in no slot",
            [](PartitionPlan& p) { p.commands[0].loads[0].joint = 4; });
    refused("command 1: triangle 1 needs joint 5", [](PartitionPlan& p) { p.commands[1].loads.clear(); });
    refused("command 1: draws nothing", [](PartitionPlan& p) { p.commands[1].triangleCount = 0; });
    refused("command 1: does not begin", [](PartitionPlan& p) { p.commands[1].firstTriangle = 0; });
    refused("command 0: does not begin", [](PartitionPlan& p) { p.commands.erase(p.commands.begin()); });
    refused("command 3: reaches past the end", [](PartitionPlan& p) { ++p.commands[3].triangleCount; });
    refused("command 2: triangle 4 does not exist", [](PartitionPlan& p) { p.triangles[2] = 4; });
    refused("command 1: triangle 0 is drawn a second time", [](PartitionPlan& p) { p.triangles[1] = 0; });
    refused("exactly once", [](PartitionPlan& p) { p.commands.pop_back(); });
    refused("exactly once", [](PartitionPlan& p) {
        p.commands.pop_back();
        p.triangles.pop_back();
    });
    refused("the plan counts 11 uploads and 4 passes, but its commands make 10 and 4",
            [](PartitionPlan& p) { ++p.uploads; });
    refused("counts 10 uploads and 5 passes", [](PartitionPlan& p) { ++p.passes; });
}
