#include <cstring>

#include "common/codecs/codec.h"
#include "common/core/parallel.h"

namespace skinbench {

Result<EncodedMesh> encodeUncompressed(const EncodeInput& in) {
    const Mesh& mesh = in.mesh;
    const int influences = in.influences;
    SKINBENCH_ASSERT(influences == 4 || influences == 8);
    const size_t words = influences == 4 ? 16 : 24;
    std::vector<uint32_t> out(mesh.positions.size() * words, 0);
    parallelRanges(mesh.positions.size(), [&](size_t begin, size_t end) {
        for (size_t v = begin; v < end; ++v) {
            uint32_t* word = &out[v * words];
            std::memcpy(word, &mesh.positions[v], 12);
            std::memcpy(word + 3, &mesh.normals[v], 12);
            std::memcpy(word + 6, &mesh.uvs[v], 8);
            for (int i = 0; i < influences; ++i) {
                const Influences& from = mesh.influences[v];
                if (from.joints[i] == kNoJoint || from.weights[i] == 0) continue;
                uint32_t* four = word + 8 + i / 4 * 8;
                four[i % 4] = from.joints[i];
                std::memcpy(four + 4 + i % 4, &from.weights[i], 4);
            }
        }
    });
    EncodedMesh encoded;
    encoded.vertexCount = static_cast<uint32_t>(mesh.positions.size());
    encoded.vertices = toBytes(out);
    encoded.attributeStride = static_cast<uint32_t>(words * 4);
    encoded.attributes = {{0, AttributeFormat::float3, 0},
                          {1, AttributeFormat::float3, 12},
                          {2, AttributeFormat::float2, 24},
                          {3, AttributeFormat::uint4, 32},
                          {4, AttributeFormat::float4, 48}};
    if (influences == 8) {
        encoded.attributes.push_back({5, AttributeFormat::uint4, 64});
        encoded.attributes.push_back({6, AttributeFormat::float4, 80});
    }
    return encoded;
}

}  // namespace skinbench
