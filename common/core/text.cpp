#include "common/core/text.h"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <format>
#include <ranges>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/core/utf8.h"

namespace skinbench {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

struct Character {
    uint32_t code = 0;
    std::string_view bytes;  // as they were, or kReplacement
};

// Cuts the first character off `text`; a byte that belongs to none is cut off alone.
Character takeCharacter(std::string_view& text) {
    const size_t length = utf8Length(text);
    const std::string_view bytes = text.substr(0, std::max<size_t>(length, 1));
    text.remove_prefix(bytes.size());
    if (length == 0) return {0xFFFD, kReplacement};
    uint32_t code = static_cast<uint8_t>(bytes.front()) & (length == 1 ? 0x7Fu : 0x7Fu >> length);
    for (const char next : bytes.substr(1)) code = code << 6 | (static_cast<uint8_t>(next) & 0x3F);
    return {code, bytes};
}

template <class Visit>
void eachCharacter(std::string_view text, const Visit& visit) {
    while (!text.empty()) visit(takeCharacter(text));
}

bool steersTerminal(uint32_t code) {
    const bool control = code < 0x20 || (code >= 0x7F && code <= 0x9F);
    const bool separator = code == 0x2028 || code == 0x2029;
    const bool direction = (code >= 0x200E && code <= 0x200F) || (code >= 0x202A && code <= 0x202E) ||
                           (code >= 0x2066 && code <= 0x2069) || code == 0x061C;
    return control || separator || direction;
}

std::string shownCharacter(const Character& character) {
    if (!steersTerminal(character.code)) return std::string(character.bytes);
    switch (character.code) {
        case '\n':
            return "\\n";
        case '\r':
            return "\\r";
        case '\t':
            return "\\t";
        default:
            return character.code < 0x100 ? std::format("\\x{:02x}", character.code)
                                          : std::format("\\u{:04x}", character.code);
    }
}

bool isNumber(std::string_view text) {
    double value = 0;
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    return parsed.ec == std::errc() && parsed.ptr == text.data() + text.size();
}

template <class Json>
std::string dumped(const Json& json, int indent) {
    const std::string text = json.dump(indent, ' ', false, Json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    eachCharacter(text, [&](const Character& c) {
        if (c.code >= 0x7F && c.code <= 0x9F)
            safe += std::format("\\u{:04x}", c.code);
        else
            safe += c.bytes;
    });
    return safe;
}

}  // namespace

std::string terminalText(std::string_view text) {
    std::string shown;
    eachCharacter(text, [&](const Character& character) { shown += shownCharacter(character); });
    return shown;
}

std::string terminalText(std::string_view text, size_t most) {
    std::vector<std::string> shown;  // no escape is cut in two
    size_t length = 0;
    eachCharacter(text, [&](const Character& character) {
        shown.push_back(shownCharacter(character));
        length += steersTerminal(character.code) ? shown.back().size() : 1;
    });
    auto lengthOf = [](const std::string& piece) { return piece.starts_with('\\') ? piece.size() : 1; };
    std::string front, back;
    size_t begin = 0, end = shown.size(), used = 1;  // the mark
    // The reason stands at the end of a message, what it is about at its beginning: two thirds for that one.
    while (length > most && begin < end && used + lengthOf(shown[begin]) <= most * 2 / 3) {
        used += lengthOf(shown[begin]);
        front += shown[begin++];
    }
    while (length > most && begin < end && used + lengthOf(shown[end - 1]) <= most) {
        used += lengthOf(shown[end - 1]);
        back.insert(0, shown[--end]);
    }
    if (length > most) return front + "…" + back;
    for (const std::string& piece : shown) front += piece;
    return front;
}

std::string wrapText(std::string_view line, size_t width, size_t indent) {
    if (width == 0) return std::string(line);
    std::string wrapped;
    size_t used = 0;  // characters of the last line
    for (const auto part : std::views::split(line, ' ')) {
        const std::string_view word(part.begin(), part.end());
        size_t length = 0;
        eachCharacter(word, [&](const Character&) { ++length; });
        const bool first = word.data() == line.data();
        if (!first && used + 1 + length > width) {
            wrapped += "\n" + std::string(indent, ' ');
            used = indent;
        } else if (!first) {
            wrapped += ' ';
            ++used;
        }
        wrapped += word;
        used += length;
    }
    return wrapped;
}

std::string counted(uint64_t count, const std::string& one, const std::string& many) {
    return std::format("{} {}", count, count == 1 ? one : many.empty() ? one + "s" : many);
}

std::string csvText(std::string_view text) {
    std::string field;
    if (!text.empty() && std::string_view("=+-@\t\r").contains(text.front()) && !isNumber(text)) field = "'";
    eachCharacter(text, [&](const Character& character) { field += character.bytes; });
    if (field.find_first_of(",;\"\r\n") == std::string::npos) return field;
    std::string quoted = "\"";
    for (char c : field) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

std::string htmlText(std::string_view text) {
    std::string safe;
    eachCharacter(text, [&](const Character& character) {
        switch (character.code) {
            case '&':
                safe += "&amp;";
                break;
            case '<':
                safe += "&lt;";
                break;
            case '>':
                safe += "&gt;";
                break;
            case '"':
                safe += "&quot;";
                break;
            case '\'':
                safe += "&#39;";
                break;
            default:
                safe += character.bytes;
        }
    });
    return safe;
}

std::string dumpJson(const nlohmann::ordered_json& json, int indent) { return dumped(json, indent); }

std::string dumpJson(const nlohmann::json& json, int indent) { return dumped(json, indent); }

Result<void> checkJsonShape(std::string_view text, const JsonLimits& limits) {
    std::vector<size_t> keys;  // of every object that is open, 0 for an array
    bool inString = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (inString) {
            if (c == '\\') ++i;
            if (c == '"') inString = false;
            continue;
        }
        if (c == '"') inString = true;
        if (c == '{' || c == '[') keys.push_back(0);
        if ((c == '}' || c == ']') && !keys.empty()) keys.pop_back();
        if (c == ':' && !keys.empty() && ++keys.back() > limits.keys)
            return inputError("holds an object with more than " + counted(limits.keys, "key"));
        if (keys.size() > static_cast<size_t>(limits.depth))
            return inputError("nests its JSON deeper than " + counted(static_cast<uint64_t>(limits.depth), "level"));
    }
    return {};
}

}  // namespace skinbench
