// Images of a rendered frame: PNG files and the comparison of two routes.
#pragma once

#include <string>

#include "common/frame/backend.h"

namespace skinbench {

// Whether a PNG file takes a picture of that size: 2^28 pixels, as 16384x16384 has, and 2^20 in a row at the most. An
// error names both sizes.
Result<void> checkPngSize(uint64_t width, uint64_t height);

// Fails where checkPngSize does.
Result<void> savePng(const Image& image, const std::string& path);

// Images of one height from left to right; a single one as it is.
Image sideBySide(const std::vector<Image>& images);

// Pixels that differ by more than `threshold` in some channel, as a fraction of all pixels, and the largest
// difference of any channel. Images of different size differ everywhere (fraction 1).
struct ImageDifference {
    double fraction = 0;
    uint32_t largest = 0;
};
ImageDifference compareImages(const Image& a, const Image& b, uint32_t threshold);

// |a - b| in each channel, times `amplify`, opaque; how many pixels differ, and by how much at the most. Images of
// different size differ in all pixels of the larger one, and the picture is black.
struct DifferenceImage {
    Image image;
    uint64_t pixels = 0;
    uint32_t largest = 0;
};
DifferenceImage differenceImage(const Image& a, const Image& b, uint32_t amplify);

// How much was drawn at all: pixels that differ from the background (the pixel at the top left), as a fraction.
double coveredFraction(const Image& image);

}  // namespace skinbench
