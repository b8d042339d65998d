#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/text.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

// Every variant of every route of the device's API: yes, or why not.
Json routesJson(const DeviceCaps& caps) {
    Json rows = Json::array();
    for (const Route& route : routes()) {
        if (route.api != caps.api) continue;
        for (const Variant& variant : variants()) {
            if (!runsOn(variant, route)) continue;
            Case c;
            c.codec = findCodec("uc");
            c.route = &route;
            c.variant = &variant;
            const auto reason = unsupported(c, caps);
            rows.push_back({{"route", route.name},
                            {"variant", variant.name},
                            {"supported", !reason},
                            {"reason", reason ? Json(*reason) : Json(nullptr)}});
        }
    }
    return rows;
}

struct Probe {
    std::vector<size_t> devices;
    std::vector<std::string> missing;  // per API that has none of them, why
    std::string device;                // the one that `auto` is about; empty: none
    Choice choice;
};

Result<Probe> probe(const std::string& given) {
    const Machine& machine = thisMachine();
    const std::string wanted = given == "all" ? "" : given;
    Probe found{.device = wanted};
    auto choice = chooseRouteOf(found.device);
    SKINBENCH_TRY(choice);
    found.choice = std::move(*choice);
    if (wanted.empty())
        for (size_t i = 0; i < machine.devices.size(); ++i) found.devices.push_back(i);
    else
        found.devices = {std::stoul(found.device)};
    for (const ApiDevices& api : machine.apis) {
        if (api.devices.empty()) {
            found.missing.push_back(api.missing);
        } else if (!wanted.empty()) {
            const auto entry = entryOf(machine, found.devices.front(), api.api);
            if (!entry) found.missing.push_back(entry.error().text);
        }
    }
    return found;
}

std::vector<std::string> notesOf(const Probe& found) {
    std::vector<std::string> notes = machineNotes();
    for (size_t device : found.devices)
        for (const auto& [api, number] : thisMachine().devices[device].perhaps)
            notes.push_back(entryOf(thisMachine(), device, api)->note);
    return notes;
}

// The caps of a device on the APIs that surely have it.
std::vector<DeviceCaps> entriesOf(size_t device) {
    std::vector<DeviceCaps> all;
    for (const DeviceCaps& caps : capsOfDevice(device))
        if (thisMachine().devices[device].entries.contains(caps.api)) all.push_back(caps);
    return all;
}

Json wishesJson() {
    Json rows = Json::array();
    for (const RouteWish& wish : routeWishes())
        rows.push_back({{"route", wish.route}, {"variant", wish.variant}, {"reason", wish.reason}});
    return rows;
}

Json probeJson(const Probe& found, const Json& measured) {
    Json devices = Json::array();
    for (size_t number : found.devices)
        for (const DeviceCaps& caps : entriesOf(number)) {
            const std::string& hiddenBy = thisMachine().devices[number].hiddenBy;
            Json device = capsJson(caps);
            device["hidden_by"] = hiddenBy.empty() ? Json(nullptr) : Json(hiddenBy);
            device["routes"] = routesJson(caps);
            device["extensions"] = caps.extensions;
            devices.push_back(device);
        }
    return {{"schema", "skinbench-probe/1"},
            {"devices", devices},
            {"missing", found.missing},
            {"notes", notesOf(found)},
            {"auto",
             {{"route", found.choice.route->name},
              {"variant", found.choice.variant->name},
              {"reason", found.choice.reason},
              {"rule", wishesJson()}}},
            {"measured", measured}};
}

void printLimits(const char* name, const MeshLimitsOfDevice& limits) {
    if (!limits.available) return;
    std::cout << std::format("    {}: {} vertices, {} triangles, {} invocations a work group\n", name,
                             limits.maxVertices, limits.maxTriangles, limits.maxGroupSize);
}

void printEntry(const DeviceCaps& caps) {
    std::cout << std::format("  {}: {}\n    {}, {}\n", namesOf(caps.api).name, terminalText(caps.name),
                             terminalText(caps.version), terminalText(caps.driver));
    std::cout << std::format(
        "    timestamps: {} bits of {:g} ns; subgroup: {}; storage buffer: {} MiB; memory: {} MiB\n",
        caps.timestampBits, caps.timestampPeriodNs, caps.subgroupSize ? std::to_string(caps.subgroupSize) : "unknown",
        caps.maxStorageBytes >> 20, caps.deviceBytes >> 20);
    const char* prefix = namesOf(caps.api).prefix;
    printLimits(std::format("{}_EXT_mesh_shader", prefix).c_str(), caps.ext);
    printLimits(std::format("{}_NV_mesh_shader", prefix).c_str(), caps.nv);
    for (const Json& row : routesJson(caps))
        std::cout << std::format("    {:<7} {:<8} {}\n", row["route"].get<std::string>(),
                                 row["variant"].get<std::string>(),
                                 row["supported"] ? "yes" : "no: " + terminalText(row["reason"].get<std::string>()));
}

void printDevice(size_t number) {
    const PhysicalDevice& device = thisMachine().devices[number];
    std::string line = describeDevice(thisMachine(), number);
    if (device.software) line += " (software driver)";
    if (!device.hiddenBy.empty()) line += ", hidden by " + device.hiddenBy;
    std::cout << terminalText(line) << "\n";
    for (const DeviceCaps& caps : entriesOf(number)) printEntry(caps);
}

void printText(const Probe& found, const Json& measured) {
    for (size_t number : found.devices) printDevice(number);
    for (const std::string& missing : found.missing) std::cout << terminalText(missing, kLongestMessage) << "\n";
    for (const std::string& note : notesOf(found)) std::cout << terminalText(note, kLongestMessage) << "\n";
    const Choice& choice = found.choice;
    const bool several = found.devices.size() > 1 && !found.device.empty();
    std::cout << "auto: " << (several ? "device " + found.device + ", " : "") << choice.route->name << "/"
              << choice.variant->name << ": " << terminalText(choice.reason) << "\n";
    std::string wishes;
    for (const RouteWish& wish : routeWishes())
        wishes += std::format("{}{}/{}", wishes.empty() ? "" : ", ", wish.route, wish.variant);
    std::cout << "rule of auto: the first that runs of " << wishes << "; mesh shaders skin and draw in one pass, "
              << "compute passes skin every vertex once, and nothing is measured: --measure does\n";
    if (!measured.is_null()) std::cout << measuredText(measured);
}

}  // namespace

int runProbe(const ProbeOptions& options) {
    auto found = probe(options.device);
    if (!found) return reportError(found.error());
    Json measured;
    int status = kExitDone;
    if (options.measure) {
        auto answer = measureChoices(options.scene, found->device, found->choice);
        if (!answer) return reportError(answer.error());
        measured = std::move(*answer);
        if (measured["fastest"].is_null())
            status = reportError(
                {Fault::device, interrupted() ? "interrupted before a case was done" : "no route could be timed"});
        else if (interrupted())
            say("interrupted; what was measured until then is printed");
        for (const Json& row : measured["cases"])
            if (row["failed"] == true && status == kExitDone)
                status = reportError(
                    {Fault::device, row["id"].get<std::string>() + " failed: " + row["reason"].get<std::string>()});
    }
    if (options.json)
        std::cout << dumpJson(probeJson(*found, measured)) << "\n";
    else
        printText(*found, measured);
    return std::max(status, flushOutput());
}

}  // namespace skinbench
