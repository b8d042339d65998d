#include <catch2/catch_test_macros.hpp>

#include "common/core/utf8.h"

using namespace skinbench;

TEST_CASE("well-formed UTF-8 stays as it is") {
    for (const char* text :
         {"", "hero.glb", "caf\xC3\xA9", "\xE2\x82\xAC", "\xED\x9F\xBF", "\xF0\x9F\x98\x80", "\xF4\x8F\xBF\xBF"}) {
        CHECK(firstBadUtf8(text) == std::string::npos);
        CHECK(toUtf8(text) == text);
    }
}

TEST_CASE("each byte that is no UTF-8 is found and replaced") {
    const std::string mark = "\xEF\xBF\xBD";
    CHECK(firstBadUtf8("caf\xE9.glb") == 3);
    CHECK(toUtf8("caf\xE9.glb") == "caf" + mark + ".glb");
    CHECK(toUtf8("\xC0\xAF") == mark + mark);                        // an overlong slash
    CHECK(toUtf8("\xED\xA0\x80") == mark + mark + mark);             // a surrogate
    CHECK(toUtf8("\xF4\x90\x80\x80") == mark + mark + mark + mark);  // above U+10FFFF
    CHECK(toUtf8("a\xE2\x82") == "a" + mark + mark);                 // cut off
    CHECK(firstBadUtf8("a\xC3\xA9\xFF") == 3);
}

TEST_CASE("a text is cut between characters") {
    CHECK(shortText("caf\xC3\xA9", 9) == "caf\xC3\xA9");
    CHECK(shortText("caf\xC3\xA9", 5) == "caf\xC3\xA9");
    CHECK(shortText("caf\xC3\xA9", 4) == "caf");
    CHECK(shortText("\xF0\x9F\x98\x80", 3).empty());
    CHECK(shortText("caf\xE9 noir", 4) == "caf\xEF\xBF\xBD");
}
