#include "common/theses/reproduce_parts.h"

#include <algorithm>
#include <format>
#include <numeric>

#include "common/core/text.h"
#include "common/report/report.h"

namespace skinbench {

using Json = nlohmann::ordered_json;

std::string wholeNumber(double value) { return std::format("{:.0f}", value); }
std::string oneDigit(double value) { return std::format("{:.1f}", value); }
std::string twoDigits(double value) { return std::format("{:.2f}", value); }
std::string threeDigits(double value) { return std::format("{:.3f}", value); }
std::string milliseconds(double value) { return std::format("{:.4g}", value); }
std::string scientific(double value) { return std::format("{:.2e}", value); }
std::string percentage(double fraction) { return std::format("{:.1f} %", fraction * 100); }

Figure figureOf(double value, FormatNumber format) { return {format(value), Range{value, value}}; }

Figure figureOf(const Range& range, FormatNumber format) {
    if (range.low == range.high) return figureOf(range.low, format);
    return {format(range.low) + " to " + format(range.high), range};
}

Figure wordFigure(std::string word) { return {std::move(word), {}}; }
Figure notAvailable() { return wordFigure("not available"); }

Figure ratioTo(double ours, const std::optional<Range>& published) {
    if (!published || published->low <= 0) return {};
    return figureOf(Range{ours / published->high, ours / published->low}, threeDigits);
}

Figure ratioTo(const Figure& ours, const std::optional<Range>& published) {
    if (!ours.value || ours.software) return {};
    return ratioTo(ours.value->low, published);
}

CaseKey with(CaseKey key, const CaseKey& more) {
    for (const auto& [name, value] : more) key[name] = value;
    return key;
}

static std::string valueOf(const Json& c, const std::string& name) {
    for (const Json* group : {&c, c.contains("options") ? &c["options"] : nullptr})
        if (group && group->contains(name) && (*group)[name].is_string()) return (*group)[name].get<std::string>();
    return {};
}

const Json* findCase(const Json& results, const CaseKey& key) {
    for (const Json& c : results["cases"])
        if (std::ranges::all_of(key, [&](const auto& word) { return valueOf(c, word.first) == word.second; }))
            return &c;
    return nullptr;
}

std::vector<std::string> valuesOf(const Json& results, const std::string& key) {
    std::vector<std::string> values;
    for (const Json& c : results["cases"])
        if (const std::string value = valueOf(c, key); std::ranges::find(values, value) == values.end())
            values.push_back(value);
    return values;
}

const char* plainRoute(const std::string& route) {
    const Route* const row = findRoute(route);
    SKINBENCH_ASSERT(row);
    const auto plain = std::ranges::find_if(
        routes(), [&](const Route& other) { return other.api == row->api && other.dialect == MeshDialect::none; });
    return plain->name;
}

std::optional<double> medianOf(const Json& c) {
    if (c["gpu_ms"].is_null()) return {};
    return c["gpu_ms"]["median"].get<double>();
}

Figure markedSoftware(Figure figure) {
    figure.software = true;
    figure.text += "*";
    return figure;
}

Figure timeRatio(const Json& results, const Json& c, const Json& base) {
    const auto time = medianOf(c), baseTime = medianOf(base);
    if (!time || !baseTime || *baseTime <= 0) return wordFigure("not measured");
    const Figure ratio = figureOf(*time / *baseTime, threeDigits);
    return isSoftware(results, c) || isSoftware(results, base) ? markedSoftware(ratio) : ratio;
}

static std::optional<Range> intervalOf(const Json& c) {
    if (c["gpu_ms"].is_null() || !c["gpu_ms"].contains("interval")) return {};
    const Json& interval = c["gpu_ms"]["interval"];
    if (!interval.is_array() || interval.size() != 2 || !interval[0].is_number() || !interval[1].is_number()) return {};
    return Range{interval[0].get<double>(), interval[1].get<double>()};
}

Figure ratioInterval(const Json& c, const Json& base) {
    const auto own = intervalOf(c), other = intervalOf(base);
    if (!own || !other || other->low <= 0) return {};
    return figureOf(Range{own->low / other->high, own->high / other->low}, threeDigits);
}

std::vector<std::string> timeNotes(const std::vector<const ReproduceRun*>& runs) {
    bool software = false, intervals = false;
    std::map<std::pair<std::string, std::string>, size_t> left;  // route, reason -> cases
    for (const ReproduceRun* run : runs)
        for (const Json& c : run->results["cases"]) {
            software = software || (medianOf(c) && isSoftware(run->results, c));
            intervals = intervals || intervalOf(c);
            if (c["status"] != "ok")
                ++left[{c["route"].get<std::string>() + " " + c["status"].get<std::string>(),
                        c["reason"].is_string() ? c["reason"].get<std::string>() : "no reason given"}];
        }
    std::vector<std::string> notes;
    if (software)
        notes.push_back(
            "* software driver: shows that the path works, not how fast a GPU is, so no published time is compared "
            "with it.");
    if (intervals)
        notes.push_back("Interval: the smallest and the largest ratio that the 95 % intervals of both medians allow.");
    for (const auto& [what, cases] : left)
        notes.push_back(std::format("{}: {} ({})", what.first, what.second, counted(cases, "case")));
    return notes;
}

std::vector<const ReproduceRun*> runsOf(const std::vector<ReproduceScene>& scenes) {
    std::vector<const ReproduceRun*> runs;
    for (const ReproduceScene& scene : scenes)
        for (const ReproduceRun& run : scene.runs) runs.push_back(&run);
    return runs;
}

const std::string& sceneOf(const ReproduceScene& scene) { return scene.inspection.scene; }

const CodecRow* codecRow(const ReproduceScene& scene, Geometry geometry, const Builder* builder,
                         const std::string& codec) {
    for (const CodecRow& row : scene.inspection.codecs)
        if (row.geometry == geometry && row.builder == builder && row.codec->name == codec) return &row;
    return nullptr;
}

uint64_t layoutBytes(const CodecRow& row, const char* layout) {
    return row.descriptorBytes.at(layout) + row.dataBytes.at(layout);
}

std::vector<double> publishedBlend(const std::string& codec) {
    std::vector<double> bytes;
    for (const PublishedScene& scene : publishedKimmersdorfer().scenes)
        if (const auto row = scene.blendBytes.find(codec); row != scene.blendBytes.end()) bytes.push_back(row->second);
    return bytes;
}

double meanOf(const std::vector<double>& values) {
    return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace skinbench
