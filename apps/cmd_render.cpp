#include <algorithm>
#include <format>

#include "apps/apps.h"
#include "common/core/file.h"
#include "common/frame/image.h"

namespace skinbench {
namespace {

constexpr size_t kMostPictures = 8;

// Those that the words cross, in the order of ids. The device of route auto stays with the options.
Result<std::vector<Case>> chosenCases(RenderOptions& options) {
    Case scratch;
    if (!options.view.empty()) SKINBENCH_TRY(findAxis("view")->set(scratch, options.view));
    Selectors selectors = options.selectors;
    AxisWords& words = selectors.words;
    std::string route = options.route;
    if (selectors.caseIds.empty() && route == "auto") {
        const auto choice = chooseRouteOf(options.selectors.device);
        SKINBENCH_TRY(choice);
        route = choice->route->name;
        if (words["variant"].empty()) words["variant"] = {choice->variant->name};
        // A variant that was named leads to the first route that has it.
        const Variant* const named = findVariant(words["variant"].front());
        const auto carries = [&](const Route& row) { return named && runsOn(*named, row) && row.api != Api::cpu; };
        if (const auto first = std::ranges::find_if(routes(), carries);
            first != routes().end() && !runsOn(*named, *choice->route)) {
            route = first->name;
            say(std::format("route {}: {} does not run on {}", route, named->name, choice->route->name));
        } else {
            say(std::string("route ") + choice->route->name + ": " + choice->reason);
        }
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
    // Both ways of fetching draw one picture; only who names them sees it twice.
    if (selectors.caseIds.empty() && words["vertex_fetch"].empty())
        std::erase_if(*cases, [](const Case& c) { return c.fetch == VertexFetch::pull && c.codec->feedsAttributes; });
    if (cases->size() > kMostPictures)
        return inputError(std::format("{} cases are more pictures than one file takes side by side ({}); name fewer",
                                      cases->size(), kMostPictures));
    for (Case& c : *cases) {
        if (!options.view.empty()) SKINBENCH_TRY(findAxis("view")->set(c, options.view));
        if (c.route->api == Api::cpu) return deviceError("route cpu draws nothing; name another with --route");
        SKINBENCH_TRY(checkView(c));
    }
    return cases;
}

Result<Image> render(RenderOptions options) {
    if (options.selectors.copies == 0) options.selectors.copies = 1;
    auto settings = workloadSettings(options.selectors, false);
    SKINBENCH_TRY(settings);
    auto cases = chosenCases(options);
    SKINBENCH_TRY(cases);
    std::vector<const Route*> needed;
    for (const Case& c : *cases) needed.push_back(c.route);

    settings->yaw = settings->copies == 1 ? options.yaw : 0;
    settings->steady = true;
    auto devices = openDevices(needed, options.selectors.device, options.selectors.validation);
    SKINBENCH_TRY(devices);
    auto workload = openWorkload(options.selectors.scene, *settings);
    SKINBENCH_TRY(workload);
    const auto seen = inView(*workload, cases->front().influences);
    SKINBENCH_TRY(seen);
    if (const auto outside = viewWarning(*workload, *seen); !outside.empty()) warn(outside);
    std::vector<Image> images;
    for (const Case& c : *cases) {
        const OpenBackend& open = devices->byApi[c.route->api];
        if (!open.backend) return deviceError(open.missing);
        auto picture = renderPicture(*workload, c, *open.backend);
        SKINBENCH_TRY(picture);
        if (!picture->fault.empty()) warn(std::format("{} is drawn, and is not right: {}", caseId(c), picture->fault));
        images.push_back(std::move(picture->image));
        if (cases->size() > 1) say(std::format("picture {}: {}", images.size(), caseId(c)));
    }
    return sideBySide(images);
}

}  // namespace

int runRender(const RenderOptions& options) {
    if (auto right = checkSuffix(options.out, ".png"); !right) return reportError(right.error());
    if (auto possible = checkOutput(options.out, {&options.selectors.scene, 1}); !possible)
        return reportError(possible.error());
    auto image = render(options);
    auto saved = image ? savePng(*image, options.out) : std::unexpected(image.error());
    if (!saved) return reportError(saved.error());
    say(options.out);
    return kExitDone;
}

}  // namespace skinbench
