#include "common/meshlets/records.h"

#include <algorithm>
#include <bit>
#include <format>
#include <map>
#include <span>

namespace skinbench {

Records commonRecords(const CommonInfluenceCut& cut) {
    return {cut.mesh, cut.sources, cut.meshlets, cut.commonRecords, cut.commonMeshlets, cut.joints, {}};
}

static void appendVertex(Mesh& out, const Mesh& mesh, uint32_t vertex) {
    out.positions.push_back(mesh.positions[vertex]);
    out.normals.push_back(mesh.normals[vertex]);
    out.uvs.push_back(mesh.uvs[vertex]);
    out.influences.push_back(mesh.influences[vertex]);
}

static Records ordered(const Mesh& mesh, const MeshletMesh& cut) {
    Records records;
    records.meshlets = cut;
    const size_t count = cut.vertices.size();
    Mesh& out = records.mesh;
    for (size_t i = 0; i < count; ++i) {
        appendVertex(out, mesh, cut.vertices[i]);
        records.meshlets.vertices[i] = static_cast<uint32_t>(i);
    }
    out.indices = triangleList(records.meshlets);
    records.sources = cut.vertices;
    return records;
}

Records orderedRecords(const Mesh& mesh, const MeshletMesh& meshlets) { return ordered(mesh, meshlets); }

Records orderedRecords(const Records& records) {
    Records out = ordered(records.mesh, records.meshlets);
    for (uint32_t& source : out.sources) source = records.sources[source];
    out.commonMeshlets = records.commonMeshlets;
    out.joints = records.joints;
    for (uint32_t m = 0; m < records.commonMeshlets; ++m) out.commonRecords += records.meshlets.meshlets[m].vertexCount;
    return out;
}

Records partitionedRecords(const Mesh& mesh, const PartitionPlan& plan) {
    Records records;
    records.partition = plan;
    std::map<std::pair<uint32_t, JointList>, uint32_t> known;  // vertex and its slots -> record
    std::vector<uint16_t> slotOf(kMaxJoints, 0);
    for (size_t c = 0; c < plan.commands.size(); ++c) {
        const PartitionCommand& command = plan.commands[c];
        const std::vector<uint16_t> joints = slotsAfter(plan, c);
        for (size_t slot = 0; slot < joints.size(); ++slot)
            if (joints[slot] != kNoJoint) slotOf[joints[slot]] = static_cast<uint16_t>(slot);
        for (uint32_t t = 0; t < command.triangleCount * 3; ++t) {
            const uint32_t triangle = plan.triangles[command.firstTriangle + t / 3];
            const uint32_t vertex = mesh.indices[triangle * 3 + t % 3];
            JointList slots;
            for (int i = 0; i < kMaxInfluences; ++i) {
                const uint16_t joint = mesh.influences[vertex].joints[i];
                slots[i] = joint == kNoJoint ? kNoJoint : slotOf[joint];
            }
            const auto next = static_cast<uint32_t>(records.sources.size());
            auto [entry, fresh] = known.try_emplace({vertex, slots}, next);
            if (fresh) {
                appendVertex(records.mesh, mesh, vertex);
                records.mesh.influences.back().joints = slots;
                records.sources.push_back(vertex);
            }
            records.mesh.indices.push_back(entry->second);
        }
    }
    return records;
}

Result<MeshletJoints> packMeshletJoints(const Mesh& mesh, const MeshletMesh& cut, int influences) {
    MeshletJoints packed;
    std::vector<uint16_t> list;
    for (const Meshlet& meshlet : cut.meshlets) {
        auto ids = std::span(cut.vertices).subspan(meshlet.firstVertex, meshlet.vertexCount);
        list.clear();
        for (uint32_t id : ids)
            for (int i = 0; i < influences; ++i)
                if (mesh.influences[id].joints[i] != kNoJoint) list.push_back(mesh.influences[id].joints[i]);
        std::ranges::sort(list);
        list.erase(std::ranges::unique(list).begin(), list.end());
        if (list.size() > kMaxMeshletJoints)
            return deviceError(std::format("a meshlet has {} joints, and one-byte joint numbers reach {}", list.size(),
                                           kMaxMeshletJoints));
        packed.most = std::max(packed.most, static_cast<uint32_t>(list.size()));
        packed.start.push_back(static_cast<uint32_t>(packed.words.size()));
        packed.words.push_back(static_cast<uint32_t>(list.size()));
        packed.words.insert(packed.words.end(), list.begin(), list.end());
        for (uint32_t id : ids)
            for (int four = 0; four < influences; four += 4) {
                uint32_t word = 0;
                for (int i = 0; i < 4; ++i) {
                    const uint16_t joint = mesh.influences[id].joints[four + i];
                    if (joint == kNoJoint) continue;  // weight 0: any joint of the list will do
                    const auto place = static_cast<uint32_t>(std::ranges::lower_bound(list, joint) - list.begin());
                    word |= place << i * 8;
                }
                packed.words.push_back(word);
            }
    }
    return packed;
}

std::vector<uint32_t> packJointLists(const std::vector<JointList>& lists, int influences) {
    std::vector<uint32_t> words;
    words.reserve(lists.size() * static_cast<size_t>(influences));
    for (const JointList& list : lists)
        for (int i = 0; i < influences; ++i) words.push_back(list[i] == kNoJoint ? 0 : list[i]);
    if (words.empty()) words.push_back(0);  // a shader declares the block even where no meshlet has a list
    return words;
}

}  // namespace skinbench
