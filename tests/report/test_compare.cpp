// Which cases differ between two result files.
#include <algorithm>
#include <cmath>
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
    const auto compared = compareResults(a, b);
    REQUIRE(compared);
    std::vector<std::string> order;
    for (const ComparedCase& one : compared->cases) order.push_back(one.id + " " + changeName(one.change));
    CHECK(order[0] == "slowest slower");
    CHECK(order[1] == "slow slower");
    CHECK(order[2] == "fast faster");
    CHECK(order[6] == "few unknown");
    for (const char* id : {"same", "floor", "wide"}) CHECK(find(*compared, id).change == Change::same);
    // 0.2 % is real, its interval says so, but it lies inside the noise floor.
    CHECK(find(*compared, "floor").interval->low > 1);
    CHECK(find(*compared, "few").ratio == Approx(1.2).epsilon(0.01));
    CHECK(!find(*compared, "few").interval);
    CHECK(compared->differences.empty());
}

TEST_CASE("the noise floor is the larger of both files, or the default") {
    Json a = file({timed("x", spread(10, 0.0001, 30))}), b = file({timed("x", spread(10.05, 0.0001, 30))});
    const auto byDefault = compareResults(a, b);
    REQUIRE(byDefault);
    CHECK(byDefault->noiseFloor == 0.003);
    CHECK(!byDefault->noiseFloorMeasured);
    CHECK(byDefault->cases[0].change == Change::slower);
    CHECK_THAT(comparisonText(*byDefault), ContainsSubstring("noise floor: 0.30 % (0.30 % stands for a file"));
    a["noise_floor"] = 0.001;
    b["noise_floor"] = 0.008;
    const auto measured = compareResults(a, b);
    REQUIRE(measured);
    CHECK(measured->noiseFloor == 0.008);
    CHECK(measured->noiseFloorMeasured);
    CHECK(measured->cases[0].change == Change::same);
    b["noise_floor"] = nullptr;
    const auto half = compareResults(a, b);
    REQUIRE(half);
    CHECK(half->noiseFloor == 0.003);
    CHECK(!half->noiseFloorMeasured);
}

TEST_CASE("compare says when neither intervals nor a noise floor cover where memory lies") {
    const auto told = [](const Json& a, const Json& b) {
        const auto compared = compareResults(a, b);
        REQUIRE(compared);
        CHECK(comparisonJson(*compared)["placement_covered"] == compared->placementCovered);
        const bool said = comparisonText(*compared).find("where memory lies") != std::string::npos;
        CHECK((said != compared->placementCovered || compared->cases[0].b.software));
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
    const auto compared = compareResults(a, b);
    REQUIRE(compared);
    CHECK(compared->cases.size() == 7);
    CHECK(find(*compared, "both").change == Change::same);
    CHECK(find(*compared, "gone").change == Change::onlyA);
    CHECK(find(*compared, "new").change == Change::onlyB);
    CHECK(find(*compared, "breaks").change == Change::broken);
    CHECK(find(*compared, "mends").change == Change::mended);
    CHECK(find(*compared, "never").change == Change::notRun);
    CHECK(find(*compared, "verified").change == Change::untimed);
    const std::string text = comparisonText(*compared);
    for (const char* part :
         {"ok in A, not in B (1)", "A ok | B failed: off by 3", "only in A (1)", "only in B (1)",
          "A failed: wrong | B ok", "ok in neither (1)", "no difference (1)", "not timed in both (1)"})
        CHECK_THAT(text, ContainsSubstring(part));
    CHECK(text.find('*') == std::string::npos);
    const std::vector<std::string> wanted = {
        "1 of 7 cases is ok in A and not in B; the first, breaks, failed: off by 3",
        "1 of 7 cases is ok in A and missing in B; the first, gone",
        "1 of 7 cases is not timed in both files; the first, verified"};
    CHECK(findWorse(*compared, 1000, false) == wanted);
    CHECK(findWorse(*compared, 1000, true) == std::vector{wanted[0], wanted[2]});
}

TEST_CASE("a guard that compares nothing fails") {
    const Json full = file({timed("x", spread(10, 0.01, 20)), timed("y", spread(10, 0.01, 20))});
    auto worse = [](const Json& a, const Json& b, bool allowMissing) {
        const auto compared = compareResults(a, b);
        REQUIRE(compared);
        return findWorse(*compared, 3, allowMissing);
    };
    CHECK(worse(full, full, false).empty());
    const std::string nothing = "no case was compared: A and B have none that is timed in both";
    CHECK(worse(full, file({}), false) ==
          std::vector<std::string>{"2 of 2 cases are ok in A and missing in B; the first, x"});
    CHECK(worse(full, file({}), true) == std::vector{nothing});
    CHECK(worse(file({}), full, false) == std::vector{nothing});
    CHECK(worse(full, file({timed("x", spread(10, 0.01, 20))}), true).empty());
    const Json few = file({timed("x", spread(10, 0.01, 5))});
    CHECK(worse(few, few, false) ==
          std::vector<std::string>{"1 of 1 cases has too few samples to be compared; the first, x"});
    const Json skipped = file({untimed("x", "skipped", "no GPU")}), failed = file({untimed("x", "failed", "wrong")});
    CHECK(worse(skipped, skipped, false) == std::vector{nothing});
    CHECK(worse(skipped, failed, false) ==
          std::vector<std::string>{"1 of 1 cases failed in B and was not ok in A; the first, x, failed: wrong"});
}

TEST_CASE("worse is slower than allowed and beyond noise") {
    const Json a = file({timed("five", spread(10, 0.01, 30, 1)), timed("noise", {8, 9, 9.5, 10, 10.5, 11, 12, 13})});
    const Json b =
        file({timed("five", spread(10.5, 0.01, 30, 3)), timed("noise", {8.2, 9.1, 9.9, 10.4, 11, 11.5, 12, 14})});
    const auto compared = compareResults(a, b);
    REQUIRE(compared);
    CHECK(findWorse(*compared, 3, false).size() == 1);
    CHECK_THAT(findWorse(*compared, 3, false).front(),
               ContainsSubstring("1 of 2 cases is more than 3 % slower; the first, five, takes 1.0"));
    CHECK(findWorse(*compared, 8, false).empty());
    const auto turned = compareResults(b, a);
    REQUIRE(turned);
    CHECK(findWorse(*turned, 0, false).empty());
}

TEST_CASE("what differs between the files is said") {
    const Json a = file({});
    Json b = a;
    b["tool"]["revision"] = "def";
    b["settings"]["copies"] = 8;
    b["settings"]["new"] = true;
    b["scene"]["name"] = "other";
    b["devices"][0]["name"] = "Faster card";
    const auto compared = compareResults(a, b);
    REQUIRE(compared);
    const std::vector<std::string> wanted = {"devices: vulkan: Card, 1 | vulkan: Faster card, 1",
                                             "scene name: hero | other", "settings copies: 7 | 8",
                                             "settings new: – | true", "tool revision: abc | def"};
    CHECK(compared->differences == wanted);
    for (const std::string& line : wanted) CHECK_THAT(comparisonText(*compared), ContainsSubstring("differs: " + line));
}

TEST_CASE("software drivers are marked in a comparison") {
    Json a = file({timed("x", spread(10, 0.01, 20))});
    const Json b = a;
    a["devices"][0]["software"] = true;
    const auto compared = compareResults(a, b);
    REQUIRE(compared);
    CHECK(compared->cases[0].a.software);
    CHECK(!compared->cases[0].b.software);
    CHECK_THAT(comparisonText(*compared), ContainsSubstring("* software driver: shows that the path works"));
    CHECK_THAT(comparisonText(*compared), ContainsSubstring("* "));
    CHECK(comparisonJson(*compared)["cases"][0]["a"]["software"] == true);
}

TEST_CASE("a comparison as JSON") {
    const Json a = file({timed("x", spread(10, 0.01, 20)), untimed("y", "skipped", "why")});
    const Json b = file({timed("x", spread(12, 0.01, 20))});
    const auto compared = compareResults(a, b);
    REQUIRE(compared);
    const Json json = comparisonJson(*compared);
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
