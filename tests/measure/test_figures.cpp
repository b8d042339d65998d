// What the samples of a case say. No driver takes part.
#include <catch2/catch_test_macros.hpp>

#include "common/measure/bench.h"

using namespace skinbench;

TEST_CASE("figures are made of all samples of a case") {
    CaseResult result;
    result.status = CaseStatus::ok;
    CHECK(!isTimed(result));
    result.total = {1, 2, 3, 4, 5, 100};
    result.roundSizes = {3, 3};
    result.passes = {{"skin", {1, 2, 3, 4, 5, 6}}, {"draw", {7}}};
    result.record = {1, 3};
    result.submit = {0.5};
    result.figures = figuresOf(result);
    CHECK(isTimed(result));
    const CaseFigures& figures = *result.figures;
    CHECK(figures.total.median == 3.5);
    CHECK(figures.total.max == 100);
    CHECK(figures.interval == medianInterval(result.total, result.roundSizes));
    CHECK(figures.wideInterval == medianInterval(result.total, result.roundSizes, 0.995));
    CHECK(figures.outliers == 1);
    CHECK(figures.drift.relative == 3 / 3.5);
    CHECK(figures.passes.at("skin").median == 3.5);
    CHECK(figures.passes.at("draw").median == 7);
    CHECK(figures.record.median == 2);
    CHECK(figures.submit.median == 0.5);
    CHECK(!figures.overlapped);
    CHECK(!figures.overlappedInterval);

    result.overlapped = {2, 2, 2, 4, 4, 4};
    result.figures = figuresOf(result);
    CHECK(result.figures->overlapped->median == 3);
    CHECK(result.figures->overlappedInterval == Interval{2, 4});
    CHECK(!result.figures->batch);
    result.batches = {3, 3, 4, 5, 5, 5};
    result.batchRounds = {3, 3};
    result.figures = figuresOf(result);
    CHECK(result.figures->batch->median == 4.5);
    CHECK(result.figures->batchInterval == Interval{3, 5});
    result.status = CaseStatus::failed;
    CHECK(!isTimed(result));
}
