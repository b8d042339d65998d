// Vertex codecs: how one vertex lies in memory. A codec is an encoder (a file in common/codecs), a decoder (a file in
// shaders_glsl/codecs) and a row in codecs().
#pragma once

#include <memory>
#include <optional>

#include "common/backend.h"
#include "common/meshlets.h"
#include "common/scene.h"
#include "common/shader_text.h"

namespace skinbench {

using Bytes = std::shared_ptr<const std::vector<std::byte>>;

template <class T>
Bytes toBytes(const std::vector<T>& values) {
    auto first = reinterpret_cast<const std::byte*>(values.data());
    return std::make_shared<const std::vector<std::byte>>(first, first + values.size() * sizeof(T));
}

struct EncodedMesh {
    uint32_t vertexCount = 0;                 // after splitting, where a codec splits
    Bytes vertices;                           // SLOT_VERTEX
    Bytes tuples;                             // SLOT_TUPLE, null where there is none
    Bytes meshletExtra;                       // SLOT_MESHLET_EXTRA, null where there is none
    std::optional<MeshletMesh> meshlets;      // where the codec rewrites vertex references
    std::vector<VertexAttribute> attributes;  // empty: no attribute format can carry this codec
    uint32_t attributeStride = 0;
    Defines defines;  // for every stage that decodes
};

struct Codec {
    const char* name;
    const char* what;
    const char* shader;  // below shaders_glsl/
    bool needsMeshlets;  // decodes only in mesh stages
    // `mesh` is prepared with `influences` influences (4 or 8); `meshlets` is null for routes without mesh shaders.
    Result<EncodedMesh> (*encode)(const Mesh& mesh, const MeshletMesh* meshlets, int influences);
};

const std::vector<Codec>& codecs();
const Codec* findCodec(const std::string& name);

// --- encoders --------------------------------------------------------------------------------------------------

// Uncompressed, 64 bytes with 4 influences (Kimmersdorfer 3.3) and 96 with 8; shaders_glsl/codecs/uc.glsl draws it.
// Irrelevant influences are stored as joint 0 with weight 0, so that reading the palette needs no test.
Result<EncodedMesh> encodeUncompressed(const Mesh& mesh, const MeshletMesh* meshlets, int influences);

}  // namespace skinbench
