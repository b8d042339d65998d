// The answers of a run as the last lines of its table.
#include <algorithm>
#include <array>
#include <format>
#include <numeric>

#include "common/core/text.h"
#include "common/report/answers.h"
#include "common/report/labels.h"

#include <nlohmann/json.hpp>

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

struct Writer {
    const Json& results;
    const SharedParts& shared;
    size_t width = 0;  // 0: a file or a pipe
};

std::string textOf(const Json& value) {
    return value.is_string() ? terminalText(value.get<std::string>(), kLongestMessage) : std::string();
}

const char* markOf(const Json& answer) { return answer["software"] == true ? "*" : ""; }

// "0.853* (0.851 to 0.855)"
std::string ratioText(const Json& answer) {
    std::string text = std::format("{:.3f}{}", answer["ratio"].get<double>(), markOf(answer));
    const Json& interval = answer["interval"];
    if (interval.is_array())
        text += std::format(" ({:.3f} to {:.3f})", interval[0].get<double>(), interval[1].get<double>());
    return text;
}

// "vk-ext/mesh-ci" of a whole id, which is printed whole where lines may be long.
std::string nameOf(const Writer& writer, const Json& answer, const char* key) {
    const std::string id = textOf(answer[key]);
    if (!writer.width) return id;
    return id.substr(0, id.find('/') + 1) + shortName(id, withWork(writer.shared, textOf(answer["work"])));
}

std::string timeText(const Json& answer, const std::string& name) {
    return std::format("{}, {:.3f} ms{}", name, answer["first_ms"].get<double>(), markOf(answer));
}

std::string fastestText(const Writer& writer, const Json& answer) {
    std::string text = "fastest: " + timeText(answer, textOf(answer["first"]));
    const std::string baseline = textOf(writer.results["baseline"]);
    if (answer["first"] == answer["second"]) return text + ", itself the baseline";
    if (answer["ratio"].is_null()) return text;
    text += "; " + ratioText(answer) + " of " + (findVariant(baseline) ? baseline + ", same API" : "the baseline");
    return text + (answer["first_is"] == "same" ? ", not told apart" : "");
}

std::string tooFew() { return std::format("too few frames, {} are needed", kFewestSamples); }

std::string nextText(const Writer& writer, const Json& answer) {
    return (answer["first_is"] == "same" ? "not told apart from it: " : "next: ") +
           timeText(answer, nameOf(writer, answer, "first")) + "; " + ratioText(answer) + " of that" +
           (answer["first_is"] == "unknown" ? ", by " + tooFew() : "");
}

// "mesh against compute" with a ratio below 1 is "mesh faster".
std::string verdictText(const Json& answer) {
    const std::string question = textOf(answer["question"]), between = " against ";
    const size_t place = question.find(between);
    if (answer["first_is"] == "same") return "not told apart";
    if (answer["first_is"] == "unknown") return tooFew();
    return (answer["first_is"] == "faster" ? question.substr(0, place) : question.substr(place + between.size())) +
           " faster";
}

using Cells = std::array<std::string, 4>;

Cells cellsOf(const Writer& writer, const Json& answer) {
    const std::string on = textOf(answer["on"]);
    return {textOf(answer["question"]) + (on.empty() ? "" : ", " + on), ratioText(answer), verdictText(answer),
            nameOf(writer, answer, "first") + " : " + nameOf(writer, answer, "second")};
}

bool isPair(const Json& answer) { return textOf(answer["question"]).contains(" against "); }

// The last column, the two cases, is left out where a line would get too long.
struct Widths {
    std::array<size_t, 4> of{};
    size_t columns = 4;
};

Widths widthsOf(const Writer& writer, const Json& answers) {
    Widths widths;
    for (const Json& answer : answers) {
        if (!isPair(answer)) continue;
        const Cells cells = cellsOf(writer, answer);
        for (size_t i = 0; i < cells.size(); ++i) widths.of[i] = std::max(widths.of[i], cells[i].size());
    }
    const size_t whole = std::accumulate(widths.of.begin(), widths.of.end(), size_t{6});
    if (writer.width && whole > writer.width) widths.columns = 3;
    return widths;
}

std::string pairText(const Widths& widths, const Cells& cells) {
    std::string text;
    for (size_t i = 0; i < widths.columns; ++i)
        text += std::format("{}{:<{}}", i == 0 ? "" : "  ", cells[i], widths.of[i]);
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
}

}  // namespace

std::string answersText(const Json& results, const SharedParts& shared, size_t width) {
    const Writer writer{results, shared, width};
    std::string text, work;
    bool software = false, several = false;
    const Json answers = results.value("answers", Json::array());
    const Widths widths = widthsOf(writer, answers);
    for (const Json& answer : answers) several = several || answer["work"] != answers.front()["work"];
    for (const Json& answer : answers) {
        const std::string question = textOf(answer["question"]);
        if (question == "fastest") text += several ? "\n" + textOf(answer["work"]) + ":\n" : "\n";
        if (question == "fastest")
            text += wrapText(fastestText(writer, answer), width, 4) + "\n";
        else if (question == "next")
            text += wrapText(nextText(writer, answer), width, 4) + "\n";
        else
            text += pairText(widths, cellsOf(writer, answer));
        software = software || answer["software"] == true;
    }
    for (const Json& row : results["cases"])
        software = software || (isSoftware(results, row) && !row["gpu_ms"].is_null());
    if (std::ranges::any_of(answers, isPair))
        text +=
            wrapText(
                "Ratios are of the fastest case of each, with 95 % intervals; not told apart: the interval "
                "holds 1, or the difference is within the noise floor. Of stages, palette counts as vertex, mesh-ci "
                "as mesh, compute-cull and compute-mesh as compute.",
                width, 0) +
            "\n";
    if (results.contains("noise_floor") && results["noise_floor"].is_number())
        text += std::format("equal cases differ by {:.2f} % at the most: smaller differences mean nothing\n",
                            results["noise_floor"].get<double>() * 100);
    if (software)
        text += wrapText("* software driver: these times show that the paths work; they compare nothing about a GPU",
                         width, 2) +
                "\n";
    return text;
}

}  // namespace skinbench
