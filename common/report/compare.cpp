#include "common/report/compare.h"

#include <algorithm>
#include <cmath>
#include <format>
#include <map>
#include <numeric>

#include <nlohmann/json.hpp>

#include "common/core/text.h"
#include "common/report/report.h"

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

// The key of the times that are compared: of frames for themselves, or within batches.
constexpr const char *kFrames = "gpu_ms", *kBatches = "batch_ms";

bool hasTimes(const Json& row, const char* key) { return row.contains(key) && row[key].is_object(); }

// A file that does not say its rounds counts as one; samples that are not positive count as none.
Measured measuredOf(const Json& row, const char* key) {
    Measured measured{row[key].value("samples", std::vector<double>()), {}};
    auto usable = [](double sample) { return std::isfinite(sample) && sample > 0; };
    if (!std::ranges::all_of(measured.samples, usable)) measured.samples.clear();
    const Json sizes = row[key].value("round_sizes", Json(nullptr));
    if (!sizes.is_null()) measured.roundSizes = sizes.get<std::vector<size_t>>();
    std::erase(measured.roundSizes, 0);
    const size_t sum = std::accumulate(measured.roundSizes.begin(), measured.roundSizes.end(), size_t{0});
    if (measured.roundSizes.empty() || sum != measured.samples.size()) measured.roundSizes = {measured.samples.size()};
    return measured;
}

ComparedSide sideOf(const Json& results, const Json& row, const char* key = kFrames) {
    ComparedSide side{
        row["id"], row["status"], row["reason"].is_null() ? "" : row["reason"].get<std::string>(), {}, false};
    if (side.status == "ok" && hasTimes(row, key))
        if (const double median = row[key]["median"]; std::isfinite(median) && median > 0) side.median = median;
    side.software = side.median && isSoftware(results, row);
    return side;
}

ComparedCase compareTimes(ComparedCase compared, const Json& a, const Json& b, double noiseFloor, const char* key) {
    const TimeRatio found =
        judgeRatio(*compared.b.median / *compared.a.median, measuredOf(a, key), measuredOf(b, key), noiseFloor);
    compared.change = found.change;
    compared.ratio = found.ratio;
    compared.interval = found.interval;
    return compared;
}

ComparedCase compareCase(const Json& a, const Json& rowA, const Json& b, const Json& rowB, double noiseFloor,
                         const char* key = kFrames) {
    ComparedCase compared{rowA["id"], "", Change::same, sideOf(a, rowA, key), sideOf(b, rowB, key), {}, {}};
    const bool okA = compared.a.status == "ok", okB = compared.b.status == "ok";
    if (okA && okB && compared.a.median && compared.b.median)
        return compareTimes(std::move(compared), rowA, rowB, noiseFloor, key);
    compared.change = okA && okB ? Change::untimed : okA ? Change::broken : okB ? Change::mended : Change::notRun;
    return compared;
}

std::string shown(const Json& value) {
    if (value.is_null()) return "none";
    return terminalText(value.is_string() ? value.get<std::string>() : dumpJson(value, -1), kLongestMessage);
}

std::string devicesText(const Json& results, bool withUuids) {
    std::string text;
    for (const Json& device : results["devices"]) {
        text +=
            std::format("{}{}: {}, {}{}", text.empty() ? "" : "; ", shown(device["route_api"]),
                        shown(deviceLabel(device)), shown(device["driver"]), device["software"] ? " (software)" : "");
        const auto uuid = device.find("uuid");
        if (withUuids && !device["software"] && uuid != device.end() && uuid->is_string())
            text += ", UUID " + shown(*uuid);
    }
    return text.empty() ? "none" : text;
}

std::vector<std::string> differencesOf(const Json& a, const Json& b) {
    std::vector<std::string> differences;
    auto differ = [&](const std::string& what, const std::string& before, const std::string& after) {
        if (before != after) differences.push_back(std::format("{}: {} in A, {} in B", what, before, after));
    };
    // Cards of one name are told apart by their UUIDs.
    const bool alike = devicesText(a, false) == devicesText(b, false);
    differ("devices", devicesText(a, alike), devicesText(b, alike));
    for (const char* group : {"scene", "settings", "host", "tool"}) {
        for (const auto& [key, value] : a[group].items())
            differ(std::string(group) + " " + terminalText(key, kLongestMessage), shown(value),
                   b[group].contains(key) ? shown(b[group][key]) : "not said");
        for (const auto& [key, value] : b[group].items())
            if (!a[group].contains(key))
                differ(std::string(group) + " " + terminalText(key, kLongestMessage), "not said", shown(value));
    }
    // Ids leave out what is usual, and what is usual may have changed between two versions.
    std::map<std::string, std::pair<std::string, std::string>> options;
    std::map<std::string, const Json*> ofA;
    for (const Json& row : a["cases"]) ofA[row["id"]] = &row;
    for (const Json& row : b["cases"]) {
        const auto same = ofA.find(row["id"]);
        if (same == ofA.end()) continue;
        const Json earlier = same->second->value("options", Json::object());
        const Json later = row.value("options", Json::object());
        if (!earlier.is_object() || !later.is_object()) continue;
        for (const auto& [key, value] : later.items()) {
            const Json before = earlier.value(key, value);
            if (before != value) options[key] = {shown(before), shown(value)};
        }
    }
    for (const auto& [key, values] : options)
        differ("equal ids, option " + terminalText(key, kLongestMessage), values.first, values.second);
    return differences;
}

Result<std::map<std::string, const Json*>> casesById(const Json& results, const char* name) {
    std::map<std::string, const Json*> cases;
    for (const Json& row : results["cases"])
        if (!cases.emplace(row["id"], &row).second)
            return inputError(std::string(name) + " holds the case " + row["id"].get<std::string>() + " twice");
    return cases;
}

// Distance of the ratio from 1 in both directions alike.
double effect(const ComparedCase& compared) { return compared.ratio ? std::abs(std::log(*compared.ratio)) : 0; }

// All but the cases.
Comparison startComparison(const Json& a, const Json& b) {
    Comparison comparison;
    comparison.differences = differencesOf(a, b);
    comparison.drawn = drawnDifferences(a, b);
    auto floorOf = [](const Json& results) {
        const Json floor = results.value("noise_floor", Json(nullptr));
        return floor.is_null() ? std::optional<double>() : floor.get<double>();
    };
    const auto floorA = floorOf(a), floorB = floorOf(b);
    comparison.noiseFloor = std::max(floorA.value_or(kDefaultNoiseFloor), floorB.value_or(kDefaultNoiseFloor));
    comparison.noiseFloorMeasured = floorA && floorB;
    auto covers = [&](const Json& results, const auto& floor) {
        return floor || results.value("settings", Json::object()).value("placement", "kept") == "fresh";
    };
    comparison.placementCovered = covers(a, floorA) && covers(b, floorB);
    return comparison;
}

bool comesBefore(const ComparedCase& x, const ComparedCase& y) {
    return x.change != y.change ? x.change < y.change : effect(x) > effect(y);
}

Result<Comparison> compareChecked(const Json& a, const Json& b) {
    auto casesA = casesById(a, "A"), casesB = casesById(b, "B");
    SKINBENCH_TRY(casesA);
    SKINBENCH_TRY(casesB);
    Comparison comparison = startComparison(a, b);
    bool shared = false;
    for (const Json& row : a["cases"]) {
        const auto other = casesB->find(row["id"]);
        shared = shared || other != casesB->end();
        if (other == casesB->end())
            comparison.cases.push_back({row["id"], "", Change::onlyA, sideOf(a, row), {}, {}, {}});
        else
            comparison.cases.push_back(compareCase(a, row, b, *other->second, comparison.noiseFloor));
    }
    if (!shared) return inputError("A and B have no case in common: " + whyNoneShared(a, b));
    for (const Json& row : b["cases"])
        if (!casesA->contains(row["id"]))
            comparison.cases.push_back({row["id"], "", Change::onlyB, {}, sideOf(b, row), {}, {}});
    std::ranges::stable_sort(comparison.cases, comesBefore);
    return comparison;
}

Result<Comparison> comparePairsChecked(const Json& a, const Json& b, std::span<const std::string> axisWords) {
    const auto axes = parsePairAxes(axisWords, a);
    SKINBENCH_TRY(axes);
    Comparison comparison = startComparison(a, b);
    const Pairing pairing = pairCases(a, b, *axes);
    std::string names;
    for (const PairAxis& axis : *axes) {
        comparison.pairedBy.push_back(axis.name);
        names += (names.empty() ? "" : ", ") + axis.name;
    }
    if (pairing.pairs.empty()) return inputError("no two cases are equal but for " + names);
    comparison.alone = pairing.alone;
    // What the number of queues changes shows within batches alone.
    const bool byQueues = std::ranges::contains(*axes, "queues", &PairAxis::name);
    comparison.inBatches = byQueues && std::ranges::all_of(pairing.pairs, [](const CasePair& pair) {
                               return hasTimes(*pair.a, kBatches) == hasTimes(*pair.a, kFrames) &&
                                      hasTimes(*pair.b, kBatches) == hasTimes(*pair.b, kFrames);
                           });
    const char* const key = comparison.inBatches ? kBatches : kFrames;
    auto begin = pairing.pairs.begin();
    while (begin != pairing.pairs.end()) {
        const auto end = std::find_if(begin, pairing.pairs.end(),
                                      [&](const CasePair& pair) { return pair.direction != begin->direction; });
        std::vector<ComparedCase> compared;
        for (; begin != end; ++begin) {
            compared.push_back(compareCase(a, *begin->a, b, *begin->b, comparison.noiseFloor, key));
            compared.back().direction = begin->direction;
        }
        std::ranges::stable_sort(compared, comesBefore);
        comparison.cases.insert(comparison.cases.end(), compared.begin(), compared.end());
    }
    return comparison;
}

// "25.415*": milliseconds with the mark of a software driver.
std::string timeText(const ComparedSide& side) {
    return side.median ? std::format("{:.3f}{}", *side.median, side.software ? "*" : " ") : "- ";
}

std::string reasonText(const ComparedSide& side) {
    return side.reason.empty() ? "" : ": " + terminalText(side.reason, kLongestMessage);
}

std::string lineText(const ComparedCase& compared, size_t width) {
    const auto& [name, direction, change, a, b, ratio, interval] = compared;
    const std::string id = terminalText(name, kLongestMessage);
    if (change == Change::onlyA) return std::format("  {}  {}{}\n", id, a.status, reasonText(a));
    if (change == Change::onlyB) return std::format("  {}  {}{}\n", id, b.status, reasonText(b));
    if (a.status != "ok" || b.status != "ok")
        return std::format("  {}  A {}{} | B {}{}\n", id, a.status, reasonText(a), b.status, reasonText(b));
    if (!ratio) return std::format("  {}\n", id);
    return std::format("  {:<{}}  {:>11}{:>11}  {:>7.4f}{} {}\n", id, width, timeText(a), timeText(b), *ratio,
                       a.software || b.software ? "*" : " ",
                       interval ? std::format("{:.4f} to {:.4f}", interval->low, interval->high) : "-");
}

const char* headingOf(Change change) {
    switch (change) {
        case Change::slower:
            return "slower in B";
        case Change::faster:
            return "faster in B";
        case Change::same:
            return "no difference";
        case Change::unknown:
            return "not known, fewer than 6 samples";
        case Change::broken:
            return "ok in A, not in B";
        case Change::mended:
            return "ok in B, not in A";
        case Change::notRun:
            return "ok in neither";
        case Change::untimed:
            return "not timed in both";
        case Change::onlyA:
            return "only in A";
        case Change::onlyB:
            return "only in B";
    }
    return "?";
}

Json sideJson(const ComparedSide& side) {
    if (side.status.empty()) return nullptr;
    return {{"id", side.id},
            {"status", side.status},
            {"reason", side.reason.empty() ? Json(nullptr) : Json(side.reason)},
            {"median_ms", side.median ? Json(*side.median) : Json(nullptr)},
            {"software", side.software}};
}

}  // namespace

TimeRatio judgeRatio(double ratio, const Measured& a, const Measured& b, double noiseFloor) {
    TimeRatio found{Change::unknown, ratio, {}};
    if (std::min(a.samples.size(), b.samples.size()) < kFewestSamples) return found;
    found.interval = medianRatioInterval(a, b);
    const bool outside = std::abs(ratio - 1) > noiseFloor;
    found.change = outside && found.interval->low > 1    ? Change::slower
                   : outside && found.interval->high < 1 ? Change::faster
                                                         : Change::same;
    return found;
}

const char* changeName(Change change) {
    const char* names[] = {"slower", "faster",  "same",    "unknown", "broken",
                           "mended", "not-run", "untimed", "only-a",  "only-b"};
    return names[static_cast<size_t>(change)];
}

static std::unexpected<Error> wrongKind(const Json::exception& error) {
    return inputError("a result file holds a value of the wrong kind: " + std::string(error.what()));
}

Result<Comparison> compareResults(const Json& a, const Json& b) {
    try {
        return compareChecked(a, b);
    } catch (const Json::exception& error) {
        return wrongKind(error);
    }
}

Result<Comparison> comparePairs(const Json& a, const Json& b, std::span<const std::string> axisWords) {
    try {
        return comparePairsChecked(a, b, axisWords);
    } catch (const Json::exception& error) {
        return wrongKind(error);
    }
}

static std::string drawnText(const Comparison& comparison) {
    std::string words;
    for (const std::string& word : comparison.drawn) words += (words.empty() ? "" : ", ") + word;
    return "A and B do not draw the same (" + words + "): B/A says nothing about which is faster";
}

std::vector<std::string> findWorse(const Comparison& comparison, double percent, bool allowMissing) {
    if (!comparison.drawn.empty()) return {drawnText(comparison)};
    std::vector<std::string> lines;
    auto add = [&](const char* one, const char* more, const auto& belongs, const auto& detail) {
        const auto first = std::ranges::find_if(comparison.cases, belongs);
        if (first == comparison.cases.end()) return;
        const auto count = std::ranges::count_if(comparison.cases, belongs);
        lines.push_back(std::format("{} of {} {}; the first, {}{}", count, counted(comparison.cases.size(), "case"),
                                    count == 1 ? one : more, first->id, detail(*first)));
    };
    auto nothing = [](const ComparedCase&) { return std::string(); };
    auto inB = [](const ComparedCase& c) { return ", " + c.b.status + reasonText(c.b); };
    const double allowed = std::max(percent / 100, comparison.noiseFloor);
    add(
        std::format("is more than {} % slower", percent).c_str(),
        std::format("are more than {} % slower", percent).c_str(),
        [&](const ComparedCase& c) { return c.interval && c.interval->low > 1 + allowed; },
        [](const ComparedCase& c) {
            return std::format(", takes {:.4f} of A ({:.4f} to {:.4f})", *c.ratio, c.interval->low, c.interval->high);
        });
    add(
        "is ok in A and not in B", "are ok in A and not in B",
        [](const ComparedCase& c) { return c.change == Change::broken; }, inB);
    add(
        "failed in B and was not ok in A", "failed in B and were not ok in A",
        [](const ComparedCase& c) { return c.change != Change::broken && c.b.status == "failed"; }, inB);
    if (!allowMissing)
        add(
            "is ok in A and missing in B", "are ok in A and missing in B",
            [](const ComparedCase& c) { return c.change == Change::onlyA && c.a.status == "ok"; }, nothing);
    add(
        "is not timed in both files", "are not timed in both files",
        [](const ComparedCase& c) { return c.change == Change::untimed; }, nothing);
    add(
        "has too few samples to be compared", "have too few samples to be compared",
        [](const ComparedCase& c) { return c.change == Change::unknown; }, nothing);
    const bool compared =
        std::ranges::any_of(comparison.cases, [](const ComparedCase& c) { return c.ratio.has_value(); });
    if (!compared && lines.empty()) lines.push_back("no case was compared: A and B have none that is timed in both");
    return lines;
}

Json comparisonJson(const Comparison& comparison) {
    Json cases = Json::array();
    for (const ComparedCase& compared : comparison.cases) {
        const auto& interval = compared.interval;
        cases.push_back({{"id", compared.id},
                         {"direction", compared.direction.empty() ? Json(nullptr) : Json(compared.direction)},
                         {"change", changeName(compared.change)},
                         {"a", sideJson(compared.a)},
                         {"b", sideJson(compared.b)},
                         {"ratio", compared.ratio ? Json(*compared.ratio) : Json(nullptr)},
                         {"interval", interval ? Json{interval->low, interval->high} : Json(nullptr)}});
    }
    return {{"schema", kCompareSchema},
            {"differences", comparison.differences},
            {"noise_floor", comparison.noiseFloor},
            {"noise_floor_measured", comparison.noiseFloorMeasured},
            {"placement_covered", comparison.placementCovered},
            {"paired_by", comparison.pairedBy},
            {"alone", comparison.alone},
            {"times", comparison.inBatches ? kBatches : kFrames},
            {"cases", cases}};
}

// "A → B is codec: uc → pc, 7 of 9 pairs with times: B/A from 0.9812 to 1.1201, median 1.0503"
static std::string directionText(const std::vector<const ComparedCase*>& pairs) {
    std::string text = std::format("A → B is {}, {}", pairs.front()->direction, counted(pairs.size(), "pair"));
    std::vector<double> ratios;
    bool software = false;
    for (const ComparedCase* pair : pairs) {
        if (!pair->ratio) continue;
        ratios.push_back(*pair->ratio);
        software = software || pair->a.software || pair->b.software;
    }
    if (ratios.empty()) return text;
    if (ratios.size() < pairs.size())
        text = std::format("A → B is {}, {} of {} pairs with times", pairs.front()->direction, ratios.size(),
                           pairs.size());
    const Summary summary = summarise(ratios);
    const char* mark = software ? "*" : "";
    return text + std::format(": B/A from {:.4f}{} to {:.4f}{}, median {:.4f}{}", summary.min, mark, summary.max, mark,
                              summary.median, mark);
}

// The cases of one direction, under a heading for each Change.
static std::string groupsText(const std::vector<const ComparedCase*>& cases, size_t width) {
    std::string text;
    const ComparedCase* previous = nullptr;
    for (const ComparedCase* compared : cases) {
        if (!previous || previous->change != compared->change) {
            const auto count = std::ranges::count_if(
                cases, [&](const ComparedCase* other) { return other->change == compared->change; });
            const std::string heading = std::format("{} ({})", headingOf(compared->change), count);
            text += compared->ratio ? std::format("\n{:<{}}  {:>10} {:>10}   {:>7}  {}\n", heading, width + 2, "A ms",
                                                  "B ms", "B/A", "95 % interval")
                                    : "\n" + heading + "\n";
        }
        text += lineText(*compared, width);
        previous = compared;
    }
    return text;
}

std::string comparisonText(const Comparison& comparison, size_t width) {
    std::string text;
    for (const std::string& difference : comparison.differences)
        text += wrapText("differs: " + difference, width, 9) + "\n";
    if (!comparison.drawn.empty()) {
        text += wrapText("! " + drawnText(comparison), width, 2) + "\n";
    }
    text +=
        std::format("noise floor: {:.2f} %{}\n", comparison.noiseFloor * 100,
                    comparison.noiseFloorMeasured ? "" : " (0.30 % stands for a file that did not measure its own)");
    if (comparison.inBatches) text += "times: of a frame within a batch\n";
    size_t idWidth = 4;
    bool software = false;
    for (const ComparedCase& compared : comparison.cases) {
        if (compared.ratio) idWidth = std::max(idWidth, terminalText(compared.id, kLongestMessage).size());
        software = software || compared.a.software || compared.b.software;
    }
    for (auto begin = comparison.cases.begin(); begin != comparison.cases.end();) {
        std::vector<const ComparedCase*> cases;
        const std::string direction = begin->direction;
        for (; begin != comparison.cases.end() && begin->direction == direction; ++begin) cases.push_back(&*begin);
        if (!direction.empty()) text += "\n" + wrapText(directionText(cases), width, 2) + "\n";
        text += groupsText(cases, idWidth);
    }
    if (comparison.alone > 0)
        text += std::format("\n{} {} of A without a partner\n", counted(comparison.alone, "case"),
                            comparison.alone == 1 ? "is" : "are");
    const bool hardware = std::ranges::any_of(
        comparison.cases, [](const ComparedCase& compared) { return compared.ratio && !compared.b.software; });
    if (hardware && !comparison.placementCovered)
        text +=
            "where memory lies is in no interval of cases that are kept in place: bench --placement fresh covers it\n";
    if (software) text += "* software driver: shows that the path works, not how fast a GPU is\n";
    return text;
}

}  // namespace skinbench
