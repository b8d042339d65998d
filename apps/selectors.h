// Tables of words, shared by the files that read the command line.
#pragma once

#include <algorithm>
#include <format>
#include <string>
#include <vector>

#include "apps/apps.h"

namespace skinbench {

template <class Value>
struct Word {
    const char* name;
    Value value;
};

template <class Row>
std::string tableNames(const std::vector<Row>& rows) {
    std::string names;
    for (const Row& row : rows) names += (names.empty() ? "" : ", ") + std::string(row.name);
    return names;
}

// The rows that the words name, or all rows for no words.
template <class Row>
Result<std::vector<const Row*>> chosenRows(const std::vector<Row>& rows, const std::vector<std::string>& words,
                                           const char* kind) {
    std::vector<const Row*> chosen;
    if (words.empty())
        for (const Row& row : rows) chosen.push_back(&row);
    for (const std::string& word : words) {
        auto row = std::ranges::find_if(rows, [&](const Row& candidate) { return word == candidate.name; });
        if (row == rows.end()) return inputError(std::format("no {} '{}'; there is {}", kind, word, tableNames(rows)));
        if (std::ranges::find(chosen, &*row) == chosen.end()) chosen.push_back(&*row);
    }
    return chosen;
}

// "A<separator>B", both from 1 to `most`.
Result<std::pair<uint32_t, uint32_t>> parsePair(const std::string& text, char separator, const char* what,
                                                uint32_t most);

// Whether `auto` is to choose the route; an error where it is named beside others.
Result<bool> namesAuto(const std::vector<std::string>& routes);

// The raster modes of the preset that was named, else of the usual one.
std::vector<std::string> presetRasters(const Selectors& selectors);

// Names of a list's words, for help texts and messages.
std::string presetWords();
std::string geometryWords();

// Every preset in a line, and which of them a device takes by itself.
std::string presetTable();

// The word that was probably meant: the nearest by few edits, or the only one that begins so; empty: none is near.
std::string nearestWord(const std::string& word, const std::vector<std::string>& words);

}  // namespace skinbench
