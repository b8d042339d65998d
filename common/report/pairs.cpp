#include "common/report/pairs.h"

#include <algorithm>
#include <format>
#include <map>
#include <set>

#include <nlohmann/json.hpp>

#include "common/core/text.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

// An axis as the files list it; a file of another version may have axes that this program does not know.
struct FileAxis {
    std::string name, option, usual, beside;
    bool topLevel = false;
    std::vector<std::string> values;
};

std::string textOf(const Json& object, const char* key) {
    const auto found = object.is_object() ? object.find(key) : object.end();
    return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

void addAxesOf(std::vector<FileAxis>& axes, const Json& results) {
    for (const Json& row : results.value("axes", Json::array())) {
        FileAxis axis{
            textOf(row, "name"), textOf(row, "option"), textOf(row, "usual"), textOf(row, "beside"), false, {}};
        if (axis.name.empty() || std::ranges::contains(axes, axis.name, &FileAxis::name)) continue;
        axis.topLevel = row.contains("top_level") && row["top_level"] == true;
        if (row.contains("values") && row["values"].is_array())
            for (const Json& value : row["values"])
                if (value.is_string()) axis.values.push_back(value);
        if (axis.name == "variant" && axis.usual.empty()) axis.usual = "vertex";
        axes.push_back(std::move(axis));
    }
}

std::vector<FileAxis> axesOf(const Json& a, const Json& b) {
    std::vector<FileAxis> axes;
    addAxesOf(axes, a);
    addAxesOf(axes, b);
    return axes;
}

// Empty where the axis means nothing to the case.
std::string valueOf(const FileAxis& axis, const Json& row) {
    if (axis.topLevel) return textOf(row, axis.name.c_str());
    return row.contains("options") ? textOf(row["options"], axis.name.c_str()) : std::string();
}

std::string comparable(const FileAxis& axis, const Json& row) {
    const std::string value = valueOf(axis, row);
    return value.empty() ? axis.usual : value;
}

// A case of an older file whose id says nothing to this program has no options.
bool isKnown(const Json& row) {
    return row.contains("options") && row["options"].is_object() && !row["options"].empty() &&
           !row["id"].get<std::string>().contains("+again");
}

std::string shownName(std::string name) {
    std::ranges::replace(name, '_', ' ');
    return name;
}

std::string joined(const auto& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + terminalText(word, 60);
    return text.empty() ? "none" : text;
}

// The values that the file's cases have, in the order of the axis.
std::vector<std::string> valuesIn(const Json& results, const FileAxis& axis) {
    std::set<std::string> found;
    for (const Json& row : results["cases"])
        if (const std::string value = valueOf(axis, row); !value.empty()) found.insert(value);
    std::vector<std::string> values;
    for (const std::string& value : axis.values)
        if (found.erase(value)) values.push_back(value);
    values.insert(values.end(), found.begin(), found.end());
    return values;
}

// 0 for the usual value, the others as the axis lists them, unknown ones last.
size_t rankOf(const FileAxis& axis, const Json& row) {
    const std::string value = comparable(axis, row);
    if (value == axis.usual) return 0;
    return 1 + static_cast<size_t>(std::ranges::find(axis.values, value) - axis.values.begin());
}

// Those that two cases of a pair may differ in: the named ones first, then what only means something beside them.
struct Freedom {
    std::vector<const FileAxis*> named, beside, fixed;
    std::vector<std::string> bases;  // of `named`
};

Freedom freedomOf(const std::vector<FileAxis>& axes, std::span<const PairAxis> paired) {
    Freedom freedom;
    for (const PairAxis& one : paired) {
        freedom.named.push_back(&*std::ranges::find(axes, one.name, &FileAxis::name));
        freedom.bases.push_back(one.base);
    }
    for (const FileAxis& axis : axes) {
        if (std::ranges::contains(paired, axis.name, &PairAxis::name)) continue;
        const bool beside = std::ranges::contains(paired, axis.beside, &PairAxis::name);
        (beside ? freedom.beside : freedom.fixed).push_back(&axis);
    }
    return freedom;
}

std::vector<size_t> rankOf(const Freedom& freedom, const Json& row) {
    std::vector<size_t> ranks;
    for (const auto* axes : {&freedom.named, &freedom.beside})
        for (const FileAxis* axis : *axes) ranks.push_back(rankOf(*axis, row));
    return ranks;
}

bool isBase(const Freedom& freedom, const Json& row) {
    for (size_t i = 0; i < freedom.named.size(); ++i)
        if (!freedom.bases[i].empty() && comparable(*freedom.named[i], row) != freedom.bases[i]) return false;
    return true;
}

bool differ(const std::vector<const FileAxis*>& axes, const Json& a, const Json& b) {
    return std::ranges::any_of(axes,
                               [&](const FileAxis* axis) { return comparable(*axis, a) != comparable(*axis, b); });
}

std::string directionOf(const Freedom& freedom, const Json& a, const Json& b) {
    std::string text;
    for (const auto* axes : {&freedom.named, &freedom.beside})
        for (const FileAxis* axis : *axes)
            if (const std::string from = comparable(*axis, a), to = comparable(*axis, b); from != to)
                text += std::format("{}{}: {} → {}", text.empty() ? "" : ", ", shownName(axis->name),
                                    from.empty() ? "none" : from, to.empty() ? "none" : to);
    return text;
}

struct AlikeRows {
    std::vector<const Json*> a, b;
};

}  // namespace

Result<std::vector<PairAxis>> parsePairAxes(std::span<const std::string> words, const Json& a) {
    const std::vector<FileAxis> axes = axesOf(a, a);
    std::vector<PairAxis> paired;
    for (const std::string& word : words) {
        const size_t equals = word.find('=');
        std::string name = word.substr(0, equals);
        if (name.starts_with("--")) name.erase(0, 2);
        std::string key = name;
        std::ranges::replace(key, '-', '_');
        const auto axis = std::ranges::find_if(
            axes, [&](const FileAxis& row) { return row.name == key || row.option == "--" + name; });
        if (axis == axes.end()) {
            std::vector<std::string> names;
            for (const FileAxis& row : axes) names.push_back(row.name);
            return inputError(std::format("--pair '{}': no axis has that name; there is {}", word, joined(names)));
        }
        if (std::ranges::contains(paired, axis->name, &PairAxis::name))
            return inputError(std::format("--pair names the axis {} twice", axis->name));
        PairAxis one{axis->name, equals == std::string::npos ? "" : word.substr(equals + 1)};
        const std::vector<std::string> values = valuesIn(a, *axis);
        if (equals != std::string::npos && !std::ranges::contains(values, one.base))
            return inputError(std::format("--pair '{}': no case of A has it; there is {}", word, joined(values)));
        paired.push_back(std::move(one));
    }
    return paired;
}

Pairing pairCases(const Json& a, const Json& b, std::span<const PairAxis> paired) {
    const std::vector<FileAxis> axes = axesOf(a, b);
    const Freedom freedom = freedomOf(axes, paired);
    auto restOf = [&](const Json& row) {
        std::string key;
        for (const FileAxis* axis : freedom.fixed) key += comparable(*axis, row) + "\n";
        return key;
    };
    std::map<std::string, AlikeRows> groups;
    for (const Json& row : a["cases"])
        if (isKnown(row)) groups[restOf(row)].a.push_back(&row);
    for (const Json& row : b["cases"])
        if (isKnown(row)) groups[restOf(row)].b.push_back(&row);

    using Ranks = std::vector<size_t>;
    std::map<std::pair<Ranks, Ranks>, std::vector<CasePair>> byDirection;
    std::set<const Json*> used;
    for (auto& [rest, group] : groups) {
        std::erase_if(group.a, [&](const Json* row) { return !isBase(freedom, *row); });
        const auto base = std::ranges::min_element(group.a, {}, [&](const Json* row) { return rankOf(freedom, *row); });
        if (base == group.a.end()) continue;
        for (const Json* other : group.b) {
            if (!differ(freedom.named, **base, *other)) continue;
            byDirection[{rankOf(freedom, **base), rankOf(freedom, *other)}].push_back(
                {*base, other, directionOf(freedom, **base, *other)});
            used.insert({*base, other});
        }
    }
    Pairing pairing;
    for (auto& [direction, pairs] : byDirection) pairing.pairs.insert(pairing.pairs.end(), pairs.begin(), pairs.end());
    pairing.alone =
        static_cast<size_t>(std::ranges::count_if(a["cases"], [&](const Json& row) { return !used.contains(&row); }));
    return pairing;
}

std::string whyNoneShared(const Json& a, const Json& b) {
    if (a["cases"].empty() || b["cases"].empty())
        return std::string(a["cases"].empty() ? "A" : "B") + " has no case at all";
    std::string disjoint, names, unequal;
    for (const FileAxis& axis : axesOf(a, b)) {
        const std::vector<std::string> ofA = valuesIn(a, axis), ofB = valuesIn(b, axis);
        if (ofA == ofB) continue;
        unequal += (unequal.empty() ? "" : ", ") + shownName(axis.name);
        const bool common =
            std::ranges::any_of(ofA, [&](const std::string& value) { return std::ranges::contains(ofB, value); });
        if (common || ofA.empty() || ofB.empty()) continue;
        disjoint += std::format("{}{} ({} in A, {} in B)", disjoint.empty() ? "" : ", ", shownName(axis.name),
                                joined(ofA), joined(ofB));
        names += (names.empty() ? "" : ",") + axis.name;
    }
    if (!disjoint.empty()) return std::format("they differ in {}; --pair {} compares them", disjoint, names);
    return unequal.empty() ? "they combine the same options in other ways" : "they combine other values of " + unequal;
}

}  // namespace skinbench
