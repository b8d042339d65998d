// The tables and figures of the two theses, rebuilt from our own instruments, with what the theses print beside them.
//
// Sizes, counts and errors are given as they are, times as ratios to a named case of the same run, because no machine
// of ours is theirs. A figure that is not known is "not available" (published.h), one that no route gave "not
// measured"; neither is ever estimated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/report/inspect.h"
#include "common/scene/scene.h"
#include "common/theses/published.h"

namespace skinbench {

inline constexpr const char* kReproduceSchema = "skinbench-reproduce/1";

// --- what goes in ----------------------------------------------------------------------------------------------

// One call of runBench, as resultsJson gives it.
struct ReproduceRun {
    Geometry geometry = Geometry::welded;
    bool cacheOrder = true;
    nlohmann::ordered_json results;
};

// Kimmersdorfer tables 2.1 and 2.2 of one scene, one vertex a triangle corner. `floor` is what the thesis prints of
// positions, `nearest` what it prints of normals; the other one is what its program stores, or ours. In the units of
// attributes.h.
struct RoundedErrors {
    SceneStats stats;
    std::map<int, ErrorFigure> positionFloor, positionNearest;  // bits to error
    struct Normals {
        ErrorFigure euclidean;  // before renormalisation
        ErrorFigure spherical, octahedral;
    } normalFloor, normalNearest;
};
Result<RoundedErrors> roundedErrors(const Scene& stored);

struct ReproduceScene {
    Inspection inspection;
    std::optional<RoundedErrors> errors;  // for Kimmersdorfer
    std::vector<ReproduceRun> runs;
};

// --- what comes out --------------------------------------------------------------------------------------------

// One cell. `value` is what the JSON holds; a cell with a word in place of a number has none. No text: does not apply.
struct Figure {
    std::string text;
    std::optional<Range> value;
    bool software = false;  // a time of a software driver: marked in the text, and never compared with a published one
};

struct ReproduceRow {
    std::vector<std::string> labels;
    Figure ours, published, ratio;  // ratio: ours / published
    std::vector<Figure> details;
    bool headline = false;  // also in the short table
};

struct ReproduceTable {
    std::string id;      // "table-4.3"
    std::string title;   // "Table 4.3: …"
    std::string source;  // where the published figures are from, or why there are none
    std::string caption;
    std::vector<std::string> labels;   // headings of ReproduceRow::labels
    std::string measure;               // heading of `ours`, with its unit
    std::vector<std::string> details;  // headings of ReproduceRow::details
    std::vector<ReproduceRow> rows;
    std::vector<std::string> notes;
    bool bars = false;  // the page draws `ours` as bars
};

// A known slip of the publication. Every figure in `arithmetic` is computed.
struct Slip {
    std::string where;
    std::string printed;
    std::string arithmetic;
    std::string follow;  // what to take instead
};

struct Reproduction {
    std::string thesis;  // "torabi", "kimmersdorfer"
    std::string title, author;
    std::vector<ReproduceTable> tables;
    std::vector<Slip> slips;
    std::vector<std::string> unavailable;  // one sentence each: what the theses hold that is not known here, and why
};

// The scenes were inspected with every CiKey and the default limits, and ran the cases that apps/cmd_reproduce.cpp
// lists. Runs or cases that are missing leave rows out.
Reproduction reproduceTorabi(const std::vector<ReproduceScene>& scenes);
Reproduction reproduceKimmersdorfer(const std::vector<ReproduceScene>& scenes);

// --- how it is written (reproduce_render.cpp) ------------------------------------------------------------------

std::string reproduceMarkdown(const Reproduction& reproduction, const std::vector<ReproduceScene>& scenes);
std::string reproduceHtml(const Reproduction& reproduction, const std::vector<ReproduceScene>& scenes);
nlohmann::ordered_json reproduceJson(const Reproduction& reproduction, const std::vector<ReproduceScene>& scenes);

// The headline rows, fixed width, for a terminal.
std::string reproduceText(const Reproduction& reproduction);

}  // namespace skinbench
