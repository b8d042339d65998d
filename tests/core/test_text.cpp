// Text that is not ours cannot steer what shows it.
#include <catch2/catch_test_macros.hpp>
#include <format>
#include <nlohmann/json.hpp>

#include "common/core/text.h"

using namespace skinbench;
using Json = nlohmann::ordered_json;

TEST_CASE("text on a terminal is one line without control characters") {
    CHECK(terminalText("hero_01.glb: größer, 日本, \\ stays") == "hero_01.glb: größer, 日本, \\ stays");
    CHECK(terminalText("a\nskinbench: b\r\tc") == "a\\nskinbench: b\\r\\tc");
    CHECK(terminalText(std::string("\x1b[31m\0\x7f", 7)) == "\\x1b[31m\\x00\\x7f");
    CHECK(terminalText("\xC2\x9B"
                       "2J") == "\\x9b2J");  // U+009B introduces sequences too
    CHECK(terminalText("\u202Egpj.exe\u2066\u2028") == "\\u202egpj.exe\\u2066\\u2028");
}

TEST_CASE("what is not UTF-8 becomes the replacement character") {
    const std::string mark = "\uFFFD";
    CHECK(terminalText("caf\xE9") == "caf" + mark);
    CHECK(terminalText("\xFF\xFE") == mark + mark);
    CHECK(terminalText("\xC0\xAF") == mark + mark);                        // overlong
    CHECK(terminalText("\xE0\x80\xAF") == mark + mark + mark);             // overlong
    CHECK(terminalText("\xED\xA0\x80") == mark + mark + mark);             // a surrogate
    CHECK(terminalText("\xF4\x90\x80\x80") == mark + mark + mark + mark);  // above U+10FFFF
    CHECK(terminalText("\xE6\x97") == mark + mark);                        // cut off
    CHECK(terminalText("\xE6x") == mark + "x");
    CHECK(terminalText("\xF0\x9F\xA6\xB4") == "\xF0\x9F\xA6\xB4");
}

TEST_CASE("a long message keeps its beginning and its end") {
    CHECK(terminalText(std::string(400, 'x'), 400) == std::string(400, 'x'));
    const std::string cut = terminalText(std::format("file: {} is too long", std::string(500'000, 'n')), 400);
    CHECK(cut.starts_with("file: nnn"));
    CHECK(cut.ends_with("nnn is too long"));
    CHECK(cut.size() == 399 + std::string("…").size());
    // An escape is not cut in two.
    CHECK(terminalText(std::string(10, '\n'), 9) == "\\n\\n…\\n\\n");
}

TEST_CASE("a long line is broken at spaces, and nothing else of it changes") {
    const std::string line = "differs: settings copies: 7 in A, 8 in B; größer";
    CHECK(wrapText(line, 0) == line);
    CHECK(wrapText(line, 48, 2) == line);
    CHECK(wrapText(line, 47, 2) == "differs: settings copies: 7 in A, 8 in B;\n  größer");
    CHECK(wrapText(line, 20, 2) == "differs: settings\n  copies: 7 in A, 8\n  in B; größer");
    CHECK(wrapText("unbreakable words", 3, 1) == "unbreakable\n words");
    CHECK(wrapText("", 10) == "");
}

TEST_CASE("a field of a CSV file is one field, and no formula") {
    CHECK(csvText("plain text") == "plain text");
    CHECK(csvText("a,b") == "\"a,b\"");
    CHECK(csvText("say \"x\"") == "\"say \"\"x\"\"\"");
    CHECK(csvText("a\rb") == "\"a\rb\"");
    CHECK(csvText("a\nb") == "\"a\nb\"");
    for (const std::string text : {"=1+1", "+cmd", "-cmd", "@x"}) CHECK(csvText(text) == "'" + text);
    CHECK(csvText("\t=x") == "'\t=x");
    CHECK(csvText("=a,b") == "\"'=a,b\"");
    for (const char* number : {"-1.5", "+2", "-1e-9"}) CHECK(csvText(number) == number);
    CHECK(csvText("-") == "'-");
    CHECK(csvText("caf\xE9") == "caf\uFFFD");
}

TEST_CASE("text in a page is no markup") {
    CHECK(htmlText("<b a=\"1\" c='2'>&amp;") == "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;amp;");
    CHECK(htmlText("x\xFF") == "x\uFFFD");
}

TEST_CASE("a number of things is in words that fit it") {
    CHECK(counted(0, "case") == "0 cases");
    CHECK(counted(1, "case") == "1 case");
    CHECK(counted(2, "case") == "2 cases");
    CHECK(counted(1, "vertex", "vertices") == "1 vertex");
    CHECK(counted(56'842, "vertex", "vertices") == "56842 vertices");
}

TEST_CASE("JSON takes any bytes and steers no terminal") {
    const Json json = {{"caf\xE9", "a\x1b\x7f\xC2\x9B"}};
    CHECK(dumpJson(json, -1) == "{\"caf\uFFFD\":\"a\\u001b\\u007f\\u009b\"}");
    CHECK(Json::parse(dumpJson(json))["caf\uFFFD"] == "a\x1b\x7f\xC2\x9B");
}

TEST_CASE("JSON is bounded before it is parsed") {
    CHECK(checkJsonShape("{\"a\": [[1, 2], {\"b\": \"[[[{{{::::\\\"{\"}]}", {4, 1}));
    CHECK(checkJsonShape("[[]]", {1, 1}).error().text == "nests its JSON deeper than 1 level");
    CHECK(checkJsonShape("[[], [], []]", {2, 1}));
    CHECK(checkJsonShape("[{\"a\": 1}, {\"a\": 1, \"b\": 2}]", {9, 2}));
    CHECK(checkJsonShape("{\"a\": {\"x\": 1}, \"b\": 1}", {9, 1}).error().text ==
          "holds an object with more than 1 key");
    CHECK(checkJsonShape("]]]}}}:::"));
}
