// One or two result files of a stranger, a byte 0x1e between them: what is loaded can be shown on a page and
// compared. Tables are made of a run's own results alone.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "common/report/compare.h"
#include "common/report/report.h"
#include "tests/fuzz/input.h"

using namespace skinbench;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::span<const uint8_t> all(data, size);
    const auto middle = static_cast<size_t>(std::ranges::find(all, 0x1e) - all.begin());
    const auto a = loadResults(fuzz::fileOf(all.first(middle)));
    SKINBENCH_ASSERT(a || !a.error().text.empty());
    if (!a) return 0;
    const auto b = middle < size ? loadResults(fuzz::fileOf(all.subspan(middle + 1))) : a;
    if (!b) return 0;
    SKINBENCH_ASSERT(!reportHtml({*a, *b}, {"a"}).empty());
    const auto comparison = compareResults(*a, *b);
    if (!comparison) return 0;
    findWorse(*comparison, 3, false);
    SKINBENCH_ASSERT(!comparisonText(*comparison).empty() && comparisonJson(*comparison).is_object());
    return 0;
}
