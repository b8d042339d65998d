// A glTF mesh as vertices and triangle lists. Only vertices that a triangle uses are made. Joint numbers are still
// those of the skin.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/scene/gltf/gltf_data.h"
#include "common/scene/gltf/gltf_notes.h"
#include "common/scene/scene.h"

namespace skinbench {

struct GltfPrimitive {
    std::map<std::string, int> attributes;  // name -> accessor
    int indices = -1;
    int mode = 4;
};

// Vertices that primitives of one mesh share, because their attributes are the same.
struct GltfVertices {
    Mesh mesh;  // influences are empty where not `skinned`; no indices
    bool skinned = false;
    std::vector<uint32_t> fileVertex;  // their numbers in the file, ascending
};

struct GltfMesh {
    std::vector<GltfVertices> vertices;
    struct Part {
        size_t vertices = 0;            // which of the above
        std::vector<uint32_t> indices;  // empty: points or lines, which are not drawn
    };
    std::vector<Part> parts;  // one per primitive
};

// Errors name the primitive where there are several.
Result<GltfMesh> readMesh(GltfData& data, const std::vector<GltfPrimitive>& primitives, GltfNotes& notes);

}  // namespace skinbench
