// What the controls and the keys make of the cases.
#include <algorithm>
#include <format>

#include "apps/command_line.h"
#include "apps/view/state.h"
#include "common/cases/choices.h"

namespace skinbench::view {

std::vector<const Axis*> controlsOf(const Case& c) {
    std::vector<const Axis*> controls;
    for (const Axis& axis : axes())
        if (axis.applies(c)) controls.push_back(&axis);
    return controls;
}

Result<Case> chosen(const Case& c, const Axis& axis, const std::string& word) {
    return withValue(c, axis, joinsWords(c, axis) ? toggledWord(axis, axis.get(c), word) : word);
}

void choose(ViewState& state, const Axis& axis, const std::string& word) {
    Case &own = state.cases[state.active], &other = state.cases[1 - state.active];
    const auto then = chosen(own, axis, word);
    if (!then) return;
    // The same value, where the other one has such a thing.
    if (state.linked && axis.name != "route" && axis.applies(other))
        if (const auto same = withValue(other, axis, axis.get(*then)); same && axis.get(*same) == axis.get(*then))
            other = *same;
    own = *then;
}

std::string linkText(const ViewState& state) {
    const auto& [a, b] = state.cases;
    if (!state.linked || !a.route || !b.route) return {};
    std::string differing;
    for (const Axis& axis : axes())
        if (axis.name != "route" && axis.applies(a) && axis.applies(b) && axis.get(a) != axis.get(b))
            differing +=
                std::format("{}{} ({}, {})", differing.empty() ? "" : ", ", axis.name, axis.get(a), axis.get(b));
    if (differing.empty()) return {};
    std::string why;
    for (const auto& [own, other] : {std::pair(&a, &b), {&b, &a}})
        if (!runsOn(*own->variant, *other->route))
            why += std::format("{}{} has no {}", why.empty() ? ": " : ", ", other->route->name, own->variant->name);
    return "linked, but A and B differ in " + differing + why;
}

void chooseNext(ViewState& state, const Backends& backends, std::string_view name, int step) {
    const Axis& axis = *findAxis(name);
    const Case& c = state.cases[state.active];
    if (!axis.applies(c)) return;
    const auto count = static_cast<int>(axis.words.size());
    auto place = static_cast<int>(std::ranges::find(axis.words, axis.get(c)) - axis.words.begin());
    for (int i = 1; i < count; ++i) {
        place = (place + step + count) % count;
        const std::string& word = axis.words[static_cast<size_t>(place)];
        const auto then = withValue(c, axis, word);
        if (then && !reasonAgainst(*then, backends)) return choose(state, axis, word);
    }
}

void chooseCases(ViewState& state, const Backends& backends) {
    auto& [a, b] = state.cases;
    for (const RouteWish& wish : routeWishes()) {
        if (a.route) break;
        if (const Case c = completed(caseOf(wish)); !reasonAgainst(c, backends)) a = c;
    }
    if (!a.route) a = completed(caseOf(routeWishes().front()));
    // All of A's options that the other route has: with A's variant, with another one; at last the route's usual case.
    for (int attempt = 0; attempt < 3; ++attempt)
        for (const RouteWish& wish : routeWishes()) {
            if (b.route) return;
            Case c = attempt < 2 ? a : caseOf(wish);
            c.route = findRoute(wish.route);
            c = completed(c);
            const bool suits = c.route->api != a.route->api && (attempt > 0 || c.variant == a.variant);
            if (suits && !reasonAgainst(c, backends)) b = c;
        }
    if (!b.route) b = a;
}

PictureRequest requestOf(const ViewState& state, uint64_t number, uint32_t width, uint32_t height) {
    WorkloadSettings settings;
    settings.clip = state.clip;
    settings.seconds = static_cast<float>(state.seconds);
    settings.copies = state.copies;
    settings.width = width;
    settings.height = height;
    settings.yaw = state.copies == 1 ? kUsualYaw : 0;
    settings.move = state.camera;
    settings.overview = state.overview;
    const uint32_t amplify = state.mode == Mode::difference ? state.amplify : 0;
    return {number, state.scene, {state.cases[0], state.cases[1]}, settings, state.background, amplify, false, {}};
}

std::string benchCommand(const ViewState& state) {
    std::string text = "skinbench bench " + shellWord(state.scene), first;
    for (Case c : state.cases) {
        c.view = View::shaded;
        const std::string id = caseId(c);
        if (id != first) text += " --case " + shellWord(id);
        first = id;
    }
    text += std::format(" --copies {} --pose {}", state.copies, state.playing ? "animated" : "frozen");
    if (!state.clip.empty()) text += " --clip " + shellWord(state.clip);
    return text + std::format(" --time {:g}", state.seconds);
}

}  // namespace skinbench::view
