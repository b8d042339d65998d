// A test of backends runs once for the null backend and once for each API of this machine, under validation, which must
// have nothing to say.
#pragma once

#include <cstdlib>
#include <iostream>

#include <catch2/generators/catch_generators_range.hpp>

#include "tests/drivers.h"
#include "tests/frame/hand_plans.h"

namespace skinbench::hand {

// images: all backends but the null one, which draws none.
enum class Needs { nothing, images };

struct Opened {
    std::unique_ptr<Backend> backend;
    bool draws = true;
};

// Opened once for all tests of a process.
inline const std::vector<Opened>& openedSubjects() {
    static const std::vector<Opened> all = [] {
        std::vector<Opened> opened;
        DeviceCaps caps = generousCaps(Api::vulkan);
        caps.maxImageSize = 16384;
        caps.pipelineStatistics = true;
        caps.secondQueue = true;
        opened.push_back({openNull(caps), false});
        auto add = [&](Result<std::unique_ptr<Backend>> backend) {
            if (backend)
                opened.push_back({std::move(*backend)});
            else
                std::cerr << "no driver: " << backend.error().text << "\n";
        };
        // Hazards on storage buffers too; not on by default, as draws that write apart from each other look like one.
        setenv("VK_LAYER_SYNCVAL_SHADER_ACCESSES_HEURISTIC", "1", 1);
        add(openVulkan({.device = {}, .validation = underValidation()}));
        unsetenv("VK_LAYER_SYNCVAL_SHADER_ACCESSES_HEURISTIC");
        add(openGl({.device = {}, .validation = underValidation()}));
        return opened;
    }();
    return all;
}

// Runs the test once for each backend, and releases what the test prepared.
struct Subject {
    explicit Subject(Needs needs = Needs::nothing) {
        const size_t first = needs == Needs::images ? 1 : 0;
        if (first == openedSubjects().size()) SKIP("no Vulkan and no OpenGL driver on this machine");
        const Opened& opened = openedSubjects()[GENERATE_COPY(range(first, openedSubjects().size()))];
        backend = opened.backend.get();
        draws = opened.draws;
    }
    Subject(const Subject&) = delete;
    ~Subject() {
        for (PlanId id : prepared) backend->release(id);
        for (const std::string& message : backend->takeMessages()) FAIL_CHECK(message);
    }

    PlanId prepare(const FramePlan& plan) { return prepared.emplace_back(must(backend->prepare(plan))); }
    std::vector<Timing> run(PlanId id, const std::vector<FrameInput>& frames = {stillFrame()},
                            RunMode mode = RunMode::timed) {
        return must(backend->run(id, frames, mode));
    }
    Image image(const FramePlan& plan, const std::vector<FrameInput>& frames = {stillFrame()},
                RunMode mode = RunMode::timed) {
        const PlanId id = prepare(plan);
        run(id, frames, mode);
        Image image = must(backend->readImage(id));
        CHECK((image.width == plan.width && image.height == plan.height));
        REQUIRE(image.rgba.size() == size_t{4} * plan.width * plan.height);
        return image;
    }
    template <class T>
    std::vector<T> stream(PlanId id, uint32_t slot) {
        return valuesOf<T>(must(backend->readStream(id, slot)));
    }

    Backend* backend = nullptr;
    bool draws = false;
    std::vector<PlanId> prepared;
    Api api() const { return backend->caps().api; }
};

inline bool onlyUpperHalf(const Image& image, uint32_t color) {
    const size_t lit = countOf(image, color), all = size_t{image.width} * image.height;
    return upperHalf(image) == color && lowerHalf(image) == kBackground && lit + countOf(image, kBackground) == all &&
           lit * 2 > all - 2 * image.width && lit * 2 < all + 2 * image.width;
}

inline bool nothingDrawn(const Image& image) {
    return countOf(image, kBackground) == size_t{image.width} * image.height;
}

inline std::vector<RunMode> drawingModes(const Subject& subject) {
    std::vector<RunMode> modes = {RunMode::timed, RunMode::overlap, RunMode::batch};
    if (subject.backend->caps().pipelineStatistics) modes.push_back(RunMode::counted);
    return modes;
}

inline void checkOneSentence(const Error& error, Fault fault, const std::string& text) {
    CHECK(error.fault == fault);
    CHECK(error.text == text);
    CHECK_FALSE(error.text.contains('\n'));
    CHECK_FALSE(error.text.ends_with('.'));
}

}  // namespace skinbench::hand
