// The page of reports as text; report_page_test.py opens it in a browser.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <nlohmann/json.hpp>

#include "common/report/report.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::ordered_json;

namespace {

Json makeCase(const std::string& id, size_t samples) {
    Json times = {{"mean", 2.5}, {"median", 2.5}, {"min", 2.0}, {"max", 3.0}, {"cv", 0.1}, {"samples", Json::array()}};
    for (size_t i = 0; i < samples; ++i) times["samples"].push_back(2.0 + 1.0 / static_cast<double>(3 * i + 7));
    return {{"id", id},
            {"route", "vk"},
            {"variant", "vertex"},
            {"codec", "uc"},
            {"builder", nullptr},
            {"layout", nullptr},
            {"cull", "off"},
            {"scenario", "direct"},
            {"raster", "full"},
            {"options", {{"influences", "4"}, {"submission", "per-copy"}, {"vertex_fetch", "attributes"}}},
            {"status", "ok"},
            {"reason", nullptr},
            {"gpu_ms", times},
            {"passes_ms", {{"skin", nullptr}, {"depth", nullptr}, {"draw", 2.5}}},
            {"memory_bytes", {{"vertex", 1000}, {"total", 1024}}},
            {"accuracy", {{"max_position_error", 1e-7}}}};
}

Json makeResults(const std::vector<Json>& cases) {
    return {
        {"schema", kResultsSchema},
        {"tool", {{"version", "1.2.3"}, {"revision", "abc"}}},
        {"host", {{"os", "Test OS"}, {"cpu", "Test CPU"}}},
        {"devices", Json::array({{{"route_api", "vulkan"}, {"name", "Card"}, {"driver", "1"}, {"software", false}}})},
        {"scene", {{"name", "hero"}, {"vertices", 100}}},
        {"settings", {{"copies", 7}}},
        {"cases", cases}};
}

std::vector<std::string> between(const std::string& text, const std::string& start, const std::string& end) {
    std::vector<std::string> found;
    for (size_t at = text.find(start); at != std::string::npos; at = text.find(start, at)) {
        at = text.find('>', at) + 1;
        found.push_back(text.substr(at, text.find(end, at) - at));
    }
    return found;
}

// The result files that a browser finds in a page.
std::vector<std::string> resultsIn(const std::string& page) {
    return between(page, "<script type=\"application/json\" class=\"results\"", "</script>");
}

size_t count(const std::string& text, const std::string& what) {
    size_t found = 0;
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++found;
    return found;
}

}  // namespace

TEST_CASE("the page holds the whole result files") {
    const Json first = makeResults({makeCase("vk/vertex/uc", 5)});
    Json second = makeResults({makeCase("vk/vertex/uc", 3), makeCase("vk/vertex/oss", 4)});
    second["a key of tomorrow"] = {1, 2.5, "x"};
    const std::string page = reportHtml({first, second}, {"a.json", "b.json"});
    const auto found = resultsIn(page);
    REQUIRE(found.size() == 2);
    CHECK(Json::parse(found[0]) == first);
    CHECK(Json::parse(found[1]) == second);
    CHECK_THAT(page, ContainsSubstring("data-name=\"a.json\"") && ContainsSubstring("data-name=\"b.json\""));
    CHECK(page.starts_with("<!doctype html>"));
    CHECK(page.ends_with("</html>\n"));
    CHECK(resultsIn(reportHtml({first, second}, {"only.json"})).size() == 2);
    CHECK(resultsIn(reportHtml({})).empty());
}

TEST_CASE("no text of a result file breaks out of its element") {
    const std::string hostile = "</script><!-- <script> ]]> \" ' & {{results}} {{page.css}} \\ \n\u2028";
    Json results = makeResults({makeCase(hostile, 2)});
    results["cases"][0]["reason"] = hostile;
    results["scene"]["name"] = hostile;
    results["scene"][hostile] = hostile;
    const std::string plain = reportHtml({makeResults({makeCase("x", 2)})}, {"x"});
    const std::string page = reportHtml({results}, {"\"><script>alert(1)</script>"});
    for (const char* part : {"<script", "</script", "<!--", "<style", "</style"})
        CHECK(count(page, part) == count(plain, part));
    CHECK_THAT(page, ContainsSubstring("data-name=\"&quot;&gt;&lt;script&gt;alert(1)&lt;/script&gt;\""));
    const auto found = resultsIn(page);
    REQUIRE(found.size() == 1);
    CHECK(found[0].find('<') == std::string::npos);
    CHECK(Json::parse(found[0], nullptr, false) == results);
}

TEST_CASE("text that is not UTF-8 is replaced, not an abort") {
    Json results = makeResults({makeCase("vk/vertex/uc", 2)});
    results["scene"]["name"] = "h\xe9ro";
    const auto found = resultsIn(reportHtml({results}));
    REQUIRE(found.size() == 1);
    CHECK(Json::parse(found[0])["scene"]["name"] == "h\ufffdro");
}

TEST_CASE("the page is whole and refers to nothing outside") {
    const std::string page = reportHtml({makeResults({makeCase("vk/vertex/uc", 2)})});
    for (const char* end : {".css}}", ".js}}", "{{d3}}", "{{D3_LICENSE}}", "{{results}}"}) {
        INFO(end);
        CHECK(page.find(end) == std::string::npos);
    }
    for (const char* part : {"scaleLinear()", "Copyright 2010-2023 Mike Bostock", "readFiles()",
                             "prefers-color-scheme: dark", "@media print", "default-src 'none'"})
        CHECK_THAT(page, ContainsSubstring(part));
    for (const char* outside : {"src=\"", "src='", "href=\"http", "<link", "<img", "<iframe", "@import", "url(",
                                "XMLHttpRequest", "fetch(", "document.write", "eval("}) {
        INFO(outside);
        CHECK(page.find(outside) == std::string::npos);
    }
}

TEST_CASE("a page of five hundred cases with fifty samples each is at most 3 MiB") {
    std::vector<Json> cases;
    for (int i = 0; i < 500; ++i)
        cases.push_back(makeCase("vk-nv/mesh-ci/pdc16/meshopt/redirect+" + std::to_string(i), 50));
    const Json results = makeResults(cases);
    const std::string page = reportHtml({results});
    CHECK(page.size() < 3u << 20);
    CHECK(Json::parse(resultsIn(page).at(0)) == results);
}
