// Statistics of repeated measurements. Pure functions.
#pragma once

#include <span>

namespace skinbench {

// cv is the sample standard deviation (n - 1) over the mean; 0 for fewer than two samples or a mean of 0.
struct Summary {
    double mean = 0;
    double median = 0;
    double min = 0;
    double max = 0;
    double cv = 0;
};

// All zero for no samples. The median of an even count is the mean of the two in the middle.
Summary summarise(std::span<const double> samples);

}  // namespace skinbench
