// What follows from the table of axes for one case: its id and back, its keys, its limit.
#include <algorithm>
#include <format>
#include <ranges>

#include "common/cases/axes.h"

namespace skinbench {
namespace {

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    for (const auto part : std::views::split(text, separator)) parts.emplace_back(part.begin(), part.end());
    if (parts.empty()) parts.emplace_back();
    return parts;
}

std::unexpected<Error> noSuchId(const std::string& id, const std::string& why) {
    return inputError(std::format("no case has the id '{}': {}", id, why));
}

Result<void> readPath(Case& c, const std::string& id, const std::vector<std::string>& path) {
    size_t next = 0;
    for (const Axis& axis : axes()) {
        // Axes that come later read the route and the variant.
        if (!axis.inPath || (next > 2 && !axis.applies(c))) continue;
        if (next == path.size()) return noSuchId(id, "its " + axis.name + " is missing");
        if (auto set = axis.set(c, path[next]); !set) return noSuchId(id, set.error().text);
        ++next;
        if (next == 2 && !runsOn(*c.variant, *c.route))
            return noSuchId(id, std::format("{} does not exist on route {}", c.variant->name, c.route->name));
    }
    if (next < path.size()) return noSuchId(id, std::format("'{}' is one part too many", path[next]));
    return {};
}

bool makesRecordsOfMeshlets(const Case& c) { return c.builder && (sharesJointLists(c) || c.shape.orderedRecords); }

// Whether meshlets decide about what is made up to `upTo`.
bool readsMeshlets(const Case& c, Changes upTo) {
    if (upTo == Changes::records) return makesRecordsOfMeshlets(c);
    if (upTo == Changes::encoding) return makesRecordsOfMeshlets(c) || c.codec->needsMeshlets;
    return true;
}

}  // namespace

bool storesSceneVertices(const Case& c) { return !usesPartition(c) && !makesRecordsOfMeshlets(c); }

std::string keyOf(const Case& c, Changes upTo) {
    std::string key = std::format("records={}", static_cast<int>(c.variant->storedAs));
    for (const Axis& axis : axes()) {
        // What means nothing to a case is made as if it had the usual value.
        if (axis.changes > upTo || !axis.applies(c) || axis.get(c) == axis.usual) continue;
        if (axis.changes == Changes::meshlets && !readsMeshlets(c, upTo)) continue;
        key += std::format(" {}={}", axis.name, axis.get(c));
    }
    return key;
}

std::string pictureOf(const Case& c) {
    std::string key = c.variant->skins ? "skinned" : "bind pose";
    for (const Axis& axis : axes())
        if (axis.changesPicture && axis.applies(c)) key += std::format(" {}={}", axis.name, axis.get(c));
    if (c.compute.wicked) key += " byte normals";
    return key;
}

bool sameWork(const Case& a, const Case& b) {
    return std::ranges::all_of(axes(),
                               [&](const Axis& axis) { return !axis.changesWork || axis.get(a) == axis.get(b); });
}

Defines definesOf(const Case& c) {
    Defines defines;
    for (const Axis& axis : axes())
        if (!axis.define.empty()) defines.emplace_back(axis.define, axis.defineValue(c));
    return defines;
}

std::string caseId(const Case& c) {
    std::string path, options;
    for (const Axis& axis : axes()) {
        if (!axis.applies(c)) continue;
        if (axis.inPath) path += (path.empty() ? "" : "/") + axis.get(c);
        if (const std::string part = axis.idPart(c); !part.empty()) options += "+" + part;
    }
    return path + options;
}

Result<Case> parseCaseId(const std::string& id) {
    std::vector<std::string> parts = split(id, '+');
    Case c;
    SKINBENCH_TRY(readPath(c, id, split(parts.front(), '/')));
    for (size_t i = 1; i < parts.size(); ++i) {
        if (parts[i] == "again")
            return noSuchId(id, "'again' marks the second one of two equal cases of --self-test; leave it out");
        const auto axis = std::ranges::find_if(axes(), [&](const Axis& row) { return row.readIdPart(c, parts[i]); });
        if (axis == axes().end()) return noSuchId(id, std::format("there is no option '{}'", parts[i]));
    }
    for (const Axis& axis : axes())
        if (!axis.applies(c) && !axis.inPath && axis.get(c) != axis.usual)
            return noSuchId(id, std::format("{} {} means nothing to it", axis.name, axis.get(c)));
    return c;
}

std::optional<Case> limitCase(const Case& c) {
    if (c.variant->skinsOnHost || c.variant->listsTriangles || c.scenario == Scenario::prepass) return std::nullopt;
    if (c.clusterCull != ClusterCull::off) return std::nullopt;
    Case limit;
    for (const Axis& axis : axes()) {
        if (axis.ofLimit.empty() || (!axis.inPath && !axis.applies(limit))) continue;
        const std::string word = axis.ofLimit == kSame ? axis.get(c) : axis.ofLimit;
        if (word.empty()) continue;  // no builder on routes without meshlets
        SKINBENCH_ASSERT(axis.set(limit, word).has_value());
    }
    return limit;
}

}  // namespace skinbench
