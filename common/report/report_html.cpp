#include "common/core/text.h"
#include "common/report/columns.h"

namespace skinbench {

// The page of common/report/page with its style, scripts and charts; CMake writes it.
extern const char kReportPage[];

using Json = nlohmann::ordered_json;

static std::string replaced(const std::string& text, const std::string& what, const std::string& by) {
    std::string result;
    size_t from = 0;
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, from)) {
        result += text.substr(from, at - from) + by;
        from = at + what.size();
    }
    return result + text.substr(from);
}

// JSON has '<' within strings only, and there it may be written as \u003c, so nothing ends the element early.
static std::string jsonElement(const std::string& attributes, const Json& json) {
    const std::string text = dumpJson(json, -1);
    return "<script type=\"application/json\" " + attributes + ">" + replaced(text, "<", "\\u003c") + "</script>\n";
}

static std::string resultsElement(const Json& results, const std::string& name) {
    return jsonElement("class=\"results\" data-name=\"" + htmlText(name) + "\"", results);
}

std::string reportHtml(const std::vector<Json>& results, const std::vector<std::string>& names) {
    static const std::string page = kReportPage, place = "{{results}}";
    Json drawn = Json::array();
    for (const auto& [group, key] : drawnFacts()) drawn.push_back({{"group", group}, {"key", key}});
    std::string elements = jsonElement(
        "id=\"tables\"", {{"routes", routeTableJson()}, {"columns", columnsJson()}, {"drawn", std::move(drawn)}});
    for (size_t i = 0; i < results.size(); ++i)
        elements += resultsElement(results[i], i < names.size() ? names[i] : std::string());
    const size_t at = page.find(place);
    return page.substr(0, at) + elements + page.substr(at + place.size());
}

}  // namespace skinbench
