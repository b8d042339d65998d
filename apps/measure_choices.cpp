// `probe --measure`: what `auto` chooses from, verified and timed for some seconds.
#include <algorithm>
#include <format>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

// Seconds after which no more rounds begin; more of them do not make a software driver's times mean more.
constexpr double kSecondsOfHardware = 5, kSecondsOfSoftware = 1;

// The cases of each route and variant that auto may choose and that the device runs.
Result<std::vector<Case>> candidatesOf(const std::vector<DeviceCaps>& devices) {
    std::vector<Case> cases;
    for (const RouteWish& wish : routeWishes()) {
        auto crossed = crossCases({{"route", {wish.route}}, {"variant", {wish.variant}}});
        SKINBENCH_TRY(crossed);
        for (const Case& c : *crossed)
            if (std::ranges::any_of(
                    devices, [&](const DeviceCaps& caps) { return caps.api == c.route->api && !unsupported(c, caps); }))
                cases.push_back(c);
    }
    if (cases.empty()) return deviceError("no device runs any route, so there is nothing to measure");
    return cases;
}

Json rowOf(const CaseResult& result) {
    const bool timed = isTimed(result);
    const Interval interval = timed ? result.figures->interval : Interval{};
    return {{"id", result.id},
            {"route", result.theCase.route->name},
            {"variant", result.theCase.variant->name},
            {"median_ms", timed ? Json(result.figures->total.median) : Json(nullptr)},
            {"interval", timed ? Json::array({interval.low, interval.high}) : Json(nullptr)},
            {"failed", result.status == CaseStatus::failed},
            {"reason", timed ? Json(nullptr) : Json(result.reason)}};
}

}  // namespace

Result<Json> measureChoices(const std::string& scene, const std::string& device, const Choice& choice) {
    if (device.empty()) return deviceError("there is no device to measure");
    auto cases = candidatesOf(capsOfDevice(std::stoul(device)));
    SKINBENCH_TRY(cases);
    std::vector<const Route*> needed;
    for (const Case& c : *cases) needed.push_back(c.route);
    Selectors selectors;
    selectors.scene = scene;
    auto devices = openDevices(needed, device, false);
    SKINBENCH_TRY(devices);
    selectors.timeLimit = devices->anyHardware ? kSecondsOfHardware : kSecondsOfSoftware;
    auto settings = workloadSettings(selectors, devices->anyHardware);
    SKINBENCH_TRY(settings);
    auto workload = openWorkload(scene, *settings);
    SKINBENCH_TRY(workload);
    auto prepared = sceneFor(*workload, cases->front().influences);
    SKINBENCH_TRY(prepared);
    SKINBENCH_TRY(checkSkinned(**prepared));
    BenchSettings bench = benchSettings(selectors, devices->anyHardware);
    bench.limits = false;
    catchInterrupts();
    RunContext context;
    auto results = runBench(*workload, *cases, devices->byApi, bench, consoleEvents(context));
    SKINBENCH_TRY(results);

    std::ranges::stable_sort(*results, {}, [](const CaseResult& result) {
        return isTimed(result) ? result.figures->total.median : std::numeric_limits<double>::infinity();
    });
    Json rows = Json::array();
    Json ofRule = nullptr;
    for (const CaseResult& result : *results) {
        rows.push_back(rowOf(result));
        if (ofRule.is_null() && result.theCase.route == choice.route && result.theCase.variant == choice.variant)
            ofRule = result.id;
    }
    const bool any = !results->empty() && isTimed(results->front());
    return Json{{"scene", (*prepared)->name},
                {"copies", settings->copies},
                {"software", !devices->anyHardware},
                {"fastest", any ? Json(results->front().id) : Json(nullptr)},
                {"rule", ofRule},
                {"cases", rows}};
}

std::string measuredText(const Json& measured) {
    std::string text = std::format("measured: {}, {}, milliseconds a frame, median and its 95 % interval\n",
                                   terminalText(measured["scene"].get<std::string>()),
                                   counted(measured["copies"].get<uint32_t>(), "copy", "copies"));
    const Json *fastest = nullptr, *ofRule = nullptr;
    for (const Json& row : measured["cases"]) {
        const std::string id = row["id"];
        if (row["median_ms"].is_null()) {
            text += std::format("    {:<44} {}\n", id, terminalText(row["reason"].get<std::string>(), 200));
            continue;
        }
        if (!fastest) fastest = &row;
        if (row["id"] == measured["rule"]) ofRule = &row;
        text += std::format("    {:<44} {:>9.3f}  {:.3f} to {:.3f}\n", id, row["median_ms"].get<double>(),
                            row["interval"][0].get<double>(), row["interval"][1].get<double>());
    }
    if (!fastest) return text;
    text += "fastest: " + (*fastest)["id"].get<std::string>();
    if (ofRule == fastest) {
        text += ", which auto takes";
    } else if (ofRule) {
        const double ratio = (*ofRule)["median_ms"].get<double>() / (*fastest)["median_ms"].get<double>();
        const bool apart = (*fastest)["interval"][1].get<double>() < (*ofRule)["interval"][0].get<double>();
        text += std::format("; {}, which auto takes, lasts {:.2f} times as long{}", (*ofRule)["id"].get<std::string>(),
                            ratio, apart ? "" : " (their intervals overlap)");
    }
    return text + (measured["software"] ? "; a software driver's times do not say how fast a GPU is\n" : "\n");
}

}  // namespace skinbench
