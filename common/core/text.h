// Text that is not ours (names in files, drivers, command lines) on its way to a terminal, a CSV file, a JSON file and
// a page: one function for each, so that none of them can be steered by what it shows. All of them take any bytes; what
// is not UTF-8 becomes U+FFFD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "common/core/result.h"

namespace skinbench {

// One line: control characters, line separators and marks that turn the direction of text are written as escapes
// ("\n", "\x1b", "\u202e").
std::string terminalText(std::string_view text);

// terminalText with at most `most` characters (code points); what is cut out of the middle is shown as "…".
std::string terminalText(std::string_view text, size_t most);

// A line broken at spaces into lines of at most `width` characters, the second and later ones behind `indent` spaces. A
// longer word stays whole, and with width 0 the line does.
std::string wrapText(std::string_view line, size_t width, size_t indent = 0);

// "1 case", "2 cases"; `many` is for words that do not just end in s.
std::string counted(uint64_t count, const std::string& one, const std::string& many = {});

inline constexpr size_t kLongestMessage = 600;  // characters of one line on standard error

// One field as RFC 4180 quotes it. A spreadsheet takes what begins with = + - @, a tab or a carriage return for a
// formula: such text gets an apostrophe in front, unless it is a number.
std::string csvText(std::string_view text);

// Content or a quoted attribute of HTML.
std::string htmlText(std::string_view text);

// Never throws for what a string holds; control characters that JSON allows raw are escaped as well. Recurses as deep
// as the tree: see checkJsonShape. Indent -1: one line.
std::string dumpJson(const nlohmann::ordered_json& json, int indent = 1);
std::string dumpJson(const nlohmann::json& json, int indent = 1);

// Bounds of what a JSON text may ask of its reader: nlohmann's dump recurses, and its ordered objects search linearly.
struct JsonLimits {
    int depth = 100;
    size_t keys = 1000;  // of one object
};

// Before parsing; the error is a sentence without the file's name.
Result<void> checkJsonShape(std::string_view text, const JsonLimits& limits = {});

}  // namespace skinbench
