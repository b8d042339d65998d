// One primitive of a glTF mesh as vertices and a triangle list. Joint numbers are still those of the skin.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/scene/gltf/gltf_data.h"
#include "common/scene/scene.h"

namespace skinbench {

struct GltfPrimitive {
    std::map<std::string, int> attributes;  // name -> accessor
    int indices = -1;
    int mode = 4;
};

struct GltfMeshPart {
    Mesh mesh;  // influences are empty where not `skinned`
    bool skinned = false;
    bool ownsVertices = true;  // else they are those of the mesh's part `sharedWith`, and `mesh` holds indices only
    size_t sharedWith = 0;
    std::map<std::string, int> attributes;
};

// What was repaired or left out, counted over all primitives.
struct GltfRepairs {
    uint64_t badWeights = 0;  // not a number, infinite or negative
    uint64_t wrongSums = 0;   // vertices
    uint64_t weightless = 0;  // vertices
    uint64_t overfull = 0;    // vertices with more than kMaxInfluences
    double overfullMax = 0;   // the largest share of weight that one of them lost
    uint64_t badNormals = 0;
    uint64_t badUvs = 0;
    uint64_t skippedPrimitives = 0;  // points and lines
};
std::vector<std::string> describe(const GltfRepairs& repairs);

// `shared`: a part of the same mesh whose vertices can be used again, because its attributes are the same.
Result<GltfMeshPart> readPrimitive(const GltfData& data, const GltfPrimitive& primitive, const GltfMeshPart* shared,
                                   GltfRepairs& repairs);

}  // namespace skinbench
