// Compressed views of a stranger: every mode, filter and element size.
#include <array>

#include "common/scene/gltf/gltf_data.h"
#include "tests/fuzz/input.h"

using namespace skinbench;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr std::array<const char*, 4> kModes = {"ATTRIBUTES", "TRIANGLES", "INDICES", "OTHER"};
    constexpr std::array<const char*, 6> kFilters = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR", "X"};
    fuzz::Input in({data, size});
    CompressedView view;
    view.extension = "KHR_meshopt_compression";
    view.mode = kModes[in.take<uint8_t>() % kModes.size()];
    view.filter = kFilters[in.take<uint8_t>() % kFilters.size()];
    view.stride = in.take<uint16_t>();
    view.count = in.take<uint32_t>();
    view.bytes = in.rest();
    view.length = view.bytes.size();
    GltfBudget budget{view.length * kGltfBudgetFactor + (1u << 16)};
    const auto bytes = decompressView(view, budget);
    SKINBENCH_ASSERT(bytes ? bytes->size() == view.count * view.stride : !bytes.error().text.empty());
    return 0;
}
