#include "apps/apps.h"
#include "common/core/file.h"
#include "common/frame/image.h"

namespace skinbench {
namespace {

// What a view needs of a case beyond what the route needs.
Result<void> checkView(const Case& c) {
    if (c.view == View::meshlets && !c.builder)
        return inputError(std::string("view meshlets needs a mesh route, not ") + c.route->name);
    if (c.view == View::velocity && !c.compute.previous)
        return inputError("view velocity needs --variant compute --compute previous");
    if (c.view == View::velocity) return {};
    if (c.view != View::shaded && !c.builder && !c.variant->fetches)
        return inputError(std::string("view ") + findAxis("view")->get(c) +
                          " needs a variant that reads the codec's vertices " + "where it draws: vertex or mesh");
    return {};
}

Result<Case> chosenCase(const RenderOptions& options) {
    Case scratch;
    if (!options.view.empty()) SKINBENCH_TRY(findAxis("view")->set(scratch, options.view));
    Selectors selectors = options.selectors;
    AxisWords& words = selectors.words;
    std::string route = options.route;
    if (selectors.caseIds.empty() && route == "auto") {
        std::vector<DeviceCaps> all;
        for (Api api : graphicsApis())
            if (auto devices = listDevices(api)) all.insert(all.end(), devices->begin(), devices->end());
        const Choice choice = chooseRoute(all);
        route = choice.route->name;
        if (words["variant"].empty()) words["variant"] = {choice.variant->name};
        say(std::string("route ") + choice.route->name + ": " + choice.reason);
    }
    if (selectors.caseIds.empty()) {
        words["route"] = {route};
        const Route* const row = findRoute(route);
        if (words["variant"].empty())
            words["variant"] = {row && row->dialect != MeshDialect::none ? "mesh"
                                : row && row->api == Api::cpu            ? "cpu"
                                                                         : "vertex"};
    }
    auto cases = selectedCases(selectors);
    SKINBENCH_TRY(cases);
    Case c = cases->front();
    if (options.view.empty()) return c;
    SKINBENCH_TRY(findAxis("view")->set(c, options.view));
    return c;
}

Result<Image> render(RenderOptions options) {
    if (options.selectors.copies == 0) options.selectors.copies = 1;
    auto settings = workloadSettings(options.selectors, false);
    SKINBENCH_TRY(settings);
    auto chosen = chosenCase(options);
    SKINBENCH_TRY(chosen);
    const Case& c = *chosen;
    if (c.route->api == Api::cpu) return deviceError("route cpu draws nothing; name another with --route");
    SKINBENCH_TRY(checkView(c));

    settings->yaw = settings->copies == 1 ? options.yaw : 0;
    auto devices = openDevices({c.route}, {options.selectors.device, options.selectors.validation});
    SKINBENCH_TRY(devices);
    const OpenBackend& open = devices->byApi[c.route->api];
    if (!open.backend) return deviceError(open.missing);
    auto workload = openWorkload(options.selectors.scene, *settings);
    SKINBENCH_TRY(workload);
    if (const std::string outside = viewWarning(*workload, c.influences); !outside.empty()) warn(outside);
    return renderImage(*workload, c, *open.backend);
}

}  // namespace

int runRender(const RenderOptions& options) {
    if (auto right = checkSuffix(options.out, ".png"); !right) return reportError(right.error());
    if (auto possible = checkOutput(options.out, {&options.selectors.scene, 1}); !possible)
        return reportError(possible.error());
    auto image = render(options);
    auto saved = image ? savePng(*image, options.out) : std::unexpected(image.error());
    return saved ? kExitDone : reportError(saved.error());
}

}  // namespace skinbench
