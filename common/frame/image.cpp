#include "common/frame/image.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <format>
#include <new>

// stb writes on where it gets no memory.
namespace {
void* orThrow(void* memory) { return memory ? memory : throw std::bad_alloc(); }
}  // namespace
#define STBIW_MALLOC(bytes) orThrow(std::malloc(bytes))
#define STBIW_REALLOC(memory, bytes) orThrow(std::realloc(memory, bytes))
#define STBIW_FREE(memory) std::free(memory)

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#include "common/core/file.h"

namespace skinbench {

// stb counts in 32-bit ints. Its largest is the room for what it packs, which grows to 3 * 2^k - 1 bytes: 2^28 pixels
// are up to 5 * 2^28 bytes with a filter's byte in front of each row, and each byte packs into 9 bits at the most, less
// than 3 * 2^29 in all. The sum of the bytes of a row is the other one: 2^20 pixels times 4 times 128.
Result<void> checkPngSize(uint64_t width, uint64_t height) {
    constexpr uint64_t kMostPixels = uint64_t{1} << 28, kWidest = uint64_t{1} << 20;
    if (width <= kWidest && height <= kMostPixels / std::max<uint64_t>(width, 1)) return {};
    return inputError(
        std::format("a picture of {}x{} is too large for a PNG file; the largest is 16384x16384, or as "
                    "many pixels ({}) in another shape",
                    width, height, kMostPixels));
}

Result<void> savePng(const Image& image, const std::string& path) {
    if (const auto fits = checkPngSize(image.width, image.height); !fits) return errorAt(path, fits.error());
    std::string bytes;
    auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(size));
    };
    if (!stbi_write_png_to_func(append, &bytes, static_cast<int>(image.width), static_cast<int>(image.height), 4,
                                image.rgba.data(), static_cast<int>(image.width * 4)))
        return deviceError(path + ": the image could not be encoded");
    return writeWholeFile(path, bytes);
}

Image sideBySide(const std::vector<Image>& images) {
    Image all;
    for (const Image& image : images) {
        SKINBENCH_ASSERT(image.height == images.front().height);
        all.width += image.width;
        all.height = image.height;
    }
    all.rgba.reserve(size_t{all.width} * all.height * 4);
    for (uint32_t row = 0; row < all.height; ++row)
        for (const Image& image : images) {
            const auto first = image.rgba.begin() + static_cast<std::ptrdiff_t>(size_t{row} * image.width * 4);
            all.rgba.insert(all.rgba.end(), first, first + static_cast<std::ptrdiff_t>(size_t{image.width} * 4));
        }
    return all;
}

ImageDifference compareImages(const Image& a, const Image& b, uint32_t threshold) {
    if (a.width != b.width || a.height != b.height || a.rgba.size() != b.rgba.size()) return {1, 255};
    ImageDifference difference;
    size_t different = 0;
    for (size_t pixel = 0; pixel + 3 < a.rgba.size(); pixel += 4) {
        uint32_t largest = 0;
        for (size_t c = pixel; c < pixel + 4; ++c)
            largest = std::max(largest, static_cast<uint32_t>(std::abs(int{a.rgba[c]} - int{b.rgba[c]})));
        difference.largest = std::max(difference.largest, largest);
        different += largest > threshold;
    }
    difference.fraction =
        a.rgba.empty() ? 0 : static_cast<double>(different) / (static_cast<double>(a.rgba.size()) / 4);
    return difference;
}

DifferenceImage differenceImage(const Image& a, const Image& b, uint32_t amplify) {
    DifferenceImage difference{{std::max(a.width, b.width), std::max(a.height, b.height), {}}};
    difference.image.rgba.assign(size_t{difference.image.width} * difference.image.height * 4, 0);
    for (size_t alpha = 3; alpha < difference.image.rgba.size(); alpha += 4) difference.image.rgba[alpha] = 255;
    if (a.width != b.width || a.height != b.height) {
        difference.pixels = difference.image.rgba.size() / 4;
        difference.largest = 255;
        return difference;
    }
    for (size_t pixel = 0; pixel + 3 < a.rgba.size(); pixel += 4) {
        if (std::memcmp(&a.rgba[pixel], &b.rgba[pixel], 4) == 0) continue;
        ++difference.pixels;
        for (size_t c = pixel; c < pixel + 4; ++c) {
            const auto by = static_cast<uint32_t>(std::abs(int{a.rgba[c]} - int{b.rgba[c]}));
            difference.largest = std::max(difference.largest, by);
            if (c < pixel + 3) difference.image.rgba[c] = static_cast<uint8_t>(std::min(255u, by * amplify));
        }
    }
    return difference;
}

double coveredFraction(const Image& image) {
    size_t covered = 0;
    for (size_t pixel = 4; pixel + 3 < image.rgba.size(); pixel += 4)
        covered += std::memcmp(&image.rgba[pixel], image.rgba.data(), 4) != 0;
    return image.rgba.empty() ? 0 : static_cast<double>(covered) / (static_cast<double>(image.rgba.size()) / 4);
}

}  // namespace skinbench
