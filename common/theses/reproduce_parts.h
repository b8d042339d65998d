// What the files that rebuild a thesis share: cells, and looking cases up in result files.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/theses/reproduce.h"

namespace skinbench {

// --- cells -----------------------------------------------------------------------------------------------------

using FormatNumber = std::string (*)(double);

std::string wholeNumber(double value);
std::string oneDigit(double value);
std::string twoDigits(double value);
std::string threeDigits(double value);
std::string milliseconds(double value);   // four digits
std::string scientific(double value);     // three digits and the power of ten
std::string percentage(double fraction);  // one digit

Figure figureOf(double value, FormatNumber format);
Figure figureOf(const Range& range, FormatNumber format);
Figure wordFigure(std::string word);
Figure notAvailable();

// ours / published; a range where a range is published. Empty where nothing is, or it is 0.
Figure ratioTo(double ours, const std::optional<Range>& published);

// The same, and empty where `ours` has no value or is the time of a software driver.
Figure ratioTo(const Figure& ours, const std::optional<Range>& published);

// --- cases of a result file ------------------------------------------------------------------------------------

// Values by the keys of a case or of its "options".
using CaseKey = std::map<std::string, std::string>;

CaseKey with(CaseKey key, const CaseKey& more);

// The first case that has these values, or null.
const nlohmann::ordered_json* findCase(const nlohmann::ordered_json& results, const CaseKey& key);

// In the order of their first case.
std::vector<std::string> valuesOf(const nlohmann::ordered_json& results, const std::string& key);

// The route of the same API without mesh shaders.
const char* plainRoute(const std::string& route);

// Median milliseconds a frame; empty where the case has no time.
std::optional<double> medianOf(const nlohmann::ordered_json& c);

// Marks the time of a software driver.
Figure markedSoftware(Figure figure);

// Median over median, marked where a software driver took part.
Figure timeRatio(const nlohmann::ordered_json& results, const nlohmann::ordered_json& c,
                 const nlohmann::ordered_json& base);

// From the 95 % intervals of both medians: the smallest and the largest ratio that they allow. Empty where a case has
// no interval.
Figure ratioInterval(const nlohmann::ordered_json& c, const nlohmann::ordered_json& base);

// Explains the mark, the intervals and what was skipped or failed, as far as they occur in these runs.
std::vector<std::string> timeNotes(const std::vector<const ReproduceRun*>& runs);

std::vector<const ReproduceRun*> runsOf(const std::vector<ReproduceScene>& scenes);

const std::string& sceneOf(const ReproduceScene& scene);

// --- Kimmersdorfer ---------------------------------------------------------------------------------------------

// Null where the inspection has none.
const CodecRow* codecRow(const ReproduceScene& scene, Geometry geometry, const Builder* builder,
                         const std::string& codec);

// Of all meshlets in the layout, data included.
uint64_t layoutBytes(const CodecRow& row, const char* layout);

// Table 4.3 of the scenes that are in it.
std::vector<double> publishedBlend(const std::string& codec);

double meanOf(const std::vector<double>& values);  // 0 of none

std::vector<Slip> kimmersdorferSlips(const std::vector<ReproduceScene>& scenes);

}  // namespace skinbench
