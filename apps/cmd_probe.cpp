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
    std::vector<DeviceCaps> devices;
    std::vector<std::string> missing;  // per API that has none, why
};

Result<Probe> probe(const std::string& wanted) {
    Probe found;
    std::string notFound;
    for (Api api : graphicsApis()) {
        auto devices = listDevices(api);
        if (!devices || devices->empty()) {
            found.missing.push_back(devices ? std::string(namesOf(api).name) + ": no device" : devices.error().text);
            continue;
        }
        if (wanted.empty()) {
            found.devices.insert(found.devices.end(), devices->begin(), devices->end());
        } else if (auto number = pickDevice(*devices, wanted)) {
            found.devices.push_back((*devices)[*number]);
        } else {
            notFound += (notFound.empty() ? "" : "; ") + std::string(namesOf(api).name) + ": " + number.error().text;
        }
    }
    if (!wanted.empty() && found.devices.empty()) return deviceError(notFound.empty() ? "no device" : notFound);
    return found;
}

void printLimits(const char* name, const MeshLimitsOfDevice& limits) {
    if (!limits.available) return;
    std::cout << std::format("    {}: {} vertices, {} triangles, {} invocations a work group\n", name,
                             limits.maxVertices, limits.maxTriangles, limits.maxGroupSize);
}

void printDevice(const DeviceCaps& caps) {
    std::cout << std::format("{}: {}{}\n    {}, {}\n", namesOf(caps.api).name, terminalText(caps.name),
                             caps.software ? " (software driver)" : "", terminalText(caps.version),
                             terminalText(caps.driver));
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

}  // namespace

int runProbe(const ProbeOptions& options) {
    auto found = probe(options.device);
    if (!found) return reportError(found.error());
    const Choice choice = chooseRoute(found->devices);
    if (options.json) {
        Json devices = Json::array();
        for (const DeviceCaps& caps : found->devices) {
            Json device = capsJson(caps);
            device["routes"] = routesJson(caps);
            device["extensions"] = caps.extensions;
            devices.push_back(device);
        }
        const Json chosen = {
            {"route", choice.route->name}, {"variant", choice.variant->name}, {"reason", choice.reason}};
        std::cout << dumpJson(Json{{"schema", "skinbench-probe/1"},
                                   {"devices", devices},
                                   {"missing", found->missing},
                                   {"auto", chosen}})
                  << "\n";
        return kExitDone;
    }
    for (const DeviceCaps& caps : found->devices) printDevice(caps);
    for (const std::string& missing : found->missing) std::cout << terminalText(missing) << "\n";
    std::cout << "auto: " << choice.route->name << "/" << choice.variant->name << ": " << terminalText(choice.reason)
              << "\n";
    return kExitDone;
}

}  // namespace skinbench
