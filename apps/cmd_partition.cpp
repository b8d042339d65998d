#include <chrono>
#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/selectors.h"
#include "common/core/text.h"
#include "common/meshlets/partition.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

// What the words of the command line stand for.
struct Request {
    PaletteHardware hardware;
    const PartitionSolver* solver = nullptr;
    const GroupOrder* order = nullptr;
};

Result<Request> lookUp(const PartitionOptions& options) {
    auto hardware = chosenRows(paletteHardware(), {options.hardware}, "hardware");
    SKINBENCH_TRY(hardware);
    auto solver = chosenRows(partitionSolvers(), {options.solver}, "solver");
    SKINBENCH_TRY(solver);
    auto order = chosenRows(groupOrders(), {options.order}, "order");
    SKINBENCH_TRY(order);
    Request request{*hardware->front(), solver->front(), order->front()};
    if (options.slots > 0) {
        if (options.hardware != "generic")
            return inputError(std::format("--slots is for hardware generic; {} has {}", request.hardware.name,
                                          request.hardware.slots));
        request.hardware.slots = options.slots;
    }
    return request;
}

struct Partitioned {
    Scene scene;
    PartitionPlan plan;
    double milliseconds = 0;
};

Result<Partitioned> partition(const PartitionOptions& options, const Request& request) {
    auto scene = loadScene(options.scene).and_then([&](Scene stored) {
        return prepareScene(std::move(stored), {.influences = options.influences});
    });
    SKINBENCH_TRY(scene);
    for (const std::string& warning : scene->warnings) warn(scene->name + ": " + warning);
    const auto start = std::chrono::steady_clock::now();
    auto plan = partitionMesh(scene->mesh, request.hardware, *request.solver, *request.order);
    const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
    if (!plan)
        return inputError(scene->name + ": " + plan.error().text +
                          " or hardware with more slots (--hardware, --slots)");
    const auto right = checkPartition(scene->mesh, *plan);
    SKINBENCH_ASSERT(right);
    return Partitioned{std::move(*scene), std::move(*plan), taken.count()};
}

Json commandsJson(const PartitionPlan& plan) {
    Json commands = Json::array();
    for (const PartitionCommand& command : plan.commands) {
        Json loads = Json::array();
        for (const SlotLoad& load : command.loads) loads.push_back({{"slot", load.slot}, {"joint", load.joint}});
        commands.push_back(
            {{"loads", loads}, {"first_triangle", command.firstTriangle}, {"triangle_count", command.triangleCount}});
    }
    return commands;
}

Json partitionJson(const PartitionOptions& options, const Request& request, const Partitioned& done) {
    const PaletteHardware& hardware = request.hardware;
    return {{"schema", "skinbench-partition/1"},
            {"scene", done.scene.name},
            {"influences", options.influences},
            {"hardware",
             {{"name", hardware.name},
              {"slots", hardware.slots},
              {"upload_cost", hardware.uploadCost},
              {"pass_cost", hardware.passCost}}},
            {"solver", request.solver->name},
            {"order", request.order->name},
            {"groups", done.plan.groups},
            {"passes", done.plan.passes},
            {"uploads", done.plan.uploads},
            {"cost", planCost(done.plan, hardware)},
            {"milliseconds", done.milliseconds},
            {"commands", commandsJson(done.plan)},
            {"triangles", done.plan.triangles}};
}

void printPartition(const PartitionOptions& options, const Request& request, const Partitioned& done) {
    const PaletteHardware& hardware = request.hardware;
    const PartitionPlan& plan = done.plan;
    auto row = [](const char* name, const std::string& value) { std::cout << std::format("{:<10}{}\n", name, value); };
    row("scene", std::format("{}, {}, {}, {} influences", terminalText(done.scene.name),
                             counted(plan.triangles.size(), "triangle"),
                             counted(done.scene.skeleton.joints.size(), "joint"), options.influences));
    row("hardware", std::format("{}, {}; an upload costs {}, a pass {}", hardware.name, counted(hardware.slots, "slot"),
                                hardware.uploadCost, hardware.passCost));
    row("solver", std::format("{}, order {}", request.solver->name, request.order->name));
    row("groups", std::format("{}", plan.groups));
    row("commands", std::format("{}", plan.commands.size()));
    row("uploads", std::format("{}", plan.uploads));
    row("passes", std::format("{}", plan.passes));
    row("cost", std::format("{}", planCost(plan, hardware)));
    row("time", std::format("{:.1f} ms", done.milliseconds));
    std::cout << "\ncommand  loads  triangles\n";
    for (size_t c = 0; c < plan.commands.size(); ++c)
        std::cout << std::format("{:>7}  {:>5}  {:>9}\n", c, plan.commands[c].loads.size(),
                                 plan.commands[c].triangleCount);
}

}  // namespace

int runPartition(const PartitionOptions& options) {
    auto request = lookUp(options);
    if (!request) return reportError(request.error());
    auto done = partition(options, *request);
    if (!done) return reportError(done.error());
    if (options.json)
        std::cout << dumpJson(partitionJson(options, *request, *done)) << "\n";
    else
        printPartition(options, *request, *done);
    return kExitDone;
}

}  // namespace skinbench
