// PNG files decoded by another library, the comparison of two routes, and how much of an image was drawn.
#include <cstring>
#include <filesystem>
#include <format>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include "common/core/file.h"
#include "common/frame/animation.h"
#include "common/frame/image.h"
#include "tests/scene/gltf_fixture.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

namespace {

Image plain(uint32_t width, uint32_t height, std::array<uint8_t, 4> color) {
    Image image{width, height, {}};
    for (uint32_t i = 0; i < width * height; ++i) image.rgba.insert(image.rgba.end(), color.begin(), color.end());
    return image;
}

uint8_t& channel(Image& image, uint32_t x, uint32_t y, uint32_t c) {
    return image.rgba[(size_t{y} * image.width + x) * 4 + c];
}

}  // namespace

TEST_CASE("the fraction counts pixels beyond the threshold, the largest difference counts them all") {
    const Image a = plain(10, 10, {100, 100, 100, 255});
    Image b = a;
    CHECK(compareImages(a, b, 0).fraction == 0);
    CHECK(compareImages(a, b, 0).largest == 0);
    channel(b, 3, 4, 1) = 103;
    channel(b, 9, 9, 2) = 98;
    channel(b, 9, 9, 0) = 105;
    CHECK(compareImages(a, b, 0).fraction == 0.02);
    CHECK(compareImages(a, b, 2).fraction == 0.02);
    CHECK(compareImages(a, b, 3).fraction == 0.01);
    CHECK(compareImages(a, b, 5).fraction == 0);
    CHECK(compareImages(a, b, 5).largest == 5);
    CHECK(compareImages(b, a, 3).fraction == 0.01);
}

TEST_CASE("every channel takes part, alpha too, in both directions") {
    const Image a = plain(4, 4, {10, 20, 30, 40});
    for (uint32_t c = 0; c < 4; ++c)
        for (int step : {-9, 9}) {
            Image b = a;
            channel(b, 2, 1, c) = static_cast<uint8_t>(int{channel(b, 2, 1, c)} + step);
            CHECK(compareImages(a, b, 8).fraction == 1.0 / 16);
            CHECK(compareImages(a, b, 8).largest == 9);
        }
}

TEST_CASE("images of different size differ everywhere") {
    const Image a = plain(4, 4, {0, 0, 0, 0});
    CHECK(compareImages(a, plain(4, 5, {0, 0, 0, 0}), 255).fraction == 1);
    CHECK(compareImages(a, plain(8, 2, {0, 0, 0, 0}), 255).fraction == 1);
    CHECK(compareImages(a, Image{}, 255).fraction == 1);
    CHECK(compareImages(Image{}, Image{}, 0).fraction == 0);
}

TEST_CASE("the covered fraction counts what is not the background") {
    Image image = plain(8, 4, {1, 2, 3, 255});
    CHECK(coveredFraction(image) == 0);
    channel(image, 7, 3, 0) = 2;
    CHECK(coveredFraction(image) == 1.0 / 32);
    for (uint32_t x = 0; x < 8; ++x) channel(image, x, 2, 3) = 254;
    CHECK(coveredFraction(image) == 9.0 / 32);
    CHECK(coveredFraction(Image{}) == 0);
}

TEST_CASE("a PNG file decodes to the same pixels") {
    for (auto [width, height] : {std::pair{1u, 1u}, {2u, 3u}, {65u, 33u}, {320u, 180u}}) {
        Image image = plain(width, height, {0, 0, 0, 0});
        for (size_t i = 0; i < image.rgba.size(); ++i)
            image.rgba[i] = static_cast<uint8_t>(i * 2654435761u >> 13 ^ i / 7);
        const std::string path = (fixture::temporaryFolder() / "image.png").string();
        REQUIRE(savePng(image, path));
        const auto bytes = readWholeFile(path);
        REQUIRE(bytes);
        CHECK(bytes->substr(0, 8) == std::string("\x89PNG\r\n\x1a\n", 8));
        int w = 0, h = 0, channels = 0;
        stbi_uc* pixels = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes->data()),
                                                static_cast<int>(bytes->size()), &w, &h, &channels, 0);
        REQUIRE(pixels);
        CHECK(w == static_cast<int>(width));
        CHECK(h == static_cast<int>(height));
        CHECK(channels == 4);
        CHECK(std::memcmp(pixels, image.rgba.data(), image.rgba.size()) == 0);
        stbi_image_free(pixels);
    }
}

TEST_CASE("an image that cannot be saved is an error with the path") {
    const std::string below = fixture::writeText("plain_file", "x") + "/image.png";
    const auto saved = savePng(plain(2, 2, {1, 1, 1, 1}), below);
    REQUIRE(!saved);
    CHECK(saved.error().text.starts_with(below + ": "));
}

TEST_CASE("a picture that a file cannot hold is refused by its size, before there is any") {
    constexpr uint64_t kSide = 16384, kWidest = uint64_t{1} << 20, kMost = uint64_t{1} << 28;
    for (auto [width, height] : {std::pair<uint64_t, uint64_t>{1, 1}, {kSide, kSide}, {1, kMost}, {kWidest, 256}}) {
        INFO(width << "x" << height);
        CHECK(checkPngSize(width, height));
        // As an encoder with 32-bit ints counts: a row with its filter, all rows packed, the sum over a row.
        CHECK((width * 4 + 1) * height / 8 * 9 < uint64_t{3} << 29);
        CHECK(width * 4 * 128 < uint64_t{1} << 31);
    }
    for (auto [width, height] : {std::pair<uint64_t, uint64_t>{2 * kSide, kSide},
                                 {kSide, kSide + 1},
                                 {kWidest + 1, 1},
                                 {1, kMost + 1},
                                 {UINT64_MAX, UINT64_MAX}}) {
        const auto fits = checkPngSize(width, height);
        REQUIRE(!fits);
        CHECK(fits.error().fault == Fault::input);
        CHECK(fits.error().text.starts_with(
            std::format("a picture of {}x{} is too large for a PNG file", width, height)));
        CHECK_THAT(fits.error().text, ContainsSubstring("the largest is 16384x16384"));
    }
    CHECK(savePng({2 * kSide, kSide, {}}, "unwritten.png").error().text.starts_with("unwritten.png: a picture of "));
    CHECK(checkWebpSize(16383, 16383));
    for (auto [width, height] : {std::pair<uint64_t, uint64_t>{16384, 1}, {1, 16384}, {UINT64_MAX, 1}})
        CHECK(
            checkWebpSize(width, height).error().text ==
            std::format("a picture of {}x{} is too large for a WebP file; the largest is 16383x16383", width, height));
}

TEST_CASE("images stand side by side, row by row") {
    const Image a{1, 2, {1, 1, 1, 1, 2, 2, 2, 2}}, b{2, 2, {3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 6, 6, 6, 6}};
    const Image both = sideBySide({a, b});
    CHECK(both.width == 3);
    CHECK(both.height == 2);
    CHECK(both.rgba == std::vector<uint8_t>{1, 1, 1, 1, 3, 3, 3, 3, 4, 4, 4, 4, 2, 2, 2, 2, 5, 5, 5, 5, 6, 6, 6, 6});
    CHECK(sideBySide({a}).rgba == a.rgba);
}
