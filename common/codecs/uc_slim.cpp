#include <bit>

#include "common/codecs/codec.h"

namespace skinbench {

Result<EncodedMesh> encodeSlim(const EncodeInput& in) {
    const auto& [mesh, meshlets, influences, slimRecords, fat] = in;
    SKINBENCH_ASSERT(influences == 4 || influences == 8);
    const uint32_t slim = fat ? 0 : slimRecords;
    const auto records = static_cast<uint32_t>(mesh.positions.size());
    const auto surface = size_t{8};
    const auto four = static_cast<size_t>(influences);
    std::vector<uint32_t> out;
    out.reserve(slim * (surface + four) + (records - slim) * (surface + 2 * four));
    auto bits = [](float value) { return std::bit_cast<uint32_t>(value); };
    for (uint32_t v = 0; v < records; ++v) {
        const glm::vec3 p = mesh.positions[v], n = mesh.normals[v];
        const glm::vec2 uv = mesh.uvs[v];
        for (float value : {p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y}) out.push_back(bits(value));
        const Influences& from = mesh.influences[v];
        for (int first = 0; first < influences; first += 4) {
            for (int i = first; i < first + 4 && v >= slim; ++i)
                out.push_back(from.joints[i] == kNoJoint ? 0 : from.joints[i]);
            for (int i = first; i < first + 4; ++i)
                out.push_back(from.joints[i] == kNoJoint ? 0 : bits(from.weights[i]));
        }
    }
    EncodedMesh encoded;
    encoded.vertexCount = records;
    encoded.vertices = toBytes(out);
    encoded.defines = {{"SLIM_RECORDS", std::to_string(slim)}, {"FAT_RECORDS", fat ? "1" : "0"}};
    return encoded;
}

}  // namespace skinbench
