// The options of a case as a table: an axis is a row. From the rows follow the options of the command line, which cases
// a crossing has, a case's id and its parser, the result file's keys and columns, the choices of the report page, the
// keys of every cache, the limit of a case and the list of cases that the tests run.
//
// To add an option: a field of Case, a row in axes.cpp, what the shader or the plan makes of it, a line in
// docs/variants.md.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/plans/case.h"

namespace skinbench {

// What is made anew when two cases differ in an axis. A case is made in this order, each from what lies before it: the
// prepared scene, its meshlets, the vertex records, their encoding, the plan with its shaders, the raster mode.
enum class Changes { scene, meshlets, records, encoding, plan, raster };
const char* changesName(Changes changes);

// An option of the command line; older spellings stay as aliases.
struct AxisOption {
    std::string name{};                  // "vertex-fetch" is --vertex-fetch A,B,…; empty: the axis' name
    std::vector<std::string> aliases{};  // "palette"
    std::string help{};                  // follows the list of words
};

struct Axis {
    std::string name;  // key of a case in result files, column of the CSV: "vertex_fetch"
    AxisOption option;
    Changes changes = Changes::plan;
    std::vector<std::string> words;  // every value, where they can be listed; numbers may have others
    std::string usual;               // the value of a case that names none
    std::string define;              // what shaders see of it, everywhere; empty: nothing
    bool inPath = false;             // a part of the id between slashes, not an option behind a plus
    bool topLevel = false;           // a key of the case itself in result files, else of its `options`
    bool benched = true;             // an option of bench and verify
    bool changesPicture = false;     // two values may draw different pictures
    bool changesWork = false;        // two values are different tasks, whose times are not compared: sameWork
    bool shape = false;              // computes the same in another shape: --shape auto may choose it
    std::string beside;              // the axis that it only means something with: "cull" of "exchange"
    std::string ofLimit;             // the value that limitCase takes; empty: the usual one; kSame: the case's own

    // Whether the axis means something to the case; reads only axes that come before it.
    std::function<bool(const Case&)> applies;
    std::function<std::string(const Case&)> get;
    // An unknown word is an input error that lists what there is.
    std::function<Result<void>(Case&, const std::string&)> set;
    std::function<std::string(const Case&)> defineValue;
    // What a crossing takes where the command line names nothing.
    std::function<std::vector<std::string>(const Case&)> unnamed;
    // The option as ids write it, "unpacked-writes", with several joined by plus; empty: the usual one.
    std::function<std::string(const Case&)> idPart;
    // Takes such a part, or gives false where it is none of this axis.
    std::function<bool(Case&, std::string_view)> readIdPart;
};

inline constexpr const char* kSame = "=";

// In the order of ids. Tests may append rows.
std::vector<Axis>& axisTable();
const std::vector<Axis>& axes();
const Axis* findAxis(std::string_view name);

// What all cases that agree in it share, such as their meshlets or their encoded vertices, as text: the values of every
// axis that changes that or something before it. Two cases with one key have equal bytes.
std::string keyOf(const Case& c, Changes upTo);

// What all cases that must draw one picture share. Raster modes and limits apart.
std::string pictureOf(const Case& c);

// Whether two cases do the same task, so that the faster one is the better one: they agree in every axis that
// changesWork.
bool sameWork(const Case& a, const Case& b);

// The defines of every axis that has one.
Defines definesOf(const Case& c);

// Whether the case's vertex records are the scene's own vertices.
bool storesSceneVertices(const Case& c);

// The stable readable name: route/variant/codec[/builder/layout][+option…], options that are the usual one left out.
std::string caseId(const Case& c);

// The case with that id. An id that no case has is an input error that says which part of it is wrong.
Result<Case> parseCaseId(const std::string& id);

// The same draws with nothing fetched and nothing skinned: what the device needs at least for such meshlets or indices,
// in the case's raster mode. Mesh stages read meshlet descriptors and local indices, vertex stages the index buffer;
// positions follow from numbers (codec `ids`). Meshlets are those of the builder's plain cut, back faces are left to
// the rasteriser, and a copy of `palette` is one draw. Empty for cases that the host skins, for pre-passes, and where
// triangles or meshlets are left out before the draw.
std::optional<Case> limitCase(const Case& c);

// --- crossing --------------------------------------------------------------------------------------------------

// The values that were named, by the name of the axis.
using AxisWords = std::map<std::string, std::vector<std::string>>;

// Every combination of the named values, and of Axis::unnamed where nothing is named, without those that exist on no
// device (a mesh variant on a route without mesh shaders), in the order of the table.
Result<std::vector<Case>> crossCases(const AxisWords& words);

// The same from given cases, over the named axes alone.
Result<std::vector<Case>> crossCases(std::vector<Case> cases, const AxisWords& words);

// What was named and is in none of the cases, one entry for all words of an axis with one reason.
struct Unused {
    std::string axis, option;        // "variant", "--variants"
    std::vector<std::string> words;  // as they were given
    std::string reason;              // "mesh needs vk-ext, vk-nv, gl-ext or gl-nv"
};
std::vector<Unused> unusedWords(const AxisWords& words, const std::vector<Case>& cases);

// The words of an axis with commas between them, for help texts and messages.
std::string wordsOf(const Axis& axis);

}  // namespace skinbench
