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
    auto first = [&](auto&& suits) -> const RouteWish* {
        for (const RouteWish& wish : routeWishes()) {
            Case c;
            c.route = findRoute(wish.route);
            c.variant = findVariant(wish.variant);
            c.codec = findCodec("uc");
            if (suits(wish, *c.route) && !reasonAgainst(completed(c), devices)) return &wish;
        }
        return nullptr;
    };
    auto caseOf = [](const RouteWish& wish) {
        Case c;
        c.route = findRoute(wish.route);
        c.variant = findVariant(wish.variant);
        c.codec = findCodec("uc");
        return completed(c);
    };
    if (!state.cases[0].route) {
        const RouteWish* best = first([](const RouteWish&, const Route&) { return true; });
        state.cases[0] = caseOf(best ? *best : routeWishes().front());
    }
    if (state.cases[1].route) return;
    const Case& a = state.cases[0];
    const RouteWish* other = first([&](const RouteWish& wish, const Route& route) {
        return route.api != a.route->api && std::string_view(wish.variant) == a.variant->name;
    });
    if (!other) other = first([&](const RouteWish&, const Route& route) { return route.api != a.route->api; });
    if (!other) {
        state.cases[1] = a;
        return;
    }
    // All of A's options that the other route has.
    Case b = a;
    b.route = findRoute(other->route);
    b = completed(b);
    state.cases[1] = reasonAgainst(b, devices) ? caseOf(*other) : b;
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
