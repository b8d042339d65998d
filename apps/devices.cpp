#include <algorithm>

#include "apps/apps.h"

namespace skinbench {

struct ApiRow {
    Api api;
    Result<std::vector<DeviceCaps>> (*list)();
    Result<std::unique_ptr<Backend>> (*open)(const BackendOptions& options);
};

static const std::vector<ApiRow>& apiRows() {
    static const std::vector<ApiRow> rows = {
        {.api = Api::vulkan, .list = listVulkanDevices, .open = openVulkan},
        {.api = Api::opengl, .list = listGlDevices, .open = openGl},
    };
    return rows;
}

static const ApiRow& rowOf(Api api) {
    const auto row = std::ranges::find(apiRows(), api, &ApiRow::api);
    SKINBENCH_ASSERT(row != apiRows().end());
    return *row;
}

std::vector<Api> graphicsApis() {
    std::vector<Api> apis;
    for (const ApiRow& row : apiRows()) apis.push_back(row.api);
    return apis;
}

Result<std::vector<DeviceCaps>> listDevices(Api api) { return rowOf(api).list(); }

Result<Devices> openDevices(const std::vector<const Route*>& needed, const BackendOptions& options) {
    Devices devices;
    std::string missing;
    bool named = false;
    for (Api api : graphicsApis()) {
        if (std::ranges::none_of(needed, [&](const Route* route) { return route->api == api; })) continue;
        named = true;
        auto backend = rowOf(api).open(options);
        if (!backend) {
            devices.byApi[api].missing = backend.error().text;
            missing += (missing.empty() ? "" : "; ") + backend.error().text;
            continue;
        }
        devices.byApi[api].backend = backend->get();
        devices.caps.push_back((*backend)->caps());
        devices.anyHardware = devices.anyHardware || !(*backend)->caps().software;
        devices.owned.push_back(std::move(*backend));
    }
    if (named && !options.device.empty() && devices.owned.empty()) return deviceError(missing);
    return devices;
}

Choice chooseRoute(const std::vector<DeviceCaps>& devices) {
    struct Wish {
        const char* route;
        const char* variant;
        const char* reason;
    };
    const Wish wishes[] = {
        {"vk-ext", "mesh", "Vulkan with the cross-vendor mesh-shader extension"},
        {"vk-nv", "mesh", "Vulkan with NVIDIA's mesh-shader extension"},
        {"gl-ext", "mesh", "OpenGL with the cross-vendor mesh-shader extension; no Vulkan device has mesh shaders"},
        {"gl-nv", "mesh", "OpenGL with NVIDIA's mesh-shader extension; no Vulkan device has mesh shaders"},
        {"vk", "compute", "no device has mesh shaders, so a Vulkan compute pass skins"},
        {"gl", "compute", "no Vulkan device and no mesh shaders, so an OpenGL compute pass skins"},
        {"vk", "vertex", "no mesh shaders and no compute pass, so the vertex stage skins"},
        {"gl", "vertex", "no mesh shaders and no compute pass, so the vertex stage skins"},
    };
    for (bool software : {false, true})
        for (const Wish& wish : wishes) {
            Case c;
            c.codec = findCodec("uc");
            c.route = findRoute(wish.route);
            c.variant = findVariant(wish.variant);
            for (const DeviceCaps& caps : devices)
                if (caps.api == c.route->api && caps.software == software && !unsupported(c, caps))
                    return {
                        c.route, c.variant,
                        caps.name + ": " + wish.reason + (software ? " (a software driver; no GPU was found)" : "")};
        }
    return {findRoute("cpu"), findVariant("cpu"), "neither Vulkan nor OpenGL has a device here, so the CPU skins"};
}

}  // namespace skinbench
