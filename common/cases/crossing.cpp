// Lists of values become cases: each axis that means something to a case multiplies it.
#include <algorithm>
#include <format>

#include "common/cases/axes.h"
#include "common/plans/plan.h"

namespace skinbench {
namespace {

// A combination that no device has, as far as its rows are chosen.
bool existsNowhere(const Case& c) {
    if (!c.route || !c.variant) return false;
    if (!runsOn(*c.variant, *c.route)) return true;
    // The CPU skins the vertices themselves.
    return c.codec && c.variant->skinsOnHost && !c.codec->feedsAttributes;
}

Result<void> crossAxis(std::vector<Case>& cases, const Axis& axis, const std::vector<std::string>* named) {
    std::vector<Case> crossed;
    for (const Case& c : cases) {
        if (!axis.applies(c)) {
            crossed.push_back(c);
            continue;
        }
        std::vector<std::string> values;
        for (const std::string& word : named ? *named : axis.unnamed(c)) {
            Case with = c;
            SKINBENCH_TRY(axis.set(with, word));
            // Two words may be one value: 64/124 and meshopt.
            if (std::ranges::find(values, axis.get(with)) != values.end()) continue;
            values.push_back(axis.get(with));
            if (!existsNowhere(with)) crossed.push_back(with);
        }
    }
    cases = std::move(crossed);
    return {};
}

const std::vector<std::string>* namedWords(const AxisWords& words, const Axis& axis) {
    const auto named = words.find(axis.name);
    return named == words.end() || named->second.empty() ? nullptr : &named->second;
}

// "a, b or c"
std::string anyOf(const std::vector<std::string>& names) {
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    return text;
}

void addOnce(std::vector<std::string>& names, const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
}

// Where an axis means something, or a word of it can be drawn, on the best of devices, when all others have their usual
// values.
struct Home {
    std::vector<std::string> routes, variants;
    bool operator==(const Home&) const = default;
};

Home homeOf(const Axis& axis, const std::string* word = nullptr) {
    Home home;
    for (const Route& route : routes())
        for (const Variant& variant : variants()) {
            Case c;
            c.route = &route;
            c.variant = &variant;
            c.codec = findCodec("uc");
            if (!runsOn(variant, route) || !axis.applies(c)) continue;
            if (word && (!axis.set(c, *word) || unsupported(c, unlimitedCaps(route.api)))) continue;
            addOnce(home.routes, route.name);
            addOnce(home.variants, variant.name);
        }
    return home;
}

// "--queues needs vk, vk-ext or gl", or "--queues async needs vk": what the word of the axis lacks.
std::string reasonOf(const Axis& axis, const std::string& word, const std::vector<Case>& cases) {
    const std::string option = "--" + axis.option.name;
    if (!axis.beside.empty()) {
        const Axis& other = *findAxis(axis.beside);
        return std::format("{} means nothing beside --{} {}", option, other.option.name, other.usual);
    }
    const Home any = homeOf(axis), own = homeOf(axis, &word);
    const bool narrower = !own.routes.empty() && own != any;
    const Home& home = narrower ? own : any;
    const bool onRoute = std::ranges::any_of(
        cases, [&](const Case& c) { return std::ranges::find(home.routes, c.route->name) != home.routes.end(); });
    return option + (narrower ? " " + word : "") + " needs " +
           (onRoute ? "the variant " + anyOf(home.variants) : anyOf(home.routes));
}

// The other half of the pairs of route and variant that exist.
std::string needsOfPath(const Axis& axis, const std::string& word) {
    const Route* const route = axis.name == "route" ? findRoute(word) : nullptr;
    const Variant* const variant = axis.name == "variant" ? findVariant(word) : nullptr;
    std::vector<std::string> names;
    if (route)
        for (const Variant& other : variants())
            if (runsOn(other, *route)) names.push_back(other.name);
    if (variant)
        for (const Route& other : routes())
            if (runsOn(*variant, other)) names.push_back(other.name);
    if (names.empty()) return "needs a variant that skins on the GPU";
    return (route ? "needs the variant " : "needs ") + anyOf(names);
}

}  // namespace

std::vector<Unused> unusedWords(const AxisWords& words, const std::vector<Case>& cases) {
    std::vector<Unused> unused;
    for (const Axis& axis : axes()) {
        const std::vector<std::string>* const named = namedWords(words, axis);
        if (!named) continue;
        const bool alone = axis.name == "route" || axis.name == "variant" || axis.name == "codec";
        const std::string option = "--" + axis.option.name;
        const size_t first = unused.size();  // of this axis
        for (const std::string& word : *named) {
            Case scratch;
            const bool used = axis.set(scratch, word) && std::ranges::any_of(cases, [&](const Case& c) {
                                  return axis.applies(c) && axis.get(c) == axis.get(scratch);
                              });
            if (used) continue;
            const std::string reason = alone ? word + " " + needsOfPath(axis, word) : reasonOf(axis, word, cases);
            const auto known = std::find_if(unused.begin() + static_cast<std::ptrdiff_t>(first), unused.end(),
                                            [&](const Unused& other) { return other.reason == reason; });
            if (known == unused.end())
                unused.push_back({axis.name, option, {word}, reason});
            else
                known->words.push_back(word);
        }
    }
    return unused;
}

Result<std::vector<Case>> crossCases(const AxisWords& words) {
    // A word that no case asks for is looked up all the same.
    for (const auto& [name, values] : words) {
        const Axis* const axis = findAxis(name);
        SKINBENCH_ASSERT(axis);
        Case scratch;
        for (const std::string& word : values) SKINBENCH_TRY(axis->set(scratch, word));
    }
    std::vector<Case> cases(1);
    for (const Axis& axis : axes()) SKINBENCH_TRY(crossAxis(cases, axis, namedWords(words, axis)));
    if (!cases.empty()) return cases;
    std::string reasons;
    for (const Unused& unused : unusedWords(words, cases))
        if (unused.axis == "variant" || unused.axis == "codec")
            reasons += (reasons.empty() ? ": " : "; ") + unused.reason;
    return inputError("none of these variants exists on these routes" + reasons);
}

Result<std::vector<Case>> crossCases(std::vector<Case> cases, const AxisWords& words) {
    for (const Axis& axis : axes())
        if (const auto* named = namedWords(words, axis)) SKINBENCH_TRY(crossAxis(cases, axis, named));
    return cases;
}

}  // namespace skinbench
