#include <algorithm>
#include <cmath>
#include <format>

#include "apps/apps.h"
#include "common/core/file.h"
#include "common/frame/animation.h"
#include "common/frame/image.h"
#include "common/measure/drawing.h"

namespace skinbench {
namespace {

constexpr size_t kMostPictures = 8;
constexpr int kQuality = 80;  // of WebP

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

// What draws pictures of one moment after the other.
struct Drawer {
    Devices devices;
    Workload workload;
    std::vector<Case> cases;
    std::vector<Prepared> ready;  // of an animation
    ~Drawer() {
        for (Prepared& one : ready) releaseCase(one);
    }
};

constexpr uint32_t kAmplified = 16;

Image together(const RenderOptions& options, std::vector<Image> images) {
    if (options.difference) images.push_back(differenceImage(images[0], images[1], kAmplified).image);
    return sideBySide(images);
}

Result<std::unique_ptr<Drawer>> openDrawer(RenderOptions& options) {
    if (options.selectors.copies == 0) options.selectors.copies = 1;
    auto settings = workloadSettings(options.selectors, false);
    SKINBENCH_TRY(settings);
    auto cases = chosenCases(options);
    SKINBENCH_TRY(cases);
    if (options.difference && cases->size() != 2)
        return inputError(std::format("--difference compares two cases, not {}", cases->size()));
    std::vector<const Route*> needed;
    for (const Case& c : *cases) needed.push_back(c.route);

    settings->yaw = settings->copies == 1 ? options.yaw : 0;
    auto devices = openDevices(needed, options.selectors.device, options.selectors.validation);
    SKINBENCH_TRY(devices);
    auto workload = openWorkload(options.selectors.scene, *settings);
    SKINBENCH_TRY(workload);
    const auto seen = inView(*workload, cases->front().influences);
    SKINBENCH_TRY(seen);
    if (const auto outside = viewWarning(*workload, *seen); !outside.empty()) warn(outside);
    return std::make_unique<Drawer>(std::move(*devices), std::move(*workload), std::move(*cases));
}

// A picture as a verifying plan draws it, with what is wrong about it and what its colours mean.
Result<Picture> checkedPicture(Drawer& drawer, const Case& c) {
    const OpenBackend& open = drawer.devices.byApi[c.route->api];
    if (!open.backend) return deviceError(open.missing);
    auto picture = renderPicture(drawer.workload, c, *open.backend);
    SKINBENCH_TRY(picture);
    if (!picture->fault.empty()) warn(std::format("{} is drawn, and is not right: {}", caseId(c), picture->fault));
    if (c.view == View::culled && picture->culling)
        for (const LegendRow& row : legendOf(c, *picture->culling)) say(std::format("{:<10}  {}", row.name, row.text));
    return picture;
}

Result<Image> render(RenderOptions options) {
    auto drawer = openDrawer(options);
    SKINBENCH_TRY(drawer);
    std::vector<Image> images;
    for (const Case& c : (*drawer)->cases) {
        if ((*drawer)->cases.size() > 1) say(std::format("picture {}: {}", images.size() + 1, caseId(c)));
        auto picture = checkedPicture(**drawer, c);
        SKINBENCH_TRY(picture);
        images.push_back(std::move(picture->image));
    }
    return together(options, std::move(images));
}

// The first moment is checked as a picture is; then each case stays on its device.
Result<void> prepareAll(Drawer& drawer) {
    for (const Case& c : drawer.cases) {
        SKINBENCH_TRY(checkedPicture(drawer, c));
        auto planned = planCase(drawer.workload, c, drawer.devices.byApi[c.route->api].backend, false);
        SKINBENCH_TRY(planned);
        auto ready = prepareCase(std::move(*planned));
        SKINBENCH_TRY(ready);
        drawer.ready.push_back(std::move(*ready));
    }
    return {};
}

Result<Image> drawMoment(Drawer& drawer, const RenderOptions& options) {
    std::vector<Image> images;
    for (size_t i = 0; i < drawer.cases.size(); ++i) {
        auto frames = framesOfPose(drawer.workload, drawer.cases[i]);
        SKINBENCH_TRY(frames);
        SKINBENCH_TRY(drawFrames(drawer.ready[i], *frames));
        auto image = drawer.ready[i].backend->readImage(*drawer.ready[i].plan);
        SKINBENCH_TRY(image);
        images.push_back(std::move(*image));
    }
    return together(options, std::move(images));
}

// The clip in so many frames, its beginning behind its end: a WebP file, or a folder of PNG files.
Result<void> renderAnimation(RenderOptions options) {
    auto drawer = openDrawer(options);
    SKINBENCH_TRY(drawer);
    SKINBENCH_TRY(prepareAll(**drawer));
    const Clip* clip = chosenClip((*drawer)->workload);
    const double step = (clip ? clip->duration : options.animate / 60.0) / options.animate;
    const bool file = options.out.ends_with(".webp");
    std::unique_ptr<Animation> animation;
    for (uint32_t frame = 0; frame < options.animate; ++frame) {
        (*drawer)->workload.settings.seconds = static_cast<float>(options.selectors.seconds + frame * step);
        auto image = drawMoment(**drawer, options);
        SKINBENCH_TRY(image);
        if (!file) {
            SKINBENCH_TRY(savePng(*image, std::format("{}/{:04}.png", options.out, frame)));
            continue;
        }
        if (!animation) animation = std::make_unique<Animation>(image->width, image->height, kQuality);
        SKINBENCH_TRY(animation->add(*image, std::max(10, static_cast<int>(std::lround(step * 1000)))));
    }
    return animation ? animation->save(options.out) : Result<void>{};
}

}  // namespace

int runRender(const RenderOptions& options) {
    if (options.animate) {
        const bool file = options.out.ends_with(".webp");
        if (options.out.ends_with(".png"))
            return reportError(
                {Fault::input, options.out + ": --animate writes a .webp file, or PNG files into a folder; name one"});
        if (file && !hasAnimations())
            return reportError(
                {Fault::input, options.out + ": this build cannot write WebP; name a folder for PNG files"});
        const std::string output = file ? options.out : options.out + "/0000.png";
        if (auto possible = checkOutput(output, {&options.selectors.scene, 1}); !possible)
            return reportError(possible.error());
        if (const auto drawn = renderAnimation(options); !drawn) return reportError(drawn.error());
        say(options.out);
        return kExitDone;
    }
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
