// What `inspect` tells of a scene without drawing it: how builders cut it, what quantising and coding its vertices
// costs in accuracy and saves in memory. Bytes are of one copy.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/codecs/attributes.h"
#include "common/codecs/codec.h"
#include "common/meshlets/common_influences.h"

namespace skinbench {

inline constexpr const char* kInspectSchema = "skinbench-inspect/1";

struct InspectSettings {
    MeshletLimits limits;
    int influences = 4;                                      // 4 or 8
    std::vector<CiKey> keys = {CiKey::ordered, CiKey::fit};  // of CiGrouping::triangles
    uint32_t minVertices = CommonInfluenceOptions{}.minVertices;
    bool all = false;  // unwelded, and in the file's order too; false: as it is drawn, welded and in cache order
};

// Distinct joints with a weight per meshlet.
struct JointSpread {
    double mean = 0;
    uint32_t largest = 0;
};

// One cut (Torabi tables 3.1, 4.2, 5.2, 5.3; Kimmersdorfer tables 3.2, 4.1).
struct MeshletRow {
    Geometry geometry = Geometry::welded;
    bool cacheOrder = true;
    const Builder* builder = nullptr;
    std::optional<CiGrouping> grouping;  // empty: the builder's plain cut, and what follows below is 0
    std::optional<CiKey> key;            // of CiGrouping::triangles
    uint32_t vertices = 0;               // of the mesh that is cut
    MeshletStats stats;                  // in that mesh's vertices
    JointSpread joints;
    uint32_t commonMeshlets = 0;
    uint32_t remainderTriangles = 0;
    uint32_t records = 0;  // vertices as they are stored
    uint32_t commonRecords = 0;
};

// Rounding::nearest. Units as in attributes.h.
struct AttributeErrors {
    std::map<int, ErrorFigure> position;  // bits to error, Kimmersdorfer table 2.1
    ErrorFigure uv;
    ErrorFigure euclidean, spherical, octahedral;  // table 2.2, after renormalisation
};

// Distances of what a codec's decoder gives back, in the units of attributes.h. Weights: the largest difference of one
// joint's weight, per vertex.
struct CodecErrors {
    ErrorFigure weight, position, normal, uv;
};

// One codec on one cut (Kimmersdorfer tables 4.2 and 4.3). Byte counts are empty where the buffer does not exist.
struct CodecRow {
    const Codec* codec = nullptr;
    Geometry geometry = Geometry::welded;
    const Builder* builder = nullptr;
    std::string reason;     // why it cannot encode the mesh; empty: it can
    uint32_t vertices = 0;  // after splitting
    uint64_t vertexBytes = 0;
    std::optional<uint64_t> indexBytes;               // without mesh shaders
    std::map<std::string, uint64_t> descriptorBytes;  // layout to bytes
    std::map<std::string, uint64_t> dataBytes;
    std::optional<uint64_t> meshletExtraBytes, tupleBytes;
    // Everything but the other attributes of the mesh's vertices, per vertex of the mesh: copies that splitting made
    // count in full.
    double blendBytesPerVertex = 0;
    CodecErrors errors;
    // Wall time of the encoder, which uses all cores and has the meshlets already: from the prepared mesh to buffers in
    // memory, without decoding and comparing. Without difference coding the builder takes no part: one time for all.
    double encodeMs = 0;
};

// All codecs that can encode the mesh, one after the other.
struct EncodeTotal {
    Geometry geometry = Geometry::welded;
    const Builder* builder = nullptr;
    uint32_t codecs = 0;
    double encodeMs = 0;
};

struct Inspection {
    std::string scene;
    SceneStats stats;  // welded
    InspectSettings settings;
    std::vector<std::string> warnings;
    std::vector<MeshletRow> meshlets;  // as settings.all says, every builder
    AttributeErrors attributes;        // welded
    std::vector<CodecRow> codecs;      // in cache order, every builder
};

JointSpread jointSpread(const Mesh& mesh, const MeshletMesh& meshlets);

// Takes a scene as loaded. Every cut is checked; an error is a fault of a builder.
Result<Inspection> inspectScene(const Scene& stored, const InspectSettings& settings);

// One for each geometry and builder.
std::vector<EncodeTotal> encodeTotals(const std::vector<CodecRow>& rows);

nlohmann::ordered_json inspectJson(const Inspection& inspection);

}  // namespace skinbench
