#include "apps/apps.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "common/frame/host_gpus.h"
#include "common/measure/device_state.h"

namespace skinbench {
namespace {

struct ApiRow {
    Api api;
    Result<std::vector<DeviceCaps>> (*list)();
    Result<std::unique_ptr<Backend>> (*open)(const BackendOptions& options);
};

const std::vector<ApiRow>& apiRows() {
    static const std::vector<ApiRow> rows = {
        {.api = Api::vulkan, .list = listVulkanDevices, .open = openVulkan},
        {.api = Api::opengl, .list = listGlDevices, .open = openGl},
    };
    return rows;
}

// NVIDIA's management library knows the addresses of UUIDs.
void addPciAddresses(std::vector<ApiDevices>& apis) {
    auto isBare = [](const DeviceCaps& caps) { return !caps.uuid.empty() && caps.pci.empty() && !caps.software; };
    if (std::ranges::none_of(apis, [&](const ApiDevices& api) { return std::ranges::any_of(api.devices, isBare); }))
        return;
    const std::vector<DeviceState> states = readDeviceStates();
    for (ApiDevices& api : apis)
        for (DeviceCaps& caps : api.devices)
            if (const auto state = std::ranges::find(states, caps.uuid, &DeviceState::uuid);
                isBare(caps) && state != states.end())
                caps.pci = state->pci;
}

Machine listMachine() {
    std::vector<ApiDevices> apis;
    for (const ApiRow& row : apiRows()) {
        auto devices = row.list();
        apis.push_back(
            {row.api, devices ? std::move(*devices) : std::vector<DeviceCaps>(), devices ? "" : devices.error().text});
    }
    addPciAddresses(apis);
    Environment environment;
    for (const std::string& name : visibilityVariables())
        if (const char* value = std::getenv(name.c_str())) environment[name] = value;
    return makeMachine(std::move(apis), environment);
}

bool needs(const std::vector<const Route*>& routes, Api api) {
    return std::ranges::any_of(routes, [&](const Route* route) { return route->api == api; });
}

void sayOnce(const std::vector<std::string>& notes) {
    static bool said = false;
    if (std::exchange(said, true)) return;
    for (const std::string& note : notes) say(note);
}

// `device`: what pickDevice() gave.
Result<std::unique_ptr<Backend>> openOn(const Result<size_t>& device, const ApiRow& row, bool validation,
                                        Devices& devices) {
    const auto api = std::ranges::find(thisMachine().apis, row.api, &ApiDevices::api);
    if (!api->missing.empty()) return deviceError(api->missing);
    SKINBENCH_TRY(device);
    auto entry = entryOf(thisMachine(), *device, row.api);
    SKINBENCH_TRY(entry);
    auto backend = row.open({.device = entry->number, .validation = validation});
    if (backend && !entry->note.empty()) devices.notes.push_back(entry->note);
    return backend;
}

}  // namespace

const Machine& thisMachine() {
    static const Machine machine = listMachine();
    return machine;
}

const std::vector<std::string>& machineNotes() {
    static const std::vector<std::string> notes = [] {
        std::vector<std::string> all = thisMachine().notes;
        const char* environment = std::getenv("SKINBENCH_ENVIRONMENT");
        const bool inRoot = environment && std::string(environment) == "debian13-root";
        const std::string unused = unusedText(unusedGpus(listHostGpus(), thisMachine()), inRoot);
        if (!unused.empty()) all.push_back(unused);
        return all;
    }();
    return notes;
}

Result<Devices> openDevices(const std::vector<const Route*>& needed, const std::string& wanted, bool validation) {
    Devices devices;
    std::vector<Api> apis;
    for (const ApiRow& row : apiRows())
        if (needs(needed, row.api)) apis.push_back(row.api);
    if (apis.empty()) return devices;
    const auto device = pickDevice(thisMachine(), wanted, apis);
    if (!device && !wanted.empty()) return std::unexpected(device.error());
    sayOnce(machineNotes());
    std::string missing;
    for (const ApiRow& row : apiRows()) {
        if (!needs(needed, row.api)) continue;
        auto backend = openOn(device, row, validation, devices);
        if (!backend) {
            devices.byApi[row.api].missing = backend.error().text;
            missing += (missing.empty() ? "" : "; ") + backend.error().text;
            continue;
        }
        devices.byApi[row.api].backend = backend->get();
        devices.caps.push_back(capsOf(thisMachine(), *device, (*backend)->caps()));
        devices.anyHardware = devices.anyHardware || !(*backend)->caps().software;
        devices.owned.push_back(std::move(*backend));
    }
    for (const std::string& note : devices.notes) warn(note);
    if (!wanted.empty() && devices.owned.empty()) return deviceError(missing);
    return devices;
}

std::vector<DeviceCaps> capsOfDevice(size_t device) {
    std::vector<DeviceCaps> all;
    for (const ApiDevices& api : thisMachine().apis)
        if (const auto entry = entryOf(thisMachine(), device, api.api))
            all.push_back(capsOf(thisMachine(), device, api.devices[entry->number]));
    return all;
}

const std::vector<RouteWish>& routeWishes() {
    static const std::vector<RouteWish> rows = {
        {"vk-ext", "mesh", "Vulkan with the cross-vendor mesh-shader extension"},
        {"vk-nv", "mesh", "Vulkan with NVIDIA's mesh-shader extension"},
        {"gl-ext", "mesh", "OpenGL with the cross-vendor mesh-shader extension; no Vulkan device has mesh shaders"},
        {"gl-nv", "mesh", "OpenGL with NVIDIA's mesh-shader extension; no Vulkan device has mesh shaders"},
        {"vk", "compute", "no device has mesh shaders, so a Vulkan compute pass skins"},
        {"gl", "compute", "no Vulkan device and no mesh shaders, so an OpenGL compute pass skins"},
        {"vk", "vertex", "no mesh shaders and no compute pass, so the vertex stage skins"},
        {"gl", "vertex", "no mesh shaders and no compute pass, so the vertex stage skins"},
    };
    return rows;
}

Case caseOf(const RouteWish& wish) {
    Case c;
    c.codec = findCodec("uc");
    c.route = findRoute(wish.route);
    c.variant = findVariant(wish.variant);
    return c;
}

Choice chooseRoute(const std::vector<DeviceCaps>& devices) {
    for (bool software : {false, true})
        for (const RouteWish& wish : routeWishes()) {
            const Case c = caseOf(wish);
            for (const DeviceCaps& caps : devices)
                if (caps.api == c.route->api && caps.software == software && !unsupported(c, caps))
                    return {
                        c.route, c.variant,
                        caps.name + ": " + wish.reason + (software ? " (a software driver; no GPU was found)" : "")};
        }
    return {findRoute("cpu"), findVariant("cpu"), "neither Vulkan nor OpenGL has a device here, so the CPU skins"};
}

Result<Choice> chooseRouteOf(std::string& device) {
    std::vector<Api> apis;
    for (const ApiRow& row : apiRows()) apis.push_back(row.api);
    const auto number = pickDevice(thisMachine(), device, apis);
    if (!number && !device.empty()) return std::unexpected(number.error());
    if (!number) return chooseRoute({});
    device = std::to_string(*number);
    return chooseRoute(capsOfDevice(*number));
}

}  // namespace skinbench
