#include <algorithm>
#include <cmath>
#include <format>

#include "apps/picture_thread.h"
#include "common/core/file.h"
#include "common/frame/animation.h"

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

struct Wanted {
    std::vector<Case> cases;
    WorkloadSettings settings;
};

Result<Wanted> wantedPictures(RenderOptions& options) {
    if (options.selectors.copies == 0) options.selectors.copies = 1;
    auto settings = workloadSettings(options.selectors, false);
    SKINBENCH_TRY(settings);
    auto cases = chosenCases(options);
    SKINBENCH_TRY(cases);
    if (options.difference && cases->size() != 2)
        return inputError(std::format("--difference compares two cases, not {}", cases->size()));
    settings->yaw = settings->copies == 1 ? options.yaw : 0;
    return Wanted{std::move(*cases), std::move(*settings)};
}

// What is wrong about a picture that was verified, and what its colours mean.
void sayFindings(const std::string& id, const std::string& fault, const std::vector<LegendRow>& legend) {
    if (!fault.empty()) warn(std::format("{} is drawn, and is not right: {}", id, fault));
    for (const LegendRow& row : legend) say(std::format("{:<10}  {}", row.name, row.text));
}

constexpr uint32_t kAmplified = 16;

Result<Image> render(RenderOptions options) {
    const auto wanted = wantedPictures(options);
    SKINBENCH_TRY(wanted);
    std::vector<const Route*> needed;
    for (const Case& c : wanted->cases) needed.push_back(c.route);
    auto devices = openDevices(needed, options.selectors.device, options.selectors.validation);
    SKINBENCH_TRY(devices);
    auto workload = openWorkload(options.selectors.scene, wanted->settings);
    SKINBENCH_TRY(workload);
    const auto seen = inView(*workload, wanted->cases.front().influences);
    SKINBENCH_TRY(seen);
    if (const auto outside = viewWarning(*workload, *seen); !outside.empty()) warn(outside);
    std::vector<Image> images;
    for (const Case& c : wanted->cases) {
        if (wanted->cases.size() > 1) say(std::format("picture {}: {}", images.size() + 1, caseId(c)));
        const OpenBackend& open = devices->byApi[c.route->api];
        if (!open.backend) return deviceError(open.missing);
        auto picture = renderPicture(*workload, c, *open.backend);
        SKINBENCH_TRY(picture);
        const bool culled = c.view == View::culled && picture->culling;
        sayFindings(caseId(c), picture->fault, culled ? legendOf(c, *picture->culling) : std::vector<LegendRow>());
        images.push_back(std::move(picture->image));
    }
    if (options.difference) images.push_back(differenceImage(images[0], images[1], kAmplified).image);
    return sideBySide(images);
}

Result<Image> imageOf(const Pictures& drawn) {
    if (drawn.error) return std::unexpected(*drawn.error);
    if (!drawn.warning.empty()) warn(drawn.warning);
    std::vector<Image> images;
    for (const CasePicture& picture : drawn.all) {
        if (picture.error) return std::unexpected(*picture.error);
        if (drawn.request.accuracy) sayFindings(picture.id, picture.fault, picture.legend);
        images.push_back(picture.image);
    }
    return sideBySide(images);
}

// The clip in so many frames, its beginning behind its end: a WebP file, or a folder of PNG files. The first moment is
// verified as a single picture is.
Result<void> renderAnimation(RenderOptions options) {
    const auto wanted = wantedPictures(options);
    SKINBENCH_TRY(wanted);
    const std::string& scene = options.selectors.scene;
    PictureThread thread(
        {.device = options.selectors.device, .validation = options.selectors.validation, .every = true});
    PictureRequest request{.scene = scene, .cases = wanted->cases, .settings = wanted->settings};
    request.amplify = options.difference ? kAmplified : 0;
    const bool file = options.out.ends_with(".webp");
    std::unique_ptr<Animation> animation;
    double step = 0;
    for (uint32_t frame = 0, posted = 0; frame < options.animate; ++frame) {
        // The first answer says how long the clip is; then the thread always has a moment to begin.
        const auto ahead = static_cast<uint32_t>(frame == 0 ? 1 : frame + kFramesInFlight + 1);
        for (; posted < std::min(ahead, options.animate); ++posted) {
            request.settings.seconds = static_cast<float>(options.selectors.seconds + posted * step);
            request.accuracy = posted == 0;
            thread.post(request);
        }
        const std::shared_ptr<const Pictures> drawn = thread.take();
        const auto image = imageOf(*drawn);
        SKINBENCH_TRY(image);
        if (frame == 0) step = (drawn->duration > 0 ? drawn->duration : options.animate / 60.0) / options.animate;
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
