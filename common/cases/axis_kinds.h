// The kinds of rows that the table of axes has (axes.cpp): a few words, a number, the rows of another table.
#pragma once

#include <algorithm>
#include <charconv>
#include <format>

#include "common/cases/axes.h"

namespace skinbench {

inline std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

// What is left to say of a row once its values are there.
struct Row {
    std::string name;
    AxisOption option{};
    Changes changes = Changes::plan;
    bool (*applies)(const Case&) = [](const Case&) { return true; };
    std::string noun{};    // in messages; empty: the name
    std::string define{};  // with the field as a number
};

inline Axis startAxis(const Row& row) {
    Axis axis;
    axis.name = row.name;
    axis.option = row.option;
    if (axis.option.name.empty()) {
        axis.option.name = row.name;
        std::ranges::replace(axis.option.name, '_', '-');
    }
    axis.changes = row.changes;
    axis.applies = row.applies;
    axis.define = row.define;
    return axis;
}

inline std::string nounOf(const Row& row) {
    std::string noun = row.noun.empty() ? row.name : row.noun;
    std::ranges::replace(noun, '_', ' ');
    return noun;
}

template <class Value>
struct Word {
    const char* word;
    Value value;
    const char* idPart = "";  // empty: the usual one
};

// An axis of a few words; `field` gives the case's own.
template <class Value>
Axis wordAxis(const Row& row, std::vector<Word<Value>> table, Value& (*field)(Case&)) {
    Axis axis = startAxis(row);
    for (const Word<Value>& word : table) axis.words.push_back(word.word);
    auto find = [table, field](const Case& c) {
        const auto word = std::ranges::find(table, field(const_cast<Case&>(c)), &Word<Value>::value);
        SKINBENCH_ASSERT(word != table.end());
        return *word;
    };
    axis.usual = find(Case{}).word;
    axis.get = [find](const Case& c) { return std::string(find(c).word); };
    axis.defineValue = [find](const Case& c) { return std::to_string(static_cast<int>(find(c).value)); };
    axis.set = [table, field, noun = nounOf(row), there = joined(axis.words)](Case& c, const std::string& text) {
        const auto word = std::ranges::find(table, text, &Word<Value>::word);
        if (word == table.end())
            return Result<void>(inputError(std::format("no {} '{}'; there is {}", noun, text, there)));
        field(c) = word->value;
        return Result<void>{};
    };
    axis.unnamed = [usual = axis.usual](const Case&) { return std::vector{usual}; };
    axis.idPart = [find](const Case& c) { return std::string(find(c).idPart); };
    axis.readIdPart = [table, field](Case& c, std::string_view part) {
        for (const Word<Value>& word : table) {
            if (part.empty() || part != word.idPart) continue;
            field(c) = word.value;
            return true;
        }
        return false;
    };
    return axis;
}

struct Numbers {
    uint32_t least, most;
    const char *before, *after;  // in ids: "group-" and ""
    bool always = false;         // in ids at its usual value too
};

inline std::optional<uint32_t> numberOf(std::string_view text, const Numbers& numbers) {
    uint32_t value = 0;
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool right = failed == std::errc{} && end == text.data() + text.size() && (value == 0 || text.front() != '0');
    return right && value >= numbers.least && value <= numbers.most ? std::optional(value) : std::nullopt;
}

template <class Value>
Axis numberAxis(const Row& row, const Numbers& numbers, Value& (*field)(Case&)) {
    Axis axis = startAxis(row);
    auto get = [field](const Case& c) { return std::to_string(field(const_cast<Case&>(c))); };
    axis.usual = get(Case{});
    axis.get = axis.defineValue = get;
    axis.set = [numbers, field, option = axis.option.name](Case& c, const std::string& text) {
        const auto value = text.empty() ? std::nullopt : numberOf(text, numbers);
        if (!value)
            return Result<void>(inputError(
                std::format("--{} '{}' is not a number from {} to {}", option, text, numbers.least, numbers.most)));
        field(c) = static_cast<Value>(*value);
        return Result<void>{};
    };
    axis.unnamed = [usual = axis.usual](const Case&) { return std::vector{usual}; };
    axis.idPart = [get, numbers, usual = axis.usual](const Case& c) {
        const std::string value = get(c);
        return value == usual && !numbers.always ? std::string() : numbers.before + value + numbers.after;
    };
    axis.readIdPart = [numbers, field](Case& c, std::string_view part) {
        if (!part.starts_with(numbers.before) || !part.ends_with(numbers.after)) return false;
        part.remove_prefix(std::string_view(numbers.before).size());
        part.remove_suffix(std::min(part.size(), std::string_view(numbers.after).size()));
        const auto value = part.empty() ? std::nullopt : numberOf(part, numbers);
        if (value) field(c) = static_cast<Value>(*value);
        return value.has_value();
    };
    return axis;
}

// An axis whose values are the rows of a table, a part of the id's path. `usual` empty: a crossing takes every row.
template <class Table>
Axis rowAxis(const Row& row, const std::vector<Table>& table, const std::string& usual, const Table*& (*field)(Case&)) {
    Axis axis = startAxis(row);
    axis.inPath = axis.topLevel = true;
    for (const Table& entry : table) axis.words.push_back(entry.name);
    axis.usual = usual;
    axis.get = [field](const Case& c) {
        const Table* entry = field(const_cast<Case&>(c));
        return std::string(entry ? entry->name : "");
    };
    axis.set = [&table, field, noun = nounOf(row), there = joined(axis.words)](Case& c, const std::string& text) {
        const auto entry = std::ranges::find(table, text, &Table::name);
        if (entry == table.end())
            return Result<void>(inputError(std::format("no {} '{}'; there is {}", noun, text, there)));
        field(c) = &*entry;
        return Result<void>{};
    };
    axis.unnamed = [usual, words = axis.words](const Case&) { return usual.empty() ? words : std::vector{usual}; };
    axis.idPart = [](const Case&) { return std::string(); };
    axis.readIdPart = [](Case&, std::string_view) { return false; };
    return axis;
}

}  // namespace skinbench
