// Text that comes from outside: file names and glTF's JSON.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace skinbench {

// The length in bytes of the character at the start of a text that is not empty, or 0 where there is no well-formed one
// (Unicode, table 3-7).
size_t utf8Length(std::string_view text);

// The offset of the first byte that is no well-formed UTF-8, or npos.
size_t firstBadUtf8(std::string_view text);

// Each byte that is no well-formed UTF-8 becomes U+FFFD.
std::string toUtf8(std::string_view text);

// The start of a text of strangers: at most `bytes` bytes of it, valid UTF-8.
std::string shortText(std::string_view text, size_t bytes);

}  // namespace skinbench
