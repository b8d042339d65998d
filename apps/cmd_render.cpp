#include <iostream>

#include "apps/apps.h"
#include "common/frame/image.h"

namespace skinbench {
namespace {

Result<View> parseView(const std::string& word) {
    for (View view : {View::shaded, View::meshlets, View::weights, View::tuples, View::velocity, View::resolution})
        if (word == viewName(view)) return view;
    return inputError("no view '" + word + "'; there is shaded, meshlets, weights, tuples, velocity, resolution");
}

// What a view needs of a case beyond what the route needs.
Result<void> checkView(const Case& which) {
    if (which.view == View::meshlets && !which.builder)
        return inputError(std::string("view meshlets needs a mesh route, not ") + which.route->name);
    if (which.view == View::velocity && !which.compute.previous)
        return inputError("view velocity needs --variant compute --compute previous");
    if (which.view == View::velocity) return {};
    if (which.view != View::shaded && !which.builder && !which.variant->fetches)
        return inputError(std::string("view ") + viewName(which.view) +
                          " needs a variant that reads the codec's vertices " + "where it draws: vertex or mesh");
    return {};
}

Result<Image> render(RenderOptions options) {
    auto view = parseView(options.view);
    if (!view) return std::unexpected(view.error());
    if (options.selectors.copies == 0) options.selectors.copies = 1;
    auto settings = workloadSettings(options.selectors, false);
    if (!settings) return std::unexpected(settings.error());
    if (options.route == "auto") {
        std::vector<DeviceCaps> all;
        for (Api api : graphicsApis())
            if (auto devices = listDevices(api)) all.insert(all.end(), devices->begin(), devices->end());
        const Choice choice = chooseRoute(all);
        options.route = choice.route->name;
        if (options.variant.empty()) options.variant = choice.variant->name;
        std::cerr << "skinbench: route " << choice.route->name << ": " << choice.reason << "\n";
    }
    const Route* route = findRoute(options.route);
    if (route && route->api == Api::cpu) return deviceError("route cpu draws nothing; name another with --route");
    if (options.variant.empty()) options.variant = route && route->dialect != MeshDialect::none ? "mesh" : "vertex";
    options.selectors.routes = {options.route};
    options.selectors.variants = {options.variant};
    options.selectors.codecs = {options.codec};
    const Codec* codec = findCodec(options.codec);
    if (options.selectors.fetches.empty())
        options.selectors.fetches = {codec && !feedsAttributes(*codec) ? "pull" : "attributes"};
    auto cases = crossCases(options.selectors);
    if (!cases) return std::unexpected(cases.error());
    Case which = cases->front();
    which.view = *view;
    if (auto fits = checkView(which); !fits) return std::unexpected(fits.error());

    settings->yaw = settings->copies == 1 ? options.yaw : 0;
    auto devices = openDevices({route}, {options.selectors.device, options.selectors.validation});
    if (!devices) return std::unexpected(devices.error());
    const OpenBackend& open = devices->byApi[route->api];
    if (!open.backend) return deviceError(open.missing);
    auto workload = openWorkload(options.selectors.scene, *settings);
    if (!workload) return std::unexpected(workload.error());
    return renderImage(*workload, which, *open.backend);
}

}  // namespace

int runRender(const RenderOptions& options) {
    auto image = render(options);
    auto saved = image ? savePng(*image, options.out) : std::unexpected(image.error());
    return saved ? kExitDone : reportError(saved.error());
}

}  // namespace skinbench
