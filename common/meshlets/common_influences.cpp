#include "common/meshlets/common_influences.h"

#include <algorithm>
#include <bit>
#include <format>
#include <map>
#include <queue>
#include <string>
#include <tuple>
#include <unordered_map>

#include "common/scene/tuples.h"

namespace skinbench {

const char* ciGroupingName(CiGrouping grouping) { return grouping == CiGrouping::meshlets ? "meshlets" : "triangles"; }

const char* ciKeyName(CiKey key) {
    switch (key) {
        case CiKey::ordered:
            return "ordered";
        case CiKey::set:
            return "set";
        case CiKey::fit:
            return "fit";
    }
    return "?";
}
namespace {

constexpr uint32_t kRemainder = UINT32_MAX;

size_t jointCount(const JointList& list) {
    return static_cast<size_t>(std::ranges::find(list, kNoJoint) - list.begin());
}

// Ascending; false where there are more than `most` joints.
bool unite(JointList& into, const JointList& other, size_t most) {
    std::array<uint16_t, 2 * kMaxInfluences> both;
    const auto end = std::set_union(into.begin(), into.begin() + jointCount(into), other.begin(),
                                    other.begin() + jointCount(other), both.begin());
    const auto count = static_cast<size_t>(end - both.begin());
    if (count > most) return false;
    std::fill(std::copy(both.begin(), end, into.begin()), into.end(), kNoJoint);
    return true;
}

// Distinct lists, numbered in the order of their first appearance.
class ListNumbers {
public:
    uint32_t number(const JointList& list) {
        const auto [it, fresh] = numbers_.try_emplace(list, static_cast<uint32_t>(lists.size()));
        if (fresh) lists.push_back(list);
        return it->second;
    }
    std::vector<JointList> lists;

private:
    struct Hash {
        size_t operator()(const JointList& list) const {
            const auto words = std::bit_cast<std::array<uint64_t, 2>>(list);
            const uint64_t mixed = (words[0] ^ std::rotl(words[1], 29)) * 0x9E3779B97F4A7C15u;
            return mixed ^ mixed >> 32;
        }
    };
    std::unordered_map<JointList, uint32_t, Hash> numbers_;
};

// Meshlets of the given mesh's vertices, each with a list or in the remainder.
struct Marked {
    MeshletMesh meshlets;
    std::vector<uint32_t> list;  // per meshlet
    std::vector<JointList> lists;
};

struct Use {
    uint32_t vertex, list;
    auto operator<=>(const Use&) const = default;
};

// How many vertices each two lists share.
std::vector<std::map<uint32_t, uint32_t>> sharedVertices(std::vector<Use>& uses, size_t lists) {
    // A vertex of more lists counts for neighbours in the order of lists only, so that a fan's centre costs no square.
    constexpr size_t kMostPairs = 8;
    std::ranges::sort(uses);
    uses.erase(std::ranges::unique(uses).begin(), uses.end());
    std::vector<std::map<uint32_t, uint32_t>> shared(lists);
    for (size_t first = 0, end; first < uses.size(); first = end) {
        end = first + 1;
        while (end < uses.size() && uses[end].vertex == uses[first].vertex) ++end;
        for (size_t a = first; a < end; ++a)
            for (size_t b = a + 1; b < std::min(end, end - first > kMostPairs ? a + 2 : end); ++b) {
                ++shared[uses[a].list][uses[b].list];
                ++shared[uses[b].list][uses[a].list];
            }
    }
    return shared;
}

// Makes one list of two that share vertices while their union has at most `most` joints, those that share most first:
// each shared vertex is one record less. Returns each list's new number; `lists` holds the unions.
std::vector<uint32_t> fuseLists(std::vector<JointList>& lists, std::vector<Use> uses, size_t most) {
    auto shared = sharedVertices(uses, lists.size());
    std::vector<uint32_t> parent(lists.size());
    for (uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
    using Pair = std::tuple<uint32_t, uint32_t, uint32_t>;  // shared vertices, lists
    std::priority_queue<Pair> queue;
    for (uint32_t a = 0; a < lists.size(); ++a)
        for (const auto& [b, count] : shared[a])
            if (a < b) queue.emplace(count, a, b);
    while (!queue.empty()) {
        auto [count, a, b] = queue.top();
        queue.pop();
        const auto current = shared[a].find(b);
        if (parent[a] != a || parent[b] != b || current == shared[a].end() || current->second != count) continue;
        if (shared[a].size() < shared[b].size()) std::swap(a, b);
        if (!unite(lists[a], lists[b], most)) continue;
        parent[b] = a;
        // A vertex of three lists is counted twice from here on: the order of later steps is a heuristic.
        for (const auto& [c, more] : shared[b]) {
            shared[c].erase(b);
            if (c == a) continue;
            const uint32_t sum = shared[a][c] += more;
            shared[c][a] = sum;
            queue.emplace(sum, std::min(a, c), std::max(a, c));
        }
        shared[b].clear();
    }
    for (uint32_t i = 0; i < parent.size(); ++i) {
        uint32_t root = i;
        while (parent[root] != root) root = parent[root];
        parent[i] = root;
    }
    return parent;
}

std::vector<JointList> ascendingLists(const Mesh& mesh, int influences) {
    std::vector<JointList> lists(mesh.influences.size());
    for (size_t v = 0; v < lists.size(); ++v) {
        lists[v] = mesh.influences[v].joints;
        std::fill(lists[v].begin() + influences, lists[v].end(), kNoJoint);
        std::ranges::sort(lists[v]);
    }
    return lists;
}

Marked markMeshlets(const Mesh& mesh, const CommonInfluenceOptions& options) {
    const std::vector<JointList> joints = ascendingLists(mesh, options.influences);
    const auto most = static_cast<size_t>(options.influences);
    Marked marked{options.cut ? *options.cut : options.builder->build(mesh, options.limits), {}, {}};
    ListNumbers numbers;
    std::vector<Use> uses;
    for (const Meshlet& meshlet : marked.meshlets.meshlets) {
        const uint32_t* vertices = &marked.meshlets.vertices[meshlet.firstVertex];
        JointList list;
        list.fill(kNoJoint);
        bool fits = meshlet.vertexCount >= options.minVertices;
        for (uint32_t i = 0; fits && i < meshlet.vertexCount; ++i) fits = unite(list, joints[vertices[i]], most);
        marked.list.push_back(fits ? numbers.number(list) : kRemainder);
        for (uint32_t i = 0; fits && i < meshlet.vertexCount; ++i) uses.push_back({vertices[i], marked.list.back()});
    }
    marked.lists = std::move(numbers.lists);
    const std::vector<uint32_t> fused = fuseLists(marked.lists, std::move(uses), most);
    for (uint32_t& list : marked.list)
        if (list != kRemainder) list = fused[list];
    return marked;
}

struct Groups {
    std::vector<JointList> lists;
    std::vector<uint32_t> list;  // per triangle
};

Groups groupByKey(const Mesh& mesh, const CommonInfluenceOptions& options) {
    TupleTable tuples = distinctTuples(mesh, options.influences);
    if (options.key == CiKey::set)
        for (JointList& list : tuples.tuples) std::ranges::sort(list);
    ListNumbers numbers;
    Groups groups;
    groups.list.reserve(mesh.indices.size() / 3);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        auto of = [&](size_t corner) { return tuples.tuples[tuples.vertexTuple[mesh.indices[i + corner]]]; };
        groups.list.push_back(of(0) == of(1) && of(0) == of(2) ? numbers.number(of(0)) : kRemainder);
    }
    groups.lists = std::move(numbers.lists);
    return groups;
}

Groups groupByFit(const Mesh& mesh, const CommonInfluenceOptions& options) {
    const std::vector<JointList> joints = ascendingLists(mesh, options.influences);
    const auto most = static_cast<size_t>(options.influences);
    ListNumbers numbers;
    Groups groups;
    std::vector<Use> uses;
    groups.list.reserve(mesh.indices.size() / 3);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        JointList list = joints[mesh.indices[i]];
        const bool fits =
            unite(list, joints[mesh.indices[i + 1]], most) && unite(list, joints[mesh.indices[i + 2]], most);
        groups.list.push_back(fits ? numbers.number(list) : kRemainder);
        for (size_t corner = 0; fits && corner < 3; ++corner)
            uses.push_back({mesh.indices[i + corner], groups.list.back()});
    }
    groups.lists = std::move(numbers.lists);
    const std::vector<uint32_t> fused = fuseLists(groups.lists, std::move(uses), most);
    for (uint32_t& list : groups.list)
        if (list != kRemainder) list = fused[list];
    return groups;
}

// Cuts parts of a mesh as meshes of their own, so that many small parts cost no more than their triangles.
class PartCutter {
public:
    PartCutter(const Mesh& mesh, const CommonInfluenceOptions& options)
        : mesh_(mesh), options_(options), local_(mesh.positions.size(), UINT32_MAX) {
        marked.meshlets.limits = options.limits;
    }

    // Vertices that the triangles use, in the order of their first use.
    std::vector<uint32_t> collect(const std::vector<uint32_t>& triangles) {
        std::vector<uint32_t> vertices;
        for (uint32_t triangle : triangles)
            for (uint32_t corner = 0; corner < 3; ++corner) {
                const uint32_t vertex = mesh_.indices[triangle * size_t{3} + corner];
                if (local_[vertex] != UINT32_MAX) continue;
                local_[vertex] = static_cast<uint32_t>(vertices.size());
                vertices.push_back(vertex);
            }
        return vertices;
    }

    void release(const std::vector<uint32_t>& vertices) {
        for (uint32_t vertex : vertices) local_[vertex] = UINT32_MAX;
    }

    // `vertices` are those of collect, not yet released.
    void cut(const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& vertices, uint32_t list) {
        Mesh part;
        part.positions.reserve(vertices.size());
        part.normals.reserve(vertices.size());
        part.uvs.reserve(vertices.size());
        part.influences.reserve(vertices.size());
        part.indices.reserve(triangles.size() * 3);
        for (uint32_t vertex : vertices) {
            part.positions.push_back(mesh_.positions[vertex]);
            part.normals.push_back(mesh_.normals[vertex]);
            part.uvs.push_back(mesh_.uvs[vertex]);
            part.influences.push_back(mesh_.influences[vertex]);
        }
        for (uint32_t triangle : triangles)
            for (uint32_t corner = 0; corner < 3; ++corner)
                part.indices.push_back(local_[mesh_.indices[triangle * size_t{3} + corner]]);
        const MeshletMesh pieces = options_.builder->build(part, options_.limits);
        MeshletMesh& all = marked.meshlets;
        for (Meshlet meshlet : pieces.meshlets) {
            meshlet.firstVertex += static_cast<uint32_t>(all.vertices.size());
            meshlet.firstTriangle += static_cast<uint32_t>(all.triangles.size());
            all.meshlets.push_back(meshlet);
            marked.list.push_back(list);
        }
        for (uint32_t vertex : pieces.vertices) all.vertices.push_back(vertices[vertex]);
        all.triangles.insert(all.triangles.end(), pieces.triangles.begin(), pieces.triangles.end());
    }

    Marked marked;

private:
    const Mesh& mesh_;
    const CommonInfluenceOptions& options_;
    std::vector<uint32_t> local_;
};

Marked cutGroups(const Mesh& mesh, Groups groups, const CommonInfluenceOptions& options) {
    std::vector<std::vector<uint32_t>> members(groups.lists.size());
    for (uint32_t t = 0; t < groups.list.size(); ++t)
        if (groups.list[t] != kRemainder) members[groups.list[t]].push_back(t);
    PartCutter cutter(mesh, options);
    for (uint32_t list = 0; list < members.size(); ++list) {
        if (members[list].empty()) continue;
        const std::vector<uint32_t> vertices = cutter.collect(members[list]);
        if (vertices.size() >= options.minVertices)
            cutter.cut(members[list], vertices, list);
        else
            for (uint32_t triangle : members[list]) groups.list[triangle] = kRemainder;
        cutter.release(vertices);
    }
    std::vector<uint32_t> rest;
    for (uint32_t t = 0; t < groups.list.size(); ++t)
        if (groups.list[t] == kRemainder) rest.push_back(t);
    if (!rest.empty()) cutter.cut(rest, cutter.collect(rest), kRemainder);
    cutter.marked.lists = std::move(groups.lists);
    return std::move(cutter.marked);
}

Influences inListOrder(const Influences& source, const JointList& list) {
    Influences slim{list, {}};
    for (size_t i = 0; i < source.joints.size() && source.joints[i] != kNoJoint; ++i) {
        const auto place = std::ranges::find(list, source.joints[i]);
        SKINBENCH_ASSERT(place != list.end());
        slim.weights[static_cast<size_t>(place - list.begin())] = source.weights[i];
    }
    return slim;
}

// Numbers the records in the order of their first use, the common part first.
CommonInfluenceCut makeRecords(const Mesh& mesh, const Marked& marked) {
    CommonInfluenceCut cut;
    cut.meshlets.limits = marked.meshlets.limits;
    // The records of a vertex form a chain from the latest to the first.
    struct Link {
        uint32_t list, earlier;
    };
    constexpr uint32_t kNone = UINT32_MAX;
    std::vector<uint32_t> latest(mesh.positions.size(), kNone);
    std::vector<Link> links;
    const size_t least = mesh.positions.size();  // records, but for vertices without a triangle
    links.reserve(least);
    cut.sources.reserve(least);
    cut.mesh.positions.reserve(least);
    cut.mesh.normals.reserve(least);
    cut.mesh.uvs.reserve(least);
    cut.mesh.influences.reserve(least);
    cut.mesh.indices.reserve(mesh.indices.size());
    cut.meshlets.vertices.reserve(marked.meshlets.vertices.size());
    cut.meshlets.triangles.reserve(marked.meshlets.triangles.size());
    auto record = [&](uint32_t vertex, uint32_t list) {
        for (uint32_t r = latest[vertex]; r != kNone; r = links[r].earlier)
            if (links[r].list == list) return r;
        links.push_back({list, latest[vertex]});
        latest[vertex] = static_cast<uint32_t>(cut.sources.size());
        cut.sources.push_back(vertex);
        cut.mesh.positions.push_back(mesh.positions[vertex]);
        cut.mesh.normals.push_back(mesh.normals[vertex]);
        cut.mesh.uvs.push_back(mesh.uvs[vertex]);
        cut.mesh.influences.push_back(list == kRemainder ? mesh.influences[vertex]
                                                         : inListOrder(mesh.influences[vertex], marked.lists[list]));
        return latest[vertex];
    };
    for (const bool common : {true, false}) {
        for (size_t m = 0; m < marked.list.size(); ++m) {
            const Meshlet& from = marked.meshlets.meshlets[m];
            const uint32_t list = marked.list[m];
            if ((list != kRemainder) != common) continue;
            const Meshlet to{static_cast<uint32_t>(cut.meshlets.vertices.size()),
                             static_cast<uint32_t>(cut.meshlets.triangles.size()), from.vertexCount,
                             from.triangleCount};
            cut.meshlets.meshlets.push_back(to);
            for (uint32_t i = 0; i < from.vertexCount; ++i)
                cut.meshlets.vertices.push_back(record(marked.meshlets.vertices[from.firstVertex + i], list));
            for (uint32_t t = 0; t < from.triangleCount; ++t) {
                const auto& local = marked.meshlets.triangles[from.firstTriangle + t];
                cut.meshlets.triangles.push_back(local);
                for (uint8_t corner : local) cut.mesh.indices.push_back(cut.meshlets.vertices[to.firstVertex + corner]);
            }
            if (!common) continue;
            cut.joints.push_back(marked.lists[list]);
            cut.commonTriangles += from.triangleCount;
        }
        if (!common) continue;
        cut.commonMeshlets = static_cast<uint32_t>(cut.meshlets.meshlets.size());
        cut.commonRecords = static_cast<uint32_t>(cut.sources.size());
    }
    return cut;
}

std::string place(const char* what, size_t number) { return std::format("common influences: {} {}: ", what, number); }

// (joint, weight) of every influence with a weight, in the order of joints.
auto weighted(const Influences& influences) {
    std::array<std::pair<uint16_t, float>, kMaxInfluences> list{};
    size_t count = 0;
    for (size_t i = 0; i < influences.joints.size(); ++i) {
        if (influences.weights[i] == 0) continue;
        list[count] = {influences.joints[i], influences.weights[i]};
        for (size_t k = count++; k > 0 && list[k] < list[k - 1]; --k) std::swap(list[k], list[k - 1]);
    }
    return list;
}

Result<void> checkRecords(const Mesh& mesh, const CommonInfluenceCut& cut) {
    for (size_t r = 0; r < cut.sources.size(); ++r) {
        const uint32_t source = cut.sources[r];
        if (source >= mesh.positions.size()) return inputError(place("record", r) + "its vertex does not exist");
        if (cut.mesh.positions[r] != mesh.positions[source] || cut.mesh.normals[r] != mesh.normals[source] ||
            cut.mesh.uvs[r] != mesh.uvs[source])
            return inputError(place("record", r) + "position, normal or texture coordinate is not its vertex'");
        const bool same = r < cut.commonRecords ? weighted(cut.mesh.influences[r]) == weighted(mesh.influences[source])
                                                : cut.mesh.influences[r] == mesh.influences[source];
        if (!same) return inputError(place("record", r) + "its influences are not its vertex'");
    }
    return {};
}

// Takes a cut whose meshlets passed checkMeshlets.
Result<void> checkLists(const CommonInfluenceCut& cut) {
    uint32_t triangles = 0;
    for (size_t m = 0; m < cut.meshlets.meshlets.size(); ++m) {
        const Meshlet& meshlet = cut.meshlets.meshlets[m];
        const bool common = m < cut.commonMeshlets;
        if (common) triangles += meshlet.triangleCount;
        for (uint32_t i = 0; i < meshlet.vertexCount; ++i) {
            const uint32_t record = cut.meshlets.vertices[meshlet.firstVertex + i];
            if ((record < cut.commonRecords) != common)
                return inputError(place("meshlet", m) + "refers to a record of the other part");
            if (common && cut.mesh.influences[record].joints != cut.joints[m])
                return inputError(place("meshlet", m) + "a record has another joint list");
        }
    }
    if (triangles != cut.commonTriangles)
        return inputError(std::format("common influences: {} triangles are counted as common instead of {}",
                                      cut.commonTriangles, triangles));
    if (triangleList(cut.meshlets) != cut.mesh.indices)
        return inputError("common influences: the indices are not the meshlets' triangles in order");
    return {};
}

}  // namespace

CommonInfluenceCut buildCommonInfluences(const Mesh& mesh, const CommonInfluenceOptions& options) {
    SKINBENCH_ASSERT(options.builder && options.influences >= 1 && options.influences <= kMaxInfluences);
    if (options.grouping == CiGrouping::meshlets) return makeRecords(mesh, markMeshlets(mesh, options));
    Groups groups = options.key == CiKey::fit ? groupByFit(mesh, options) : groupByKey(mesh, options);
    return makeRecords(mesh, cutGroups(mesh, std::move(groups), options));
}

MeshletMesh sourceMeshlets(const CommonInfluenceCut& cut) {
    MeshletMesh meshlets = cut.meshlets;
    for (uint32_t& vertex : meshlets.vertices) vertex = cut.sources[vertex];
    return meshlets;
}

Result<void> checkCommonInfluences(const Mesh& mesh, const CommonInfluenceCut& cut) {
    const size_t records = cut.sources.size();
    if (cut.mesh.positions.size() != records || cut.mesh.normals.size() != records || cut.mesh.uvs.size() != records ||
        cut.mesh.influences.size() != records || cut.commonRecords > records ||
        cut.commonMeshlets > cut.meshlets.meshlets.size() || cut.joints.size() != cut.commonMeshlets)
        return inputError("common influences: the arrays differ in length");
    if (auto checked = checkRecords(mesh, cut); !checked) return checked;
    if (std::ranges::any_of(cut.meshlets.vertices, [&](uint32_t record) { return record >= records; }))
        return inputError("common influences: a meshlet names a record that does not exist");
    if (auto checked = checkMeshlets(mesh, sourceMeshlets(cut)); !checked) return checked;
    return checkLists(cut);
}

}  // namespace skinbench
