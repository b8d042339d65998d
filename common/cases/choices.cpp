#include "common/cases/choices.h"

#include <algorithm>

namespace skinbench {
namespace {

// The variant that is most like another one on a route that does not have it.
const Variant* nearestVariant(const Variant& wanted, const Route& route) {
    const Variant* nearest = nullptr;
    int most = -1;
    for (const Variant& row : variants()) {
        if (!runsOn(row, route)) continue;
        const int like = (&row == &wanted ? 4 : 0) + (row.skins == wanted.skins ? 2 : 0) +
                         (row.skinsInCompute == wanted.skinsInCompute ? 1 : 0);
        if (like <= most) continue;
        nearest = &row;
        most = like;
    }
    return nearest;
}

}  // namespace

Case completed(const Case& c) {
    Case made;
    for (const Axis& axis : axes()) {
        if (!axis.applies(made)) continue;
        std::string word = axis.get(c);
        const std::vector<std::string> unnamed = axis.unnamed(made);
        // A single value that is not the usual one is all that such a case can have.
        if (word.empty() || (!axis.usual.empty() && unnamed.size() == 1 && unnamed.front() != axis.usual))
            word = unnamed.front();
        if (axis.name == "variant") word = nearestVariant(*c.variant, *made.route)->name;
        if (!axis.set(made, word)) axis.set(made, axis.usual);
    }
    return made;
}

bool joinsWords(const Case& c, const Axis& axis) {
    Case scratch = c;
    return axis.words.size() > 2 && axis.set(scratch, axis.words[1] + "+" + axis.words[2]).has_value();
}

std::string toggledWord(const Axis& axis, const std::string& value, const std::string& word) {
    if (word == axis.usual) return word;
    std::string joined;
    for (const std::string& other : axis.words) {
        const bool in = ("+" + value + "+").contains("+" + other + "+") && other != axis.usual;
        if (other == word ? !in : in) joined += (joined.empty() ? "" : "+") + other;
    }
    return joined.empty() ? axis.usual : joined;
}

Result<Case> withValue(const Case& c, const Axis& axis, const std::string& word) {
    Case changed = c;
    SKINBENCH_TRY(axis.set(changed, word));
    if (axis.name == "variant" && !runsOn(*changed.variant, *changed.route)) {
        const auto carries = [&](const Route& row) { return row.api == c.route->api && runsOn(*changed.variant, row); };
        const auto route = std::ranges::find_if(routes(), carries);
        if (route != routes().end()) changed.route = &*route;
    }
    return completed(changed);
}

}  // namespace skinbench
