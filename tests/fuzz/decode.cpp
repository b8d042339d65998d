// What a codec encoded is read back by the CPU and by the shader's text, and both agree. And any permutation code with
// any value: the shader's text decodes what the CPU takes.
#include "common/codecs/codec.h"
#include "common/codecs/permutation.h"
#include "tests/codecs/shader_decoders.h"
#include "tests/fuzz/input.h"

using namespace skinbench;

namespace {

void decodeCodec(fuzz::Input& in) {
    const auto decoders = glsl::decoders();
    const glsl::Decoder& decoder = *decoders[in.below(static_cast<uint32_t>(decoders.size()))];
    const Builder& builder = builders()[in.below(static_cast<uint32_t>(builders().size()))];
    const MeshletLimits limits{3 + in.below(253), 4 + in.below(509)};
    const PrepareOptions options{decoder.influences, static_cast<Geometry>(in.below(3)), in.flip()};
    auto stored = fuzz::takeScene(in);
    if (!stored) return;
    const auto scene = prepareScene(std::move(*stored), options);
    SKINBENCH_ASSERT(scene.has_value());
    const MeshletMesh meshlets = builder.build(scene->mesh, limits);
    SKINBENCH_ASSERT(checkMeshlets(scene->mesh, meshlets).has_value());
    const auto encoded = findCodec(decoder.codec)->encode({scene->mesh, &meshlets, decoder.influences});
    if (!encoded) return;
    const Mesh decoded = decodeOnCpu(scene->mesh, *encoded);
    SKINBENCH_ASSERT(decoded.positions.size() == encoded->vertexCount);
    const glsl::Differences differences = glsl::compareDecoded(decoder, *encoded, decoded, 1);
    SKINBENCH_ASSERT(differences.fault.empty());
    SKINBENCH_ASSERT(differences.vertices == 0);
    SKINBENCH_ASSERT(differences.readsOutside == 0);
}

void decodeCode(fuzz::Input& in) {
    const int influences = in.flip() ? 4 : 8;
    const uint32_t tuples = 1 + in.below(65536);
    const auto code = configurePermutation(influences, tuples, 1 + static_cast<int>(in.below(64)));
    if (!code) return;
    for (int i = 0; i < 8; ++i) {
        const uint64_t value = in.take<uint64_t>() >> (64 - code->bits);
        const auto expected = decodePermutation(*code, value);
        if (expected) SKINBENCH_ASSERT(glsl::decodePermutation(*code, value) == *expected);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    fuzz::Input in({data, size});
    in.below(8) == 0 ? decodeCode(in) : decodeCodec(in);
    return 0;
}
