// What the controls and the keys make of the cases.
#include <algorithm>
#include <format>

#include "apps/command_line.h"
#include "apps/view/state.h"

namespace skinbench::view {
std::optional<std::string> reasonAgainst(const Case& c, const CapsByApi& devices) {
    if (c.route->api == Api::cpu) return "route cpu draws nothing";
    const auto api = devices.find(c.route->api);
    if (api == devices.end()) return std::format("{} was not looked for", namesOf(c.route->api).name);
    if (!api->second.missing.empty()) return api->second.missing;
    if (auto reason = unsupported(c, api->second.caps)) return reason;
    if (auto possible = checkView(c); !possible) return possible.error().text;
    return std::nullopt;
}

std::vector<Control> controlsOf(const Case& c, const CapsByApi& devices) {
    std::vector<Control> controls;
    for (const Axis& axis : axes()) {
        if (!axis.applies(c)) continue;
        Control control{&axis, axis.get(c), {}, joinsWords(c, axis)};
        for (const std::string& word : axis.words) {
            const auto then = withValue(c, axis, control.joined ? toggledWord(axis, control.value, word) : word);
            if (then) control.choices.push_back({word, *then, reasonAgainst(*then, devices)});
        }
        controls.push_back(std::move(control));
    }
    return controls;
}

void choose(ViewState& state, size_t pane, const Axis& axis, const std::string& word) {
    const Case& c = state.cases[pane];
    const auto then = withValue(c, axis, joinsWords(c, axis) ? toggledWord(axis, axis.get(c), word) : word);
    if (!then) return;
    const bool follows = state.linked && axis.name != "route";
    Case& other = state.cases[1 - pane];
    // The same value, where the other one has such a thing.
    if (follows && axis.applies(other))
        if (const auto same = withValue(other, axis, axis.get(*then)); same && axis.get(*same) == axis.get(*then))
            other = *same;
    state.cases[pane] = *then;
}

void chooseNext(ViewState& state, size_t pane, const CapsByApi& devices, std::string_view name, int step) {
    const Axis& axis = *findAxis(name);
    const Case& c = state.cases[pane];
    if (!axis.applies(c)) return;
    const auto count = static_cast<int>(axis.words.size());
    const auto current = std::ranges::find(axis.words, axis.get(c)) - axis.words.begin();
    for (int i = 1; i < count; ++i) {
        const std::string& word =
            axis.words[static_cast<size_t>((static_cast<int>(current) + (i * step) % count + count) % count)];
        const auto then = withValue(c, axis, word);
        if (then && !reasonAgainst(*then, devices)) return choose(state, pane, axis, word);
    }
}

void chooseCases(ViewState& state, const CapsByApi& devices) {
    const auto caseOf = [](const RouteWish& wish) {
        Case c;
        c.route = findRoute(wish.route);
        c.variant = findVariant(wish.variant);
        c.codec = findCodec("uc");
        return completed(c);
    };
    const auto first = [&](const auto& suits) -> std::optional<Case> {
        for (const RouteWish& wish : routeWishes())
            if (const Case c = caseOf(wish); suits(c) && !reasonAgainst(c, devices)) return c;
        return std::nullopt;
    };
    auto& [a, b] = state.cases;
    if (!a.route) a = first([](const Case&) { return true; }).value_or(caseOf(routeWishes().front()));
    if (b.route) return;
    auto other = first([&](const Case& c) { return c.route->api != a.route->api && c.variant == a.variant; });
    if (!other) other = first([&](const Case& c) { return c.route->api != a.route->api; });
    b = a;
    if (!other) return;
    // All of A's options that the other route has.
    b.route = other->route;
    b = completed(b);
    if (reasonAgainst(b, devices)) b = *other;
}

std::string benchCommand(const ViewState& state) {
    std::string text = "skinbench bench " + shellWord(state.scene);
    for (size_t i = 0; i < 2; ++i)
        if (state.cases[i].route && (i == 0 || caseId(state.cases[1]) != caseId(state.cases[0]))) {
            Case c = state.cases[i];
            c.view = View::shaded;
            text += " --case " + shellWord(caseId(c));
        }
    text += std::format(" --copies {} --pose {}", state.copies, state.playing ? "animated" : "frozen");
    if (!state.clip.empty()) text += " --clip " + shellWord(state.clip);
    return text + std::format(" --time {:g}", state.seconds);
}

}  // namespace skinbench::view
