// Lists of values become cases: each axis that means something to a case multiplies it.
#include <algorithm>

#include "common/cases/axes.h"

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

}  // namespace

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
    return inputError(
        "none of these variants exists on these routes: vertex, compute and cpu run on vk and gl, "
        "mesh on vk-ext, vk-nv, gl-ext and gl-nv");
}

Result<std::vector<Case>> crossCases(std::vector<Case> cases, const AxisWords& words) {
    for (const Axis& axis : axes())
        if (const auto* named = namedWords(words, axis)) SKINBENCH_TRY(crossAxis(cases, axis, named));
    return cases;
}

}  // namespace skinbench
