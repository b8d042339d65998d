// Text that comes from outside: file names and glTF's JSON.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace skinbench {

// The offset of the first byte that is no well-formed UTF-8 (Unicode, table 3-7), or npos.
size_t firstBadUtf8(std::string_view text);

// Each byte that is no well-formed UTF-8 becomes U+FFFD.
std::string toUtf8(std::string_view text);

// The start of a text of strangers: at most `bytes` bytes of it, valid UTF-8.
std::string shortText(std::string_view text, size_t bytes);

}  // namespace skinbench
