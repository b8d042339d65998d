#include "common/stats.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace skinbench {

Summary summarise(std::span<const double> samples) {
    Summary summary;
    if (samples.empty()) return summary;
    std::vector<double> sorted(samples.begin(), samples.end());
    std::ranges::sort(sorted);
    const size_t n = sorted.size();
    summary.min = sorted.front();
    summary.max = sorted.back();
    summary.median = n % 2 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
    summary.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(n);
    if (n < 2 || summary.mean == 0) return summary;
    double squares = 0;
    for (double sample : sorted) squares += (sample - summary.mean) * (sample - summary.mean);
    summary.cv = std::sqrt(squares / static_cast<double>(n - 1)) / summary.mean;
    return summary;
}

}  // namespace skinbench
