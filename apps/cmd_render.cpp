#include <algorithm>
#include <cmath>
#include <filesystem>
#include <format>
#include <utility>

#include "apps/picture_thread.h"
#include "apps/selectors.h"
#include "common/core/file.h"
#include "common/frame/animation.h"

namespace skinbench {
namespace {

constexpr size_t kMostPictures = 8;
constexpr int kQuality = 80;  // of WebP

// The variant that a route draws where none is named.
const char* usualVariant(const Route* route) {
    if (route && route->api == Api::cpu) return "cpu";
    return route && route->dialect != MeshDialect::none ? "mesh" : "vertex";
}

// Where a variant that is named without a route is drawn: on the route of `auto`, or on one of its API that has it, or
// on the other API; on one that the device draws it on, if there is one.
const Route& routeFor(const Variant& variant, const Choice& choice, const std::vector<DeviceCaps>& devices) {
    std::vector<const Route*> suiting;
    for (const Route& route : routes())
        if (route.api != Api::cpu && runsOn(variant, route)) suiting.push_back(&route);
    if (suiting.empty()) return *choice.route;
    std::ranges::stable_sort(suiting, {}, [&](const Route* route) {
        return route == choice.route ? 0 : route->api == choice.route->api ? 1 : 2;
    });
    const auto draws = [&](const Route* route) {
        const Case c = caseOf({route->name, variant.name, ""});
        return std::ranges::any_of(
            devices, [&](const DeviceCaps& caps) { return caps.api == route->api && !unsupported(c, caps); });
    };
    const auto drawn = std::ranges::find_if(suiting, draws);
    return drawn == suiting.end() ? *suiting.front() : **drawn;
}

// The words with a route for each variant. The device of route auto stays with the options.
Result<std::vector<AxisWords>> crossingsOf(RenderOptions& options) {
    const AxisWords& words = options.selectors.words;
    const auto named = [&](const char* axis) {
        const auto found = words.find(axis);
        return found == words.end() ? std::vector<std::string>() : found->second;
    };
    std::vector<std::string> routes = named("route"), variants = named("variant");
    std::vector<AxisWords> crossings;
    const auto cross = [&](const std::string& route, const std::vector<std::string>& on) {
        crossings.push_back(words);
        crossings.back()["route"] = {route};
        crossings.back()["variant"] = on;
        crossings.back()["raster"] = presetRasters(options.selectors);
    };
    if (!routes.empty() && routes != std::vector<std::string>{"auto"}) {
        for (const std::string& route : routes)
            cross(route, variants.empty() ? std::vector<std::string>{usualVariant(findRoute(route))} : variants);
        return crossings;
    }
    std::string& device = options.selectors.device;
    const auto choice = chooseRouteOf(device);
    SKINBENCH_TRY(choice);
    const std::string reason = std::string("route ") + choice->route->name + ": " + choice->reason;
    if (variants.empty()) variants = {choice->variant->name};
    const auto caps = device.empty() ? std::vector<DeviceCaps>() : capsOfDevice(std::stoul(device));
    bool said = false;
    for (const std::string& word : variants) {
        const Variant* const variant = findVariant(word);
        const bool usual = !variant || (choice->route->api == Api::cpu && variant == choice->variant);
        const Route& route = usual ? *choice->route : routeFor(*variant, *choice, caps);
        if (&route != choice->route)
            say(std::format("route {}: {} does not run on {}", route.name, word, choice->route->name));
        else if (!std::exchange(said, true))
            say(reason);
        cross(route.name, {word});
    }
    return crossings;
}

// Those that the words cross. What was named and is in none of them is one line with its reason.
Result<std::vector<Case>> crossedPictures(RenderOptions& options) {
    AxisWords all = options.selectors.words;
    const auto chosen = namesAuto(all["route"]);
    SKINBENCH_TRY(chosen);
    if (*chosen) all["route"].clear();
    SKINBENCH_TRY(crossCases(all));  // what is wrong about a word comes before any other line
    const auto crossings = crossingsOf(options);
    SKINBENCH_TRY(crossings);
    for (const char* axis : {"route", "variant"}) {
        all[axis].clear();
        for (const AxisWords& words : *crossings)
            for (const std::string& word : words.at(axis))
                if (!std::ranges::contains(all[axis], word)) all[axis].push_back(word);
    }
    auto cases = crossedOnce(*crossings);
    SKINBENCH_TRY(cases);
    for (const Unused& unused : unusedWords(all, *cases)) {
        std::string words;
        for (const std::string& word : unused.words) words += (words.empty() ? "" : ",") + word;
        warn(std::format("{} {} is not drawn: {}", unused.option, words, unused.reason));
    }
    // Both ways of fetching draw one picture; only who names them sees it twice.
    if (all["vertex_fetch"].empty())
        std::erase_if(*cases, [](const Case& c) { return c.fetch == VertexFetch::pull && c.codec->feedsAttributes; });
    return cases;
}

Result<std::vector<Case>> chosenCases(RenderOptions& options) {
    Case scratch;
    if (!options.view.empty()) SKINBENCH_TRY(findAxis("view")->set(scratch, options.view));
    auto cases = options.selectors.caseIds.empty() ? crossedPictures(options) : selectedCases(options.selectors);
    SKINBENCH_TRY(cases);
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

// A file has all pictures side by side.
Result<void> checkFits(const RenderOptions& options, const Wanted& wanted) {
    const uint64_t pictures = wanted.cases.size() + options.difference;
    const uint64_t width = pictures * wanted.settings.width, height = wanted.settings.height;
    const bool webp = options.animate && options.out.ends_with(".webp");
    const auto fits = webp ? checkWebpSize(width, height) : checkPngSize(width, height);
    return fits ? fits : errorAt(options.out, fits.error());
}

Result<Wanted> wantedPictures(RenderOptions& options) {
    if (options.selectors.copies == 0) options.selectors.copies = 1;
    auto settings = workloadSettings(options.selectors, false);
    SKINBENCH_TRY(settings);
    auto cases = chosenCases(options);
    SKINBENCH_TRY(cases);
    if (options.difference && cases->size() != 2)
        return inputError(std::format("--difference compares two cases, not {}", cases->size()));
    settings->yaw = settings->copies == 1 ? options.yaw : 0;
    Wanted wanted{std::move(*cases), std::move(*settings)};
    SKINBENCH_TRY(checkFits(options, wanted));
    return wanted;
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

std::string framePath(const std::string& folder, uint32_t frame) { return std::format("{}/{:04}.png", folder, frame); }

// Frames of an earlier, longer clip would look like this one's.
Result<void> checkFolder(const std::string& folder, uint32_t frames) {
    uint32_t older = 0;
    std::string first;
    std::error_code failed;
    for (uint32_t frame = frames; frame < kMostFrames; ++frame) {
        if (!std::filesystem::exists(framePath(folder, frame), failed)) continue;
        if (older++ == 0) first = std::filesystem::path(framePath(folder, frame)).filename();
    }
    if (older == 0) return {};
    const std::string what = older == 1 ? "a frame" : std::format("{} frames", older);
    return inputError(std::format(
        "{}: {} of another clip would stay behind this one's, from {} on; remove {}, or name another folder", folder,
        what, first, older == 1 ? "it" : "them"));
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
            SKINBENCH_TRY(savePng(*image, framePath(options.out, frame)));
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
        const std::string output = file ? options.out : framePath(options.out, 0);
        if (auto possible = checkOutput(output, {&options.selectors.scene, 1}); !possible)
            return reportError(possible.error());
        if (auto alone = file ? Result<void>() : checkFolder(options.out, options.animate); !alone)
            return reportError(alone.error());
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
