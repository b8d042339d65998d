// The node hierarchy of a glTF asset.
#pragma once

#include <set>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "common/core/result.h"
#include "common/scene/scene.h"

namespace skinbench {

template <class T>
bool contains(const std::vector<T>& list, int index) {
    return index >= 0 && static_cast<size_t>(index) < list.size();
}

template <class T>
Result<T> at(const std::string& place, Result<T> result) {
    if (!result) result.error().text = place + ": " + result.error().text;
    return result;
}

struct NodeOrder {
    std::vector<int> parents;     // by the file's index
    std::vector<uint32_t> place;  // the file's index -> ours
    std::vector<int> sorted;      // ours -> the file's index
};

// Parents before their children; a file whose order is fine keeps it. Refuses cycles and second parents.
Result<NodeOrder> orderNodes(const tinygltf::Model& model);

Node makeNode(const tinygltf::Node& source, int parent);

// glTF forbids animating a node that has a matrix; where a file does it anyway, the matrix becomes its three parts.
void splitMatrix(Node& node);

// The nodes that the default scene shows, by the file's index.
Result<std::vector<bool>> shownNodes(const tinygltf::Model& model, const NodeOrder& order);

// Those of `hidden` and all below them (KHR_node_visibility), by the file's index.
std::vector<bool> hiddenNodes(const NodeOrder& order, const std::set<size_t>& hidden);

// The sign of the determinant of each node's global transform in the rest pose, by our index.
std::vector<bool> mirroredNodes(const Skeleton& skeleton);

// What hangs below each node, by our index.
struct Subtrees {
    std::vector<uint32_t> roots;         // above each node, or the node itself
    std::vector<uint32_t> first, count;  // numbers of a walk: those below a node, itself included, follow each other

    bool holds(uint32_t top, uint32_t node) const {
        return first[node] >= first[top] && first[node] - first[top] < count[top];
    }
};
Subtrees subtreesOf(const Skeleton& skeleton);

}  // namespace skinbench
