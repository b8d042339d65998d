#include "common/scene/gltf/gltf_nodes.h"

#include <algorithm>
#include <cmath>
#include <format>

namespace skinbench {

Result<NodeOrder> orderNodes(const tinygltf::Model& model) {
    const size_t count = model.nodes.size();
    NodeOrder order{std::vector<int>(count, -1), std::vector<uint32_t>(count), {}};
    bool inOrder = true;
    for (size_t i = 0; i < count; ++i)
        for (const int child : model.nodes[i].children) {
            if (!contains(model.nodes, child))
                return inputError(std::format("node {}: child {} does not exist", i, child));
            if (order.parents[child] >= 0)
                return inputError(std::format("node {} has two parents, {} and {}", child, order.parents[child], i));
            order.parents[child] = static_cast<int>(i);
            inOrder &= static_cast<size_t>(child) > i;
        }
    std::vector<int> open;
    for (size_t root = count; root-- > 0;)
        if (order.parents[root] < 0) open.push_back(static_cast<int>(root));
    while (!open.empty()) {
        const int node = open.back();
        open.pop_back();
        order.sorted.push_back(node);
        const auto& children = model.nodes[node].children;
        open.insert(open.end(), children.rbegin(), children.rend());
    }
    if (order.sorted.size() < count) return inputError("its nodes form a cycle");
    if (inOrder) std::ranges::sort(order.sorted);
    for (size_t i = 0; i < count; ++i) order.place[order.sorted[i]] = static_cast<uint32_t>(i);
    return order;
}

static glm::vec3 toVec3(const std::vector<double>& v, float missing) {
    return v.size() == 3 ? glm::vec3(v[0], v[1], v[2]) : glm::vec3(missing);
}

Node makeNode(const tinygltf::Node& source, int parent) {
    Node node{source.name, parent, toVec3(source.translation, 0), {1, 0, 0, 0}, toVec3(source.scale, 1), {}};
    if (const auto& q = source.rotation; q.size() == 4)
        node.rotation = glm::quat(static_cast<float>(q[3]), static_cast<float>(q[0]), static_cast<float>(q[1]),
                                  static_cast<float>(q[2]));
    if (source.matrix.size() == 16) {
        glm::mat4 m;
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = static_cast<float>(source.matrix[i]);
        if (m != glm::mat4(1)) node.matrix = m;
    }
    return node;
}

Result<std::vector<bool>> shownNodes(const tinygltf::Model& model, const NodeOrder& order) {
    const size_t count = model.nodes.size();
    if (model.scenes.empty()) return std::vector<bool>(count, true);
    const int index = model.defaultScene < 0 ? 0 : model.defaultScene;
    if (!contains(model.scenes, index)) return inputError(std::format("the default scene {} does not exist", index));
    std::vector<bool> shown(count, false);
    for (const int root : model.scenes[index].nodes) {
        if (!contains(model.nodes, root))
            return inputError(std::format("scene {}: node {} does not exist", index, root));
        shown[root] = true;
    }
    for (const int node : order.sorted)
        if (order.parents[node] >= 0 && shown[order.parents[node]]) shown[node] = true;
    return shown;
}

void splitMatrix(Node& node) {
    const glm::mat4 m = *node.matrix;
    node.matrix.reset();
    node.translation = glm::vec3(m[3]);
    glm::mat3 axes(m);
    for (int i = 0; i < 3; ++i) node.scale[i] = glm::length(axes[i]);
    if (glm::determinant(axes) < 0) node.scale.x = -node.scale.x;
    for (int i = 0; i < 3; ++i)
        if (node.scale[i] != 0) axes[i] /= node.scale[i];
    const glm::quat rotation = glm::quat_cast(axes);
    const bool good = std::isfinite(glm::dot(rotation, rotation)) && glm::dot(rotation, rotation) > 0;
    node.rotation = good ? glm::normalize(rotation) : glm::quat(1, 0, 0, 0);
}

std::vector<bool> hiddenNodes(const NodeOrder& order, const std::set<size_t>& hidden) {
    std::vector<bool> out(order.parents.size());
    for (const int node : order.sorted)
        out[node] = hidden.contains(node) || (order.parents[node] >= 0 && out[order.parents[node]]);
    return out;
}

std::vector<bool> mirroredNodes(const Skeleton& skeleton) {
    std::vector<bool> mirrored(skeleton.nodes.size());
    for (size_t i = 0; i < mirrored.size(); ++i) {
        const Node& node = skeleton.nodes[i];
        // Products of small scales would underflow.
        const bool negative = node.matrix ? glm::determinant(glm::dmat3(glm::mat3(*node.matrix))) < 0
                                          : (node.scale.x < 0) != ((node.scale.y < 0) != (node.scale.z < 0));
        mirrored[i] = negative != (node.parent >= 0 && mirrored[node.parent]);
    }
    return mirrored;
}

Subtrees subtreesOf(const Skeleton& skeleton) {
    const size_t count = skeleton.nodes.size();
    Subtrees out{std::vector<uint32_t>(count), std::vector<uint32_t>(count), std::vector<uint32_t>(count, 1)};
    for (size_t i = count; i-- > 0;)
        if (const int32_t parent = skeleton.nodes[i].parent; parent >= 0) out.count[parent] += out.count[i];
    std::vector<uint32_t> next(count);  // of each node's children
    uint32_t nextRoot = 0;
    for (size_t i = 0; i < count; ++i) {
        const int32_t parent = skeleton.nodes[i].parent;
        uint32_t& place = parent < 0 ? nextRoot : next[parent];
        out.roots[i] = parent < 0 ? static_cast<uint32_t>(i) : out.roots[parent];
        out.first[i] = place;
        next[i] = place + 1;
        place += out.count[i];
    }
    return out;
}

}  // namespace skinbench
