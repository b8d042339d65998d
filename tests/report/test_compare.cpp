// Which cases differ between two result files.
#include <algorithm>
#include <cmath>
#include <format>
#include <random>

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>
#include <nlohmann/json.hpp>

#include "common/report/compare.h"
#include "common/report/report.h"

using namespace skinbench;
using Catch::Approx;
using Catch::Matchers::ContainsSubstring;
using Json = nlohmann::ordered_json;

namespace {

// Samples around a median, spread by the relative half-width.
std::vector<double> spread(double median, double halfWidth, size_t count, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::vector<double> samples;
    for (size_t i = 0; i < count; ++i)
        samples.push_back(median * (1 + halfWidth * (2.0 * (random() % 10'001) / 10'000 - 1)));
    return samples;
}

double middleOf(std::vector<double> samples) {
    std::ranges::sort(samples);
    const size_t n = samples.size();
    return (samples[(n - 1) / 2] + samples[n / 2]) / 2;
}

Json timed(const std::string& id, const std::vector<double>& samples) {
    return {{"id", id},
            {"route", "vk"},
            {"status", "ok"},
            {"reason", nullptr},
            {"gpu_ms", {{"median", middleOf(samples)}, {"samples", samples}}}};
}

Json untimed(const std::string& id, const std::string& status, const Json& reason) {
    return {{"id", id}, {"route", "vk"}, {"status", status}, {"reason", reason}, {"gpu_ms", nullptr}};
}

Json file(const std::vector<Json>& cases) {
    return {
        {"tool", {{"version", "1"}, {"revision", "abc"}}},
        {"host", {{"os", "Linux"}, {"cpu", "CPU"}}},
        {"devices", Json::array({{{"route_api", "vulkan"}, {"name", "Card"}, {"driver", "1"}, {"software", false}}})},
        {"scene", {{"name", "hero"}, {"vertices", 100}}},
        {"settings", {{"copies", 7}, {"frames", 30}}},
        {"cases", cases}};
}

Json axis(const std::string& name, const Json& usual, const std::vector<std::string>& values, bool topLevel,
          const Json& beside = nullptr) {
    return {{"name", name},     {"option", "--" + name + "s"},
            {"usual", usual},   {"top_level", topLevel},
            {"values", values}, {"beside", beside}};
}

// A file with axes of its own: tint means something beside size alone.
Json withAxes(const std::vector<Json>& cases) {
    Json results = file(cases);
    results["axes"] = {axis("route", nullptr, {"vk", "gl"}, true), axis("variant", nullptr, {"none", "vertex"}, true),
                       axis("codec", "uc", {"uc", "oss", "pc"}, true), axis("size", "10", {}, false),
                       axis("tint", "no", {"no", "yes"}, false, "size")};
    return results;
}

// A case of such a file; the id begins with route, variant and codec.
Json option(const std::string& id, const std::string& size, const std::string& tint,
            const std::vector<double>& samples) {
    Json row = timed(id, samples);
    const size_t first = id.find('/'), second = id.find('/', first + 1);
    row["route"] = id.substr(0, first);
    row["variant"] = id.substr(first + 1, second - first - 1);
    row["codec"] = id.substr(second + 1, id.find('+') - second - 1);
    row["options"] = {{"size", size}, {"tint", tint}};
    return row;
}

Comparison comparisonOf(const Json& a, const Json& b) {
    auto compared = compareResults(a, b);
    REQUIRE(compared);
    return std::move(*compared);
}

Comparison pairsOf(const Json& a, const Json& b, const std::vector<std::string>& words) {
    auto pairs = comparePairs(a, b, words);
    REQUIRE(pairs);
    return std::move(*pairs);
}

const ComparedCase& find(const Comparison& comparison, const std::string& id) {
    auto found = std::ranges::find(comparison.cases, id, &ComparedCase::id);
    REQUIRE(found != comparison.cases.end());
    return *found;
}

}  // namespace

TEST_CASE("the interval of a ratio holds it and shrinks with more samples") {
    auto width = [](size_t count) {
        const std::vector<double> a = spread(10, 0.02, count, 1), b = spread(11, 0.02, count, 2);
        const Interval interval = medianRatioInterval({a, {count}}, {b, {count}});
        const double ratio = middleOf(b) / middleOf(a);
        CHECK(interval.low <= ratio);
        CHECK(ratio <= interval.high);
        CHECK(interval.low > 1.05);
        CHECK(interval.high < 1.15);
        return interval.high - interval.low;
    };
    CHECK(width(400) < width(20) / 2);
}

TEST_CASE("the interval of a ratio is the same every time, and exact for equal samples") {
    const Measured a{spread(10, 0.02, 31), {31}}, b{spread(12, 0.05, 24), {24}};
    CHECK(medianRatioInterval(a, b) == medianRatioInterval(a, b));
    const Interval constant = medianRatioInterval({{2, 2, 2}, {3}}, {{3, 3}, {2}});
    CHECK(constant.low == 1.5);
    CHECK(constant.high == 1.5);
    const Interval turned = medianRatioInterval(b, a), straight = medianRatioInterval(a, b);
    CHECK(turned.low == Approx(1 / straight.high).epsilon(0.01));
    CHECK(turned.high == Approx(1 / straight.low).epsilon(0.01));
}

TEST_CASE("the interval covers the true ratio about as often as it says") {
    size_t held = 0;
    const size_t trials = 200;
    for (unsigned i = 0; i < trials; ++i) {
        const Measured a{spread(10, 0.03, 30, 2 * i + 1), {30}}, b{spread(10.5, 0.03, 30, 2 * i + 2), {30}};
        const Interval interval = medianRatioInterval(a, b);
        held += interval.low <= 1.05 && 1.05 <= interval.high;
    }
    CHECK(held > trials * 0.88);
    CHECK(held < trials);
}

TEST_CASE("rounds that lie apart widen the interval") {
    std::vector<double> drifting = spread(10, 0.001, 10, 1);
    for (double sample : spread(11, 0.001, 10, 2)) drifting.push_back(sample);
    const Measured b{spread(10, 0.001, 20, 3), {20}};
    const Interval one = medianRatioInterval({drifting, {20}}, b), two = medianRatioInterval({drifting, {10, 10}}, b);
    CHECK(two.high - two.low >= one.high - one.low);
    CHECK(two.low < 0.915);
    CHECK(two.high > 0.995);
}

TEST_CASE("gains, losses and noise are told apart") {
    const Json a = file({timed("same", spread(10, 0.02, 30, 1)), timed("slow", spread(10, 0.02, 30, 2)),
                         timed("slowest", spread(10, 0.02, 30, 3)), timed("fast", spread(10, 0.02, 30, 4)),
                         timed("floor", spread(10, 0.0001, 30, 5)), timed("few", spread(10, 0.001, 5, 6)),
                         timed("wide", {8, 9, 9.5, 10, 10.5, 11, 12, 13})});
    const Json b = file({timed("same", spread(10, 0.02, 30, 11)), timed("slow", spread(11, 0.02, 30, 12)),
                         timed("slowest", spread(20, 0.02, 30, 13)), timed("fast", spread(9, 0.02, 30, 14)),
                         timed("floor", spread(10.02, 0.0001, 30, 15)), timed("few", spread(12, 0.001, 30, 16)),
                         timed("wide", {8.2, 9.1, 9.9, 10.4, 11, 11.5, 12, 14})});
    const Comparison compared = comparisonOf(a, b);
    std::vector<std::string> order;
    for (const ComparedCase& one : compared.cases) order.push_back(one.id + " " + changeName(one.change));
    CHECK(order[0] == "slowest slower");
    CHECK(order[1] == "slow slower");
    CHECK(order[2] == "fast faster");
    CHECK(order[6] == "few unknown");
    for (const char* id : {"same", "floor", "wide"}) CHECK(find(compared, id).change == Change::same);
    // 0.2 % is real, its interval says so, but it lies inside the noise floor.
    CHECK(find(compared, "floor").interval->low > 1);
    CHECK(find(compared, "few").ratio == Approx(1.2).epsilon(0.01));
    CHECK(!find(compared, "few").interval);
    CHECK(compared.differences.empty());
}

TEST_CASE("the noise floor is the larger of both files, or the default") {
    Json a = file({timed("x", spread(10, 0.0001, 30))}), b = file({timed("x", spread(10.05, 0.0001, 30))});
    const Comparison byDefault = comparisonOf(a, b);
    CHECK(byDefault.noiseFloor == 0.003);
    CHECK(!byDefault.noiseFloorMeasured);
    CHECK(byDefault.cases[0].change == Change::slower);
    CHECK_THAT(comparisonText(byDefault), ContainsSubstring("noise floor: 0.30 % (0.30 % stands for a file"));
    a["noise_floor"] = 0.001;
    b["noise_floor"] = 0.008;
    const Comparison measured = comparisonOf(a, b);
    CHECK(measured.noiseFloor == 0.008);
    CHECK(measured.noiseFloorMeasured);
    CHECK(measured.cases[0].change == Change::same);
    b["noise_floor"] = nullptr;
    const Comparison half = comparisonOf(a, b);
    CHECK(half.noiseFloor == 0.003);
    CHECK(!half.noiseFloorMeasured);
}

TEST_CASE("compare says when neither intervals nor a noise floor cover where memory lies") {
    const auto told = [](const Json& a, const Json& b) {
        const Comparison compared = comparisonOf(a, b);
        CHECK(comparisonJson(compared)["placement_covered"] == compared.placementCovered);
        const bool said = comparisonText(compared).find("where memory lies") != std::string::npos;
        CHECK((said != compared.placementCovered || compared.cases[0].b.software));
        return said;
    };
    Json a = file({timed("x", spread(10, 0.01, 30))}), b = a;  // as written before there was a placement
    CHECK(told(a, b));
    a["settings"]["placement"] = b["settings"]["placement"] = "kept";
    CHECK(told(a, b));
    a["settings"]["placement"] = "fresh";
    CHECK(told(a, b));
    b["noise_floor"] = 0.01;
    CHECK(!told(a, b));
    b["noise_floor"] = nullptr;
    b["settings"]["placement"] = "fresh";
    CHECK(!told(a, b));
    a["settings"]["placement"] = b["settings"]["placement"] = "kept";
    a["devices"][0]["software"] = b["devices"][0]["software"] = true;
    CHECK(!told(a, b));
}

TEST_CASE("cases of one file, skipped and failed cases are listed") {
    const std::vector<double> samples = spread(10, 0.01, 20);
    const Json a = file({timed("both", samples), timed("gone", samples), timed("breaks", samples),
                         untimed("mends", "failed", "wrong"), untimed("never", "skipped", "no mesh shader"),
                         untimed("verified", "ok", nullptr)});
    const Json b =
        file({untimed("breaks", "failed", "off by 3"), timed("mends", samples), timed("both", samples),
              untimed("never", "skipped", "no mesh shader"), timed("new", samples), timed("verified", samples)});
    const Comparison compared = comparisonOf(a, b);
    CHECK(compared.cases.size() == 7);
    CHECK(find(compared, "both").change == Change::same);
    CHECK(find(compared, "gone").change == Change::onlyA);
    CHECK(find(compared, "new").change == Change::onlyB);
    CHECK(find(compared, "breaks").change == Change::broken);
    CHECK(find(compared, "mends").change == Change::mended);
    CHECK(find(compared, "never").change == Change::notRun);
    CHECK(find(compared, "verified").change == Change::untimed);
    const std::string text = comparisonText(compared);
    for (const char* part :
         {"ok in A, not in B (1)", "A ok | B failed: off by 3", "only in A (1)", "only in B (1)",
          "A failed: wrong | B ok", "ok in neither (1)", "no difference (1)", "not timed in both (1)"})
        CHECK_THAT(text, ContainsSubstring(part));
    CHECK(text.find('*') == std::string::npos);
    const std::vector<std::string> wanted = {
        "1 of 7 cases is ok in A and not in B; the first, breaks, failed: off by 3",
        "1 of 7 cases is ok in A and missing in B; the first, gone",
        "1 of 7 cases is not timed in both files; the first, verified"};
    CHECK(findWorse(compared, 1000, false) == wanted);
    CHECK(findWorse(compared, 1000, true) == std::vector{wanted[0], wanted[2]});
}

TEST_CASE("a guard that compares nothing fails") {
    const Json full = file({timed("x", spread(10, 0.01, 20)), timed("y", spread(10, 0.01, 20))});
    auto worse = [](const Json& a, const Json& b, bool allowMissing) {
        const Comparison compared = comparisonOf(a, b);
        return findWorse(compared, 3, allowMissing);
    };
    CHECK(worse(full, full, false).empty());
    const std::string nothing = "no case was compared: A and B have none that is timed in both";
    CHECK(worse(full, file({timed("x", spread(10, 0.01, 20))}), true).empty());
    CHECK(worse(full, file({timed("x", spread(10, 0.01, 20))}), false) ==
          std::vector<std::string>{"1 of 2 cases is ok in A and missing in B; the first, y"});
    const Json few = file({timed("x", spread(10, 0.01, 5))});
    CHECK(worse(few, few, false) ==
          std::vector<std::string>{"1 of 1 case has too few samples to be compared; the first, x"});
    const Json skipped = file({untimed("x", "skipped", "no GPU")}), failed = file({untimed("x", "failed", "wrong")});
    CHECK(worse(skipped, skipped, false) == std::vector{nothing});
    CHECK(worse(skipped, failed, false) ==
          std::vector<std::string>{"1 of 1 case failed in B and was not ok in A; the first, x, failed: wrong"});
}

TEST_CASE("worse is a whole interval above what is allowed and above noise") {
    // The interval of "wide" misses 1, its ratio is above 1.05; the interval's end is not.
    const Json a = file({timed("five", spread(10, 0.01, 30, 1)), timed("wide", spread(10, 0.1, 12, 5))});
    Json b = file({timed("five", spread(10.5, 0.01, 30, 3)), timed("wide", spread(11.2, 0.1, 12, 6))});
    const Comparison compared = comparisonOf(a, b);
    const ComparedCase wide = find(compared, "wide");
    REQUIRE(wide.change == Change::slower);
    REQUIRE(wide.interval->low > 1);
    REQUIRE(wide.interval->low < 1.05);
    CHECK(*wide.ratio > 1.05);
    CHECK(findWorse(compared, 5, false).empty());
    const std::vector<std::string> worse = findWorse(compared, 4, false);
    REQUIRE(worse.size() == 1);
    CHECK_THAT(worse[0], ContainsSubstring("1 of 2 cases is more than 4 % slower; the first, five, takes 1.04"));
    CHECK(findWorse(compared, 8, false).empty());
    const Comparison turned = comparisonOf(b, a);
    CHECK(findWorse(turned, 0, false).empty());
    b["noise_floor"] = 0.06;
    const Comparison noisy = comparisonOf(a, b);
    CHECK(findWorse(noisy, 0, false).empty());
}

TEST_CASE("what differs between the files is said, and broken at the terminal's width") {
    const Json a = file({untimed("x", "skipped", "no GPU")});
    Json b = a;
    b["tool"]["revision"] = "def";
    b["settings"]["copies"] = 8;
    b["settings"]["new"] = true;
    b["scene"]["name"] = "other";
    b["devices"][0]["name"] = "Faster card";
    const Comparison compared = comparisonOf(a, b);
    const std::vector<std::string> wanted = {"devices: vulkan: Card, 1 in A, vulkan: Faster card, 1 in B",
                                             "scene name: hero in A, other in B", "settings copies: 7 in A, 8 in B",
                                             "settings new: not said in A, true in B",
                                             "tool revision: abc in A, def in B"};
    CHECK(compared.differences == wanted);
    for (const std::string& line : wanted)
        CHECK_THAT(comparisonText(compared), ContainsSubstring("differs: " + line + "\n"));
    CHECK_THAT(comparisonText(compared, 40), ContainsSubstring("differs: settings copies: 7 in A, 8 in B\n"
                                                               "differs: settings new: not said in A,\n"
                                                               "         true in B\n"));
}

TEST_CASE("files without a common case are refused with what they differ in") {
    const std::vector<double> samples = spread(10, 0.01, 20);
    auto refused = [](const Json& a, const Json& b, const std::string& why) {
        const auto compared = compareResults(a, b);
        REQUIRE(!compared);
        CHECK(compared.error().fault == Fault::input);
        CHECK(compared.error().text == "A and B have no case in common: " + why);
    };
    const Json uc = withAxes({option("vk/vertex/uc", "10", "no", samples)});
    refused(uc, withAxes({option("vk/vertex/pc", "10", "no", samples)}),
            "they differ in codec (uc in A, pc in B); --pair codec compares them");
    refused(uc, withAxes({option("gl/vertex/pc", "12", "no", samples), option("gl/vertex/oss", "10", "no", samples)}),
            "they differ in route (vk in A, gl in B), codec (uc in A, oss, pc in B); --pair route,codec compares them");
    refused(withAxes({option("vk/vertex/uc", "10", "no", samples), option("gl/vertex/pc", "10", "no", samples)}),
            withAxes({option("gl/vertex/uc", "10", "no", samples), option("vk/vertex/pc", "10", "no", samples)}),
            "they combine the same options in other ways");
    refused(uc, withAxes({}), "B has no case at all");
}

TEST_CASE("equal ids that stand for other options are named") {
    Json a = file({timed("vk/vertex/uc", spread(1, 0.01, 20))}), b = a;
    a["cases"][0]["options"] = {{"zero_weights", "load"}};
    b["cases"][0]["options"] = {{"zero_weights", "skip"}};
    const Comparison comparison = comparisonOf(a, b);
    CHECK(comparison.differences == std::vector<std::string>{"equal ids, option zero_weights: load in A, skip in B"});
}

TEST_CASE("pairs of one file are equal but for the named axes, from the usual value to the others") {
    const Json a = withAxes({option("vk/vertex/uc", "10", "no", spread(10, 0.001, 20)),
                             option("vk/vertex/pc", "10", "no", spread(11, 0.001, 20)),
                             option("vk/vertex/oss", "10", "no", spread(9, 0.001, 20)),
                             option("vk/compute/pc", "10", "no", spread(5, 0.001, 20)),
                             option("vk/compute/oss", "10", "no", spread(6, 0.001, 20)),
                             option("vk/compute/pc+again", "10", "no", spread(7, 0.001, 20)),
                             option("gl/vertex/uc", "12", "no", spread(10, 0.001, 20))});
    const Comparison compared = pairsOf(a, a, {"--codecs"});
    std::vector<std::string> found;
    for (const ComparedCase& pair : compared.cases)
        found.push_back(std::format("{} {} {} {:.1f}", pair.direction, pair.id, pair.b.id, *pair.ratio));
    CHECK(found == std::vector<std::string>{"codec: uc → oss vk/vertex/uc vk/vertex/oss 0.9",
                                            "codec: uc → pc vk/vertex/uc vk/vertex/pc 1.1",
                                            "codec: oss → pc vk/compute/oss vk/compute/pc 0.8"});
    CHECK(compared.alone == 2);
    CHECK(compared.differences.empty());
    const std::string text = comparisonText(compared);
    CHECK_THAT(text, ContainsSubstring("A → B is codec: uc → oss, 1 pair: B/A from 0.9") &&
                         ContainsSubstring("2 cases are of A without a partner"));
    const Json json = comparisonJson(compared);
    CHECK(json["paired_by"] == Json{"codec"});
    CHECK(json["cases"][1]["direction"] == "codec: uc → pc");
    CHECK(json["cases"][1]["b"]["id"] == "vk/vertex/pc");

    // The named value is A's, and an axis that hangs on a paired one may differ too.
    const Comparison turned = pairsOf(a, a, {"codec=pc", "route"});
    CHECK(find(turned, "vk/vertex/pc").direction == "codec: pc → uc");
    CHECK(std::ranges::all_of(turned.cases, [](const ComparedCase& pair) { return pair.a.id.contains("/pc"); }));
    const Json warm = withAxes({option("vk/vertex/uc", "10", "no", spread(10, 0.001, 20)),
                                option("vk/vertex/uc+hot", "12", "yes", spread(10, 0.001, 20))});
    const Comparison beside = pairsOf(warm, warm, {"size"});
    REQUIRE(beside.cases.size() == 1);
    CHECK(beside.cases[0].direction == "size: 10 → 12, tint: no → yes");
}

TEST_CASE("pairs of queues are compared by their frames within batches, where the file has those") {
    Json one = option("vk/compute/uc", "10", "no", spread(10, 0.001, 20));
    Json async = option("vk/compute/uc+async", "10", "no", spread(10, 0.001, 20));
    one["options"]["queues"] = "one";
    async["options"]["queues"] = "async";
    auto compare = [&] {
        Json results = withAxes({one, async});
        results["axes"].push_back(axis("queues", "one", {"one", "async"}, false));
        return comparisonJson(pairsOf(results, results, {"queues"}));
    };
    Json compared = compare();
    CHECK(compared["times"] == "gpu_ms");
    one["batch_ms"] = timed("", spread(9, 0.001, 20))["gpu_ms"];
    async["batch_ms"] = timed("", spread(6.75, 0.001, 20))["gpu_ms"];
    compared = compare();
    CHECK(compared["times"] == "batch_ms");
    CHECK(compared["cases"][0]["direction"] == "queues: one → async");
    CHECK(std::abs(compared["cases"][0]["ratio"].get<double>() - 0.75) < 0.01);
    CHECK(compared["cases"][0]["change"] == "faster");
}

TEST_CASE("pairs of two files, and pairs that cannot be") {
    const Json a = withAxes({option("vk/vertex/uc", "10", "no", spread(10, 0.001, 20))});
    const Json b = withAxes({option("vk/vertex/pc", "10", "no", spread(12, 0.001, 20)),
                             option("vk/vertex/uc", "10", "no", spread(10, 0.001, 20))});
    const Comparison compared = pairsOf(a, b, {"codec"});
    REQUIRE(compared.cases.size() == 1);
    CHECK(compared.cases[0].change == Change::slower);
    CHECK(findWorse(compared, 5, false).size() == 1);
    auto refused = [&](const std::vector<std::string>& words, const std::string& part) {
        const auto pairs = comparePairs(a, a, words);
        REQUIRE(!pairs);
        CHECK(pairs.error().fault == Fault::input);
        CHECK_THAT(pairs.error().text, ContainsSubstring(part));
    };
    refused({"colour"}, "--pair 'colour': no axis has that name; there is route, variant, codec, size, tint");
    refused({"codec=pc"}, "no case of A has it; there is uc");
    refused({"codec", "codecs"}, "names the axis codec twice");
    refused({"codec"}, "no two cases are equal but for codec");
}

TEST_CASE("two cards of one name differ") {
    Json a = file({timed("x", spread(10, 0.01, 20))});
    Json b = a;
    a["devices"][0]["uuid"] = "1111";
    b["devices"][0]["uuid"] = "2222";
    const Comparison other = comparisonOf(a, b);
    CHECK(other.differences ==
          std::vector<std::string>{"devices: vulkan: Card, 1, UUID 1111 in A, vulkan: Card, 1, UUID 2222 in B"});
    a["devices"][0]["label"] = "Card (0000:01:00.0)";
    b["devices"][0]["label"] = "Card (0000:02:00.0)";
    const Comparison labelled = comparisonOf(a, b);
    CHECK(
        labelled.differences ==
        std::vector<std::string>{"devices: vulkan: Card (0000:01:00.0), 1 in A, vulkan: Card (0000:02:00.0), 1 in B"});
    // A software driver's UUID is that of its version.
    a["devices"][0]["software"] = b["devices"][0]["software"] = true;
    b["devices"][0]["label"] = a["devices"][0]["label"];
    CHECK(compareResults(a, b)->differences.empty());
}

TEST_CASE("a comparison of files that draw something else has a line that warns of it") {
    const Json a = file({timed("x", spread(10, 0.01, 20))});
    Json b = a;
    b["settings"]["frames"] = 40;
    CHECK_FALSE(comparisonText(comparisonOf(a, b)).contains("\n! "));
    b["scene"] = {{"name", "villain"}, {"vertices", 90}};
    b["settings"]["copies"] = 8;
    CHECK(drawnDifferences(a, b) == std::vector<std::string>{"scene", "copies"});
    CHECK_THAT(comparisonText(comparisonOf(a, b)),
               ContainsSubstring("\n! A and B do not draw the same (scene, copies): B/A says nothing about which is "
                                 "faster\n"));
    CHECK(findWorse(comparisonOf(a, b), 50, false).size() == 1);
    // What one of them does not say is no difference.
    b = a;
    b["settings"].erase("copies");
    CHECK(drawnDifferences(a, b).empty());
}

TEST_CASE("software drivers are marked in a comparison") {
    Json a = file({timed("x", spread(10, 0.01, 20))});
    const Json b = a;
    a["devices"][0]["software"] = true;
    const Comparison compared = comparisonOf(a, b);
    CHECK(compared.cases[0].a.software);
    CHECK(!compared.cases[0].b.software);
    CHECK_THAT(comparisonText(compared), ContainsSubstring("* software driver: shows that the path works"));
    CHECK_THAT(comparisonText(compared), ContainsSubstring("* "));
    CHECK(comparisonJson(compared)["cases"][0]["a"]["software"] == true);
}

TEST_CASE("a comparison as JSON") {
    const Json a = file({timed("x", spread(10, 0.01, 20)), untimed("y", "skipped", "why")});
    const Json b = file({timed("x", spread(12, 0.01, 20))});
    const Comparison compared = comparisonOf(a, b);
    const Json json = comparisonJson(compared);
    CHECK(json["schema"] == "skinbench-compare/1");
    CHECK(json["noise_floor_measured"] == false);
    CHECK(json["cases"][0]["change"] == "slower");
    CHECK(json["cases"][0]["ratio"] == Approx(1.2).epsilon(0.02));
    CHECK(json["cases"][0]["interval"].size() == 2);
    CHECK(json["cases"][1]["change"] == "only-a");
    CHECK(json["cases"][1]["a"]["reason"] == "why");
    CHECK(json["cases"][1]["b"].is_null());
    CHECK(json["cases"][1]["ratio"].is_null());
}

TEST_CASE("damaged results are an error, never a ratio") {
    const Json good = file({timed("x", spread(10, 0.01, 20))});
    auto refused = [&](const Json& bad, const char* part) {
        for (const auto& compared : {compareResults(bad, good), compareResults(good, bad)}) {
            REQUIRE(!compared);
            CHECK(compared.error().fault == Fault::input);
            CHECK_THAT(compared.error().text, ContainsSubstring(part));
        }
    };
    Json bad = good;
    bad["cases"][0]["gpu_ms"]["samples"] = "many";
    refused(bad, "wrong kind");
    bad = good;
    bad["cases"][0]["id"] = 5;
    refused(bad, "wrong kind");
    bad = good;
    bad["noise_floor"] = "low";
    refused(bad, "wrong kind");
    bad = good;
    bad["cases"].push_back(bad["cases"][0]);
    refused(bad, "the case x twice");

    // A time of nothing is none, and samples that cannot be times give no interval.
    bad = good;
    bad["cases"][0]["gpu_ms"]["median"] = 0;
    CHECK(compareResults(bad, good)->cases[0].change == Change::untimed);
    bad = good;
    bad["cases"][0]["gpu_ms"]["samples"][3] = -1;
    CHECK(compareResults(good, bad)->cases[0].change == Change::unknown);
}
