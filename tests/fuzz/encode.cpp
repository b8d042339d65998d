// From a loaded scene to the buffers and the plan of any case.
#include "tests/cases.h"
#include "tests/fuzz/input.h"

using namespace skinbench;

namespace {

const std::vector<Case>& cases() {
    static const std::vector<Case> all = everyCase();
    return all;
}

}  // namespace

// What takes a second of its own is no part of the first input's time.
extern "C" int LLVMFuzzerInitialize(int*, char***) { return cases().empty(); }

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const ShaderLibrary shaders = testShaders();
    fuzz::Input in({data, size});
    const Case& c = cases()[in.below(static_cast<uint32_t>(cases().size()))];
    WorkloadSettings settings;
    settings.prepare.geometry = static_cast<Geometry>(in.below(3));
    settings.prepare.cacheOrder = in.flip();
    settings.copies = 1 + in.below(3);
    auto scene = fuzz::takeScene(in);
    if (!scene) return 0;
    auto workload = makeWorkload(std::move(*scene), shaders, settings);
    SKINBENCH_ASSERT(workload.has_value());
    const auto input = planInput(*workload, c);
    const auto plan = input ? makePlan(c, *input, generousCaps(c.route->api)) : std::unexpected(input.error());
    SKINBENCH_ASSERT(plan || !plan.error().text.empty());
    return 0;
}
