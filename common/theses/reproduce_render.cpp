#include <algorithm>
#include <format>

#include "common/core/text.h"
#include "common/core/version.h"
#include "common/plans/case.h"
#include "common/report/report.h"
#include "common/theses/reproduce_parts.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

const char* kStyle = R"css(
:root { color-scheme: light dark; --line: #8884; --soft: #8882; --bar: #2a78d6; }
* { box-sizing: border-box; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 0 auto; max-width: 1280px; padding: 24px 16px 64px; }
h1 { font-size: 1.5rem; margin: 0 0 4px; } h2 { font-size: 1.15rem; margin: 40px 0 4px; }
p, ul { margin: 4px 0 8px; max-width: 90ch; } .note { opacity: .75; font-size: 14px; }
nav { columns: 22rem; margin: 16px 0; font-size: 14px; } nav a { display: block; }
.wide { overflow: auto; max-height: 80vh; margin-top: 8px; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: 14px; }
th, td { border-bottom: 1px solid var(--line); padding: 4px 10px; text-align: left; white-space: nowrap; }
th { font-weight: 600; position: sticky; top: 0; background: Canvas; } td.n, th.n { text-align: right; }
td.none { opacity: .6; } td.own { font-weight: 600; } td.text { white-space: normal; min-width: 14rem; }
.bar { display: inline-block; background: var(--bar); height: 10px; border-radius: 0 3px 3px 0; }
code { font-size: 13px; } td.chart { width: 140px; min-width: 140px; }
@media print { .wide { max-height: none; overflow: visible; } th { position: static; } }
)css";

std::string heading(const Reproduction& all) { return "\"" + all.title + "\" rebuilt by skinbench"; }

std::string displayName(const std::string& thesis) {
    std::string name = thesis;
    if (!name.empty()) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
    return name;
}

// --- where it was measured -------------------------------------------------------------------------------------

std::string apiName(const std::string& key) {
    for (const Route& route : routes())
        if (key == namesOf(route.api).key) return namesOf(route.api).name;
    return key;
}

// Sentences, the same for every format.
std::vector<std::string> contextLines(const Reproduction& all, const std::vector<ReproduceScene>& scenes) {
    std::vector<std::string> lines = {all.author + "."};
    std::string names;
    for (const ReproduceScene& scene : scenes) names += (names.empty() ? "" : ", ") + sceneOf(scene);
    lines.push_back("Scenes: " + names + ".");
    const auto runs = runsOf(scenes);
    if (runs.empty()) return lines;
    const Json& results = runs.front()->results;
    for (const Json& device : results["devices"])
        lines.push_back(std::format("{}: {}, {}{}.", apiName(device["route_api"].get<std::string>()),
                                    deviceLabel(device), device["driver"].get<std::string>(),
                                    device.value("software", false)
                                        ? " - software driver: shows that the path works, not how fast a GPU is"
                                        : ""));
    const Json& settings = results["settings"];
    lines.push_back(std::format("Copies: {}, at {}x{}; frames a case: {}; rounds: {}.", dumpJson(settings["copies"]),
                                dumpJson(settings["width"]), dumpJson(settings["height"]), dumpJson(settings["frames"]),
                                dumpJson(settings["rounds"])));
    lines.push_back(std::format("{}; {}; skinbench {} ({}).", results["host"]["os"].get<std::string>(),
                                results["host"]["cpu"].get<std::string>(),
                                results["tool"]["version"].get<std::string>(),
                                results["tool"]["revision"].get<std::string>()));
    std::set<std::string> told;
    for (const ReproduceRun* run : runs)
        for (const Json& warning : run->results.value("warnings", Json::array()))
            if (warning.is_string() && told.insert(warning).second)
                lines.push_back("Warning: " + warning.get<std::string>() + ".");
    return lines;
}

// --- rows as text ----------------------------------------------------------------------------------------------

std::vector<std::string> columnsOf(const ReproduceTable& table, const std::string& published) {
    std::vector<std::string> columns = table.labels;
    columns.push_back("ours: " + table.measure);
    columns.push_back(published);
    columns.push_back("ours / published");
    columns.insert(columns.end(), table.details.begin(), table.details.end());
    return columns;
}

std::vector<Figure> figuresOf(const ReproduceRow& row) {
    std::vector<Figure> figures = {row.ours, row.published, row.ratio};
    figures.insert(figures.end(), row.details.begin(), row.details.end());
    return figures;
}

// --- Markdown --------------------------------------------------------------------------------------------------

// Text that must not be taken for markup; a table cell is one line.
std::string markdown(const std::string& text) {
    std::string safe;
    for (char c : terminalText(text)) {
        if (c == '<')
            safe += "&lt;";
        else if (c == '&')
            safe += "&amp;";
        else if (std::string("\\`*_[]|#~").find(c) != std::string::npos)
            safe += std::string("\\") + c;
        else
            safe += c;
    }
    return safe;
}

// Our own sentences, in which words between backticks are code.
std::string markdownProse(const std::string& text) {
    std::string prose = markdown(text);
    for (size_t at = 0; (at = prose.find("\\`", at)) != std::string::npos;) prose.erase(at, 1);
    return prose;
}

std::string markdownLine(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + cell + " |";
    return line + "\n";
}

std::string tableMarkdown(const ReproduceTable& table, const std::string& published) {
    std::string text = "\n## " + markdown(table.title) + "\n\n" + markdownProse(table.caption) +
                       "\n\nPublished: " + markdownProse(table.source) + "\n\n";
    if (table.rows.empty())
        text += "Nothing to show.\n";
    else {
        std::vector<std::string> cells, rules;
        for (const std::string& column : columnsOf(table, published)) {
            cells.push_back(markdown(column));
            rules.push_back(rules.size() < table.labels.size() ? "---" : "---:");
        }
        text += markdownLine(cells) + markdownLine(rules);
        for (const ReproduceRow& row : table.rows) {
            cells.clear();
            for (const std::string& label : row.labels) cells.push_back(markdown(label));
            for (const Figure& figure : figuresOf(row))
                cells.push_back(figure.text.empty() ? "–" : markdown(figure.text));
            text += markdownLine(cells);
        }
    }
    for (const std::string& note : table.notes) text += "\n" + markdown(note) + "\n";
    return text;
}

// --- HTML ------------------------------------------------------------------------------------------------------

std::string htmlProse(const std::string& text) {
    std::string prose;
    bool inside = false;
    for (char c : htmlText(text)) {
        if (c != '`')
            prose += c;
        else
            prose += (inside = !inside) ? "<code>" : "</code>";
    }
    return prose + (inside ? "</code>" : "");
}

double largestOf(const ReproduceTable& table) {
    double largest = 0;
    for (const ReproduceRow& row : table.rows)
        if (row.ours.value) largest = std::max(largest, row.ours.value->high);
    return largest;
}

std::string rowHtml(const ReproduceRow& row, bool bars, double largest) {
    std::string text = "<tr>";
    for (const std::string& label : row.labels) text += "<td>" + htmlText(label) + "</td>";
    size_t place = 0;
    for (const Figure& figure : figuresOf(row)) {
        const bool number = figure.value.has_value();
        text += std::format("<td class=\"n{}{}{}\">{}</td>", number ? "" : " none", place == 0 && number ? " own" : "",
                            figure.text.size() > 40 ? " text" : "", figure.text.empty() ? "–" : htmlText(figure.text));
        if (bars && place++ == 0)
            text += std::format("<td class=chart aria-hidden=true><span class=bar style=\"width:{:.1f}%\"></span></td>",
                                number && largest > 0 ? 100 * figure.value->high / largest : 0.0);
        else if (!bars)
            ++place;
    }
    return text + "</tr>\n";
}

std::string tableHtml(const ReproduceTable& table, const std::string& published) {
    std::string text =
        std::format("<section id=\"{}\"><h2>{}</h2>\n<p>{}</p><p class=note>Published: {}</p>\n", htmlText(table.id),
                    htmlText(table.title), htmlProse(table.caption), htmlProse(table.source));
    if (table.rows.empty()) {
        text += "<p>Nothing to show.</p>\n";
    } else {
        text += "<div class=wide tabindex=0><table><thead><tr>";
        size_t place = 0;
        for (const std::string& column : columnsOf(table, published)) {
            text += std::format("<th{}>{}</th>", place < table.labels.size() ? "" : " class=n", htmlText(column));
            if (table.bars && place == table.labels.size()) text += "<th aria-hidden=true></th>";
            ++place;
        }
        text += "</tr></thead><tbody>\n";
        const double largest = largestOf(table);
        for (const ReproduceRow& row : table.rows) text += rowHtml(row, table.bars, largest);
        text += "</tbody></table></div>\n";
    }
    for (const std::string& note : table.notes) text += "<p class=note>" + htmlText(note) + "</p>\n";
    return text + "</section>\n";
}

std::string slipsHtml(const Reproduction& all) {
    std::string text =
        "<section id=slips><h2>Known slips</h2>\n<p>Every figure here was computed when this page was written.</p>\n"
        "<div class=wide tabindex=0><table><thead><tr><th>where</th><th>printed</th><th>arithmetic</th><th>to follow"
        "</th></tr></thead><tbody>\n";
    for (const Slip& slip : all.slips)
        text += std::format(
            "<tr><td class=text>{}</td><td class=text>{}</td><td class=text>{}</td><td class=text>{}</td>"
            "</tr>\n",
            htmlText(slip.where), htmlText(slip.printed), htmlText(slip.arithmetic), htmlProse(slip.follow));
    return text + "</tbody></table></div></section>\n";
}

// --- JSON ------------------------------------------------------------------------------------------------------

// A number, [low, high], a word, or null.
Json figureJson(const Figure& figure) {
    if (!figure.value) return figure.text.empty() ? Json(nullptr) : Json(figure.text);
    if (figure.value->low == figure.value->high) return figure.value->low;
    return Json::array({figure.value->low, figure.value->high});
}

Json rowJson(const ReproduceTable& table, const ReproduceRow& row) {
    Json labels = Json::object(), details = Json::object();
    for (size_t i = 0; i < table.labels.size(); ++i) labels[table.labels[i]] = row.labels[i];
    for (size_t i = 0; i < row.details.size(); ++i) details[table.details[i]] = figureJson(row.details[i]);
    return {{"labels", labels},
            {"ours", figureJson(row.ours)},
            {"published", row.published.value ? figureJson(row.published) : Json(nullptr)},
            {"published_text", row.published.text},
            {"ratio", figureJson(row.ratio)},
            {"software", row.ours.software},
            {"details", details}};
}

Json tableJson(const ReproduceTable& table) {
    Json rows = Json::array();
    for (const ReproduceRow& row : table.rows) rows.push_back(rowJson(table, row));
    return {{"id", table.id},
            {"title", table.title},
            {"source", table.source},
            {"caption", table.caption},
            {"measure", table.measure},
            {"notes", table.notes},
            {"rows", rows}};
}

}  // namespace

std::string reproduceMarkdown(const Reproduction& all, const std::vector<ReproduceScene>& scenes) {
    std::string text = "# " + markdown(heading(all)) + "\n\n";
    for (const std::string& line : contextLines(all, scenes)) text += "- " + markdown(line) + "\n";
    text += "\nWhat is not available of the publication:\n\n";
    for (const std::string& line : all.unavailable) text += "- " + markdown(line) + "\n";
    for (const ReproduceTable& table : all.tables) text += tableMarkdown(table, displayName(all.thesis));
    text += "\n## Known slips\n\nEvery figure here was computed when this page was written.\n\n";
    text += "| where | printed | arithmetic | to follow |\n|---|---|---|---|\n";
    for (const Slip& slip : all.slips)
        text += markdownLine(
            {markdown(slip.where), markdown(slip.printed), markdown(slip.arithmetic), markdownProse(slip.follow)});
    return text;
}

std::string reproduceHtml(const Reproduction& all, const std::vector<ReproduceScene>& scenes) {
    std::string text =
        "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
        "content=\"width=device-width, initial-scale=1\"><title>" +
        htmlText(heading(all)) + "</title><style>" + std::string(kStyle) + "</style></head><body>\n<h1>" +
        htmlText(heading(all)) + "</h1>\n";
    for (const std::string& line : contextLines(all, scenes)) text += "<p>" + htmlText(line) + "</p>\n";
    text += "<nav aria-label=Tables>";
    for (const ReproduceTable& table : all.tables)
        text += std::format("<a href=\"#{}\">{}</a>", htmlText(table.id), htmlText(table.title));
    text += "<a href=\"#slips\">Known slips</a></nav>\n<h2>What is not available of the publication</h2>\n<ul>";
    for (const std::string& line : all.unavailable) text += "<li>" + htmlText(line) + "</li>";
    text += "</ul>\n";
    for (const ReproduceTable& table : all.tables) text += tableHtml(table, displayName(all.thesis));
    return text + slipsHtml(all) + "</body></html>\n";
}

Json reproduceJson(const Reproduction& all, const std::vector<ReproduceScene>& scenes) {
    Json tables = Json::array(), slips = Json::array(), runs = Json::array(), names = Json::array();
    for (const ReproduceTable& table : all.tables) tables.push_back(tableJson(table));
    for (const Slip& slip : all.slips)
        slips.push_back({{"where", slip.where},
                         {"printed", slip.printed},
                         {"arithmetic", slip.arithmetic},
                         {"follow", slip.follow}});
    for (const ReproduceScene& scene : scenes) names.push_back(sceneOf(scene));
    for (const ReproduceRun* run : runsOf(scenes)) runs.push_back(run->results);
    return {{"schema", kReproduceSchema},
            {"tool", {{"version", SKINBENCH_VERSION}, {"revision", SKINBENCH_REVISION}}},
            {"thesis", {{"name", all.thesis}, {"title", all.title}, {"author", all.author}}},
            {"scenes", names},
            {"unavailable", all.unavailable},
            {"tables", tables},
            {"slips", slips},
            {"runs", runs}};
}

std::string reproduceText(const Reproduction& all) {
    std::string text;
    bool software = false;
    for (const ReproduceTable& table : all.tables) {
        if (std::ranges::none_of(table.rows, &ReproduceRow::headline)) continue;
        text += std::format("{}{} ({})\n", text.empty() ? "" : "\n", table.title, table.measure);
        text += std::format("  {:<64} {:>12} {:>22} {:>18}\n", "", "ours", "published", "ours / published");
        for (const ReproduceRow& row : table.rows) {
            if (!row.headline) continue;
            std::string name;
            for (const std::string& label : row.labels) name += (name.empty() ? "" : ", ") + terminalText(label);
            auto cell = [](const Figure& figure) { return figure.text.empty() ? std::string("-") : figure.text; };
            text += std::format("  {:<64} {:>12} {:>22} {:>18}\n", name, cell(row.ours), cell(row.published),
                                cell(row.ratio));
            software = software || row.ours.software;
        }
    }
    if (software) text += "* software driver: shows that the path works, not how fast a GPU is\n";
    return text;
}

}  // namespace skinbench
