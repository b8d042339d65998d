#include "common/frame/animation.h"

#include <algorithm>
#include <format>
#include <string_view>

#include "common/core/file.h"

namespace skinbench {

Result<void> checkWebpSize(uint64_t width, uint64_t height) {
    constexpr uint64_t kMostPixels = 16383;  // each way
    if (std::max(width, height) <= kMostPixels) return {};
    return inputError(std::format("a picture of {}x{} is too large for a WebP file; the largest is {}x{}", width,
                                  height, kMostPixels, kMostPixels));
}

}  // namespace skinbench

#ifdef SKINBENCH_WEBP

#include <webp/encode.h>
#include <webp/mux.h>

namespace skinbench {

bool hasAnimations() { return true; }

struct Animation::State {
    uint32_t width, height;
    int quality;
    int time = 0;  // milliseconds
    WebPAnimEncoder* encoder = nullptr;
    ~State() { WebPAnimEncoderDelete(encoder); }
};

static std::string whyNot(WebPAnimEncoder* encoder) { return encoder ? WebPAnimEncoderGetError(encoder) : "no memory"; }

Animation::Animation(uint32_t width, uint32_t height, int quality) : state_(new State{width, height, quality}) {
    WebPAnimEncoderOptions options;
    SKINBENCH_ASSERT(WebPAnimEncoderOptionsInit(&options));
    options.minimize_size = 1;
    state_->encoder = WebPAnimEncoderNew(static_cast<int>(width), static_cast<int>(height), &options);
}

Animation::~Animation() = default;

Result<void> Animation::add(const Image& image, int milliseconds) {
    SKINBENCH_ASSERT(image.width == state_->width && image.height == state_->height);
    WebPConfig config;
    WebPPicture picture;
    SKINBENCH_ASSERT(WebPConfigInit(&config) && WebPPictureInit(&picture));
    config.quality = static_cast<float>(state_->quality);
    config.method = 4;
    picture.use_argb = 1;
    picture.width = static_cast<int>(image.width);
    picture.height = static_cast<int>(image.height);
    const bool added = state_->encoder &&
                       WebPPictureImportRGBX(&picture, image.rgba.data(), static_cast<int>(image.width * 4)) &&
                       WebPAnimEncoderAdd(state_->encoder, &picture, state_->time, &config);
    WebPPictureFree(&picture);
    if (!added) return deviceError(std::format("a frame could not be encoded as WebP: {}", whyNot(state_->encoder)));
    state_->time += milliseconds;
    return {};
}

Result<void> Animation::save(const std::string& path) {
    WebPData data;
    WebPDataInit(&data);
    const bool whole = WebPAnimEncoderAdd(state_->encoder, nullptr, state_->time, nullptr) &&
                       WebPAnimEncoderAssemble(state_->encoder, &data);
    auto written = whole ? writeWholeFile(path, {reinterpret_cast<const char*>(data.bytes), data.size})
                         : Result<void>(deviceError(std::format("{}: the frames could not be put together: {}", path,
                                                                whyNot(state_->encoder))));
    WebPDataClear(&data);
    return written;
}

}  // namespace skinbench

#else

namespace skinbench {

bool hasAnimations() { return false; }

struct Animation::State {};
Animation::Animation(uint32_t, uint32_t, int) {}
Animation::~Animation() = default;
Result<void> Animation::add(const Image&, int) { return inputError("this build cannot write WebP files"); }
Result<void> Animation::save(const std::string&) { return inputError("this build cannot write WebP files"); }

}  // namespace skinbench

#endif
