#include "common/scene/gltf/gltf_notes.h"

#include <format>

#include "common/core/text.h"
#include "common/scene/scene.h"

namespace skinbench {
namespace {

struct Words {
    const char* one;
    const char* many;
};

// In the order of GltfNote.
constexpr std::array<Words, static_cast<size_t>(GltfNote::count)> kWords = {{
    {"weight is negative or not finite; set to 0", "weights are negative or not finite; set to 0"},
    {"vertex has weights that do not sum to 1; normalised", "vertices have weights that do not sum to 1; normalised"},
    {"vertex has no weight at all; bound to its first joint",
     "vertices have no weight at all; bound to their first joint"},
    {"vertex names a joint twice; its weights were added", "vertices name a joint twice; its weights were added"},
    {"", ""},
    {"normal has no direction; set to +z", "normals have no direction; set to +z"},
    {"normal is not of unit length; normalised", "normals are not of unit length; normalised"},
    {"uv is not finite; set to 0", "uvs are not finite; set to 0"},
    {"primitive of points or lines is ignored", "primitives of points or lines are ignored"},
    {"accessor has a format that glTF does not allow where it is used; read all the same",
     "accessors have a format that glTF does not allow where they are used; read all the same"},
    {"accessor is not aligned to its component size; read all the same",
     "accessors are not aligned to their component size; read all the same"},
    {"primitive has a skin but no JOINTS_0 and WEIGHTS_0; it follows its node instead",
     "primitives have a skin but no JOINTS_0 and WEIGHTS_0; they follow their nodes instead"},
    {"", ""},
    {"", ""},
    {"animation channel has the same target as another of its clip; the last one holds",
     "animation channels have the same target as another of their clip; the last one holds"},
    {"key time is not larger than the one before it; of equal ones the last holds",
     "key times are not larger than the one before; of equal ones the last holds"},
    {"key time is negative; a clip starts at 0", "key times are negative; a clip starts at 0"},
    {"", ""},
    {"node has a matrix that is no translation, rotation and scale; used as it is",
     "nodes have a matrix that is no translation, rotation and scale; used as it is"},
    {"node has both a matrix and its parts; the matrix holds",
     "nodes have both a matrix and its parts; the matrix holds"},
    {"node has a rotation that is not of unit length; normalised",
     "nodes have a rotation that is not of unit length; normalised"},
    {"inverse bind matrix has a last row other than 0 0 0 1; taken as that",
     "inverse bind matrices have a last row other than 0 0 0 1; taken as that"},
    {"skin names a node twice", "skins name a node twice"},
    {"skin has joints without a common root; they are placed as the nodes say",
     "skins have joints without a common root; they are placed as the nodes say"},
    {"node with a mesh is hidden by KHR_node_visibility; left out",
     "nodes with a mesh are hidden by KHR_node_visibility; left out"},
    {"extension is used but not listed in extensionsUsed", "extensions are used but not listed in extensionsUsed"},
    {"bufferView has a byteStride of 0; taken as tightly packed",
     "bufferViews have a byteStride of 0; taken as tightly packed"},
    {"accessor of positions or key times lacks min and max, or has other ones than its data; they are not used",
     "accessors of positions or key times lack min and max, or have other ones than their data; they are not used"},
    {"skin names a skeleton that is not above all its joints; it is not used",
     "skins name a skeleton that is not above all their joints; it is not used"},
    {"key has a rotation that is not of unit length; normalised",
     "keys have a rotation that is not of unit length; normalised"},
}};

// Where the number says nothing or more than a number has to be said.
std::string special(GltfNote note, const GltfNotes& notes, uint64_t count) {
    switch (note) {
        case GltfNote::overfull:
            return std::format(
                "more than {} influences in {}; the largest {} were kept, and a vertex lost up to {:.3g} of its weight",
                kMaxInfluences, counted(count, "vertex", "vertices"), kMaxInfluences, notes.overfullMax);
        case GltfNote::morphs:
            return "morph targets are ignored";
        case GltfNote::unknownTargets:
            return "animation channels with an unknown target are ignored";
        case GltfNote::splitMatrices:
            return "animated nodes with a matrix had it split into translation, rotation and scale";
        default:
            return {};
    }
}

}  // namespace

std::vector<std::string> describe(const GltfNotes& notes) {
    std::vector<std::string> texts;
    for (size_t i = 0; i < notes.counts.size(); ++i) {
        const uint64_t count = notes.counts[i];
        if (count == 0) continue;
        std::string text = special(static_cast<GltfNote>(i), notes, count);
        if (text.empty()) text = counted(count, kWords[i].one, kWords[i].many);
        texts.push_back(std::move(text));
    }
    return texts;
}

}  // namespace skinbench
