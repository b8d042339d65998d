// Vertex codecs: how one vertex lies in memory; docs/codecs.md draws every bit. A codec is an encoder (a file in
// common/codecs), a decoder (a file in shaders_glsl/codecs) and a row in codecs().
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "common/frame/backend.h"
#include "common/frame/shader_text.h"
#include "common/meshlets/meshlets.h"
#include "common/scene/scene.h"

namespace skinbench {

using Bytes = std::shared_ptr<const std::vector<std::byte>>;

template <class T>
Bytes toBytes(const std::vector<T>& values) {
    auto first = reinterpret_cast<const std::byte*>(values.data());
    return std::make_shared<const std::vector<std::byte>>(first, first + values.size() * sizeof(T));
}

// The largest differences between a vertex as it was given and as it decodes, in the bind pose.
struct CodecBounds {
    glm::dvec3 position{0};   // per axis, in units of the scene
    double weights = 0;       // sum of the absolute differences of a vertex' weights; both sum to 1
    bool addsJoints = false;  // a joint that the vertex does not have may get such a weight
};

struct EncodedMesh {
    uint32_t vertexCount = 0;                 // after splitting, where a codec splits
    Bytes vertices;                           // SLOT_VERTEX
    Bytes tuples;                             // SLOT_TUPLE, null where there is none
    Bytes meshletExtra;                       // SLOT_MESHLET_EXTRA, null where there is none
    std::optional<MeshletMesh> meshlets;      // where the codec rewrites vertex references
    std::vector<uint8_t> blendBytes;          // per meshlet, below 8: of a vertex; empty where all vertices are equal
    std::vector<uint32_t> firstBytes;         // per meshlet: where its first vertex lies; empty likewise
    std::vector<VertexAttribute> attributes;  // empty: no attribute format can carry this codec
    uint32_t attributeStride = 0;
    Defines defines;                    // for every stage that decodes
    std::vector<uint32_t> sources;      // per vertex: vertex of the mesh that it came from; empty: itself
    std::function<Mesh()> decode;       // null: the mesh's own attributes, bit for bit; use decodeOnCpu. Of a vertex
                                        // none weighs more than the first by 0.01, which rounding may do
    std::optional<CodecBounds> bounds;  // empty where decode is null, or nothing is promised

    // How a vertex' joints and weights are stored, as it is read for a meshlet of `meshlets`: "permutation code 7 in 32
    // bits, tuple 3". Null: they lie in fields of their own.
    std::function<std::string(uint32_t vertex, size_t meshlet)> blendText;
};

// What an encoder is given. `slimRecords` and `fat` are for codecs that some row's `slim` names.
struct EncodeInput {
    const Mesh& mesh;                       // prepared with `influences` influences
    const MeshletMesh* meshlets = nullptr;  // null on routes without mesh shaders
    int influences = 4;                     // 4 or 8
    uint32_t slimRecords = 0;               // the first ones, whose joints their meshlet lists
    bool fat = false;                       // they keep joint ids that nothing reads
};

struct Codec {
    const char* name;
    const char* what;
    const char* shader;            // below shaders_glsl/
    bool needsMeshlets = false;    // decodes in mesh stages only
    bool feedsAttributes = false;  // fixed-function vertex attributes can carry it
    bool storesJoints = true;      // skinned vertices can be made from it
    bool takesSlots = false;       // its joint ids may be slots of a small palette
    int mostInfluences = 8;
    const char* slim = nullptr;  // codec of the same vertices where meshlets list the joints; null: there is none
    Result<EncodedMesh> (*encode)(const EncodeInput& in);
};

// The codecs that `all` stands for. findCodec also knows pc16, pc24 … pc64: permutation codes of that many bits, fitted
// to the mesh's number of tuples; wicked; ids, which stores nothing (limitCase); and those that a row's `slim` names.
const std::vector<Codec>& codecs();
const Codec* findCodec(const std::string& name);

// Why the codec cannot hold that many influences; empty: it can.
std::optional<std::string> cannotHold(const Codec& codec, int influences);

// What a shader sees after decoding: the vertex arrays, one element an encoded vertex, in single precision that a GPU
// matches to a few units in the last place; no indices. Reads the encoded bytes, not the mesh, where a codec loses any.
Mesh decodeOnCpu(const Mesh& mesh, const EncodedMesh& encoded);

// --- encoders --------------------------------------------------------------------------------------------------

// docs/codecs.md 8.2. Uncompressed, 64 bytes with 4 influences (Kimmersdorfer 3.3) and 96 with 8;
// shaders_glsl/codecs/uc.glsl reads it. Irrelevant influences are stored as joint 0 with weight 0, so that reading the
// palette needs no test.
Result<EncodedMesh> encodeUncompressed(const EncodeInput& in);

// Quantised attributes in 14 bytes and u16 joints and unorm16 weights behind them: 30 bytes, 46 with 8 influences.
Result<EncodedMesh> encodeUc16(const EncodeInput& in);

// Optimal Simplex Sampling, 4 influences, 18 bytes: a code of 16 bits with 65536 tuples, or of 22 bits with 1024.
Result<EncodedMesh> encodeOss16(const EncodeInput& in);
Result<EncodedMesh> encodeOss22(const EncodeInput& in);

// Permutation Coding with 65536 tuples: 32 bits and 18 bytes, 64 bits and 22 bytes with 8 influences.
Result<EncodedMesh> encodePc(const EncodeInput& in);

// Permutation Coding in `bits` (16, 24 … 64) for exactly as many tuples as the mesh has: 14 + bits / 8 bytes.
template <int bits>
Result<EncodedMesh> encodePcBits(const EncodeInput& in);

// Meshlet difference encoding, 4 influences (common/codecs/differences.h). Vertices are split where meshlets cannot
// share them; `meshlets` must not be null. dpdc16 counts 8192 merged tuples, or 16384 with coarser weights where a mesh
// needs them.
Result<EncodedMesh> encodePdc8(const EncodeInput& in);
Result<EncodedMesh> encodePdc16(const EncodeInput& in);
Result<EncodedMesh> encodePdc32(const EncodeInput& in);
Result<EncodedMesh> encodeDpdc16(const EncodeInput& in);

// docs/codecs.md 8.6. As Wicked Engine lays out what its skinning reads, 4 influences, 36 bytes: positions as floats,
// normals as bytes, joints and weights as encodeUc16 has them.
Result<EncodedMesh> encodeWicked(const EncodeInput& in);

// docs/codecs.md 8.4. Uncompressed as encodeUncompressed, but the first `slimRecords` records hold no joint ids: 48
// bytes instead of 64 with 4 influences, 64 instead of 96 with 8. `fat`: no record is slim.
Result<EncodedMesh> encodeSlim(const EncodeInput& in);

// No bytes at all: the decoder places vertex n of a copy by its number, in the bounding box of the mesh.
Result<EncodedMesh> encodeIds(const EncodeInput& in);

}  // namespace skinbench
