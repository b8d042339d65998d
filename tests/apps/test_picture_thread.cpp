// The thread that draws, by itself. Where it can be, it is that of the tests of the window, as a driver's start costs
// more than a frame.
#include <fstream>
#include <thread>

#include <unistd.h>

#include <catch2/catch_test_macros.hpp>

#include "apps/picture_thread.h"
#include "tests/cases.h"

using namespace skinbench;

PictureThread& threadOfWindow();  // test_view_window.cpp; skips where there are no drivers

namespace {

PictureRequest requestOf(uint64_t number, const std::vector<Case>& cases, double seconds = 0) {
    PictureRequest request{.number = number, .scene = "builtin:robot:2000", .cases = cases};
    request.settings.seconds = static_cast<float>(seconds);
    request.settings.width = 96;
    request.settings.height = 64;
    return request;
}

}  // namespace

TEST_CASE("requests that are on the way together have the pictures of their own moments", "[window]") {
    PictureThread& thread = threadOfWindow();
    const std::vector<std::vector<Case>> cases = {{makeCase("vk", "compute"), makeCase("gl", "vertex")},
                                                  {makeCase("gl", "compute"), makeCase("gl", "vertex")},
                                                  {makeCase("vk", "cpu"), makeCase("vk", "compute")},
                                                  {makeCase("gl", "cpu"), makeCase("cpu", "cpu")}};
    std::vector<PictureRequest> requests;
    for (const auto& some : cases)
        for (const double seconds : {0.0, 0.2, 0.4}) {
            requests.push_back(requestOf(requests.size() + 1, some, seconds));
            requests.back().amplify = 16;
            requests.back().accuracy = requests.size() == 5;
            requests.back().pick = Pick{1, {0.5f, 0.5f}};
        }
    for (const PictureRequest& request : requests) thread.post(request);
    std::vector<std::shared_ptr<const Pictures>> together;
    while (together.size() < requests.size()) together.push_back(thread.take());
    for (size_t i = 0; i < requests.size(); ++i) {
        CAPTURE(i);
        thread.post(requests[i]);
        const auto alone = thread.take();
        CHECK(together[i]->request.number == requests[i].number);
        for (const std::string& message : together[i]->messages) FAIL_CHECK(message);
        REQUIRE(together[i]->all.size() == (i < 9 ? 3 : 2));
        for (size_t number = 0; number < requests[i].cases.size(); ++number) {
            const CasePicture &one = alone->all[number], &other = together[i]->all[number];
            CHECK(one.error.has_value() == other.error.has_value());
            CHECK(one.error.has_value() == (requests[i].cases[number].route->api == Api::cpu));
            CHECK(one.image.rgba == other.image.rgba);
            CHECK(one.picked == other.picked);
            CHECK(one.accuracy.empty() == (i != 4));
            CHECK(one.passes.size() == other.passes.size());
            if (i % 3 && !one.error) CHECK(one.image.rgba != together[i - 1]->all[number].image.rgba);
        }
    }
}

TEST_CASE("a codec that splits vertices is drawn, and its meshlets are counted", "[window]") {
    PictureThread& thread = threadOfWindow();
    Case split = makeCase("vk-ext", "mesh");
    split.codec = findCodec("pdc8");
    PictureRequest request = requestOf(1, {split, makeCase("vk", "vertex")});
    request.scene = "builtin:biped:2000";
    thread.post(request);
    const auto drawn = thread.take();
    for (const std::string& message : drawn->messages) FAIL_CHECK(message);
    REQUIRE_FALSE(drawn->all.empty());
    CHECK(drawn->all.front().image.rgba.size() == 4u * 96 * 64);
}

TEST_CASE("a request that has not begun gives way to the next one, which asks for all that both did", "[window]") {
    threadOfWindow();
    PictureThread thread({});
    PictureRequest request = requestOf(1, {makeCase("vk", "vertex"), makeCase("gl", "vertex")});
    request.accuracy = true;
    thread.post(request);  // begins while the next two are posted
    request.accuracy = false;
    request.number = 2;
    request.pick = Pick{0, {0.5f, 0.5f}};
    thread.post(request);
    request.number = 3;
    request.pick.reset();
    thread.post(request);
    auto answer = thread.take();
    if (answer->request.number == 1) answer = thread.take();
    CHECK(answer->request.number == 3);
    CHECK_FALSE(answer->all[0].picked.empty());
    CHECK(thread.take(false) == nullptr);
}

// Not run by itself: view_tests "[memory]" prints what is resident while the cases of requests change, and while the
// same plans are made and given back without the thread.
TEST_CASE("a thousand changes of the case", "[.memory]") {
    const auto resident = [] {
        std::ifstream file("/proc/self/statm");
        size_t pages = 0;
        file >> pages >> pages;
        return pages * static_cast<size_t>(sysconf(_SC_PAGESIZE)) >> 10;
    };
    const char* const asked = std::getenv("SKINBENCH_CHANGES");
    const int changes = asked ? std::atoi(asked) : 1000;
    const std::array cases = {makeCase("vk-ext", "mesh"), makeCase("vk", "compute"), makeCase("gl", "vertex"),
                              makeCase("gl-ext", "mesh")};
    std::string window, loop;
    {
        PictureThread thread({});
        for (int i = 0; i < changes; ++i) {
            thread.post(requestOf(i + 1, {cases[i % 4], cases[(i + 1) % 4]}));
            REQUIRE(!thread.take()->all[0].error);
            if ((i + 1) % (changes / 5) == 0) window += std::format(" {}", resident());
        }
    }
    std::thread([&] {
        auto workload = openWorkload("builtin:robot:2000", {.width = 96, .height = 64});
        auto devices = openDevices({cases[0].route, cases[2].route}, "", false);
        for (int i = 0; workload && devices && i < changes * 2; ++i) {
            const Case& c = cases[i % 4];
            auto planned = planCase(*workload, c, devices->byApi[c.route->api].backend, false);
            auto ready =
                planned ? prepareCase(std::move(*planned)) : Result<Prepared>(std::unexpected(planned.error()));
            if (ready) releaseCase(*ready);
            if ((i + 1) % (changes * 2 / 5) == 0) loop += std::format(" {}", resident());
        }
    }).join();
    WARN("KiB resident, the thread:" << window << "; prepare and release alone:" << loop);
}
