#include "common/scene/builtin/surface.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/scene/builtin/exact.h"
#include "common/scene/builtin/grid.h"

namespace skinbench::builtin {

namespace {

using Quad = std::array<uint32_t, 4>;

struct DualMesh {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> blocks;  // by vertex: whose segments to ask
    std::vector<Quad> quads;
};

// The mean of the middles of the cell's crossed edges, in cells.
glm::vec3 crossingMean(uint8_t signs) {
    glm::vec3 sum(0);
    float count = 0;
    for (int i = 0; i < 8; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const int j = i | 1 << axis;
            if (j == i || ((signs >> i ^ signs >> j) & 1) == 0) continue;
            sum += 0.5f * (glm::vec3(i & 1, i >> 1 & 1, i >> 2) + glm::vec3(j & 1, j >> 1 & 1, j >> 2));
            ++count;
        }
    return sum / count;
}

uint32_t vertexOf(const Block& block, glm::ivec3 cell) {
    const int bit = cell.x + kBlockCells * (cell.y + kBlockCells * cell.z);
    return block.firstVertex + uint32_t(std::popcount(block.crossed & ((uint64_t(1) << bit) - 1)));
}

// `cell` may lie one step outside the block.
uint32_t neighbourVertex(const Grid& grid, const Block& block, glm::ivec3 cell) {
    if (std::min({cell.x, cell.y, cell.z}) >= 0) return vertexOf(block, cell);
    const glm::ivec3 step(cell.x < 0, cell.y < 0, cell.z < 0);
    const Block* other = findBlock(grid, block.place - step);
    SKINBENCH_ASSERT(other);
    return vertexOf(*other, cell + step * kBlockCells);
}

// The three grid edges that leave the cell's first corner; those that cross the surface become quads.
void addQuads(const Grid& grid, const Block& block, glm::ivec3 cell, uint8_t signs, std::vector<Quad>& quads) {
    for (int axis = 0; axis < 3; ++axis) {
        const int first = signs & 1, second = signs >> (1 << axis) & 1;
        if (first == second) continue;
        glm::ivec3 u(0), v(0);
        u[(axis + 1) % 3] = 1;
        v[(axis + 2) % 3] = 1;
        Quad quad{neighbourVertex(grid, block, cell), neighbourVertex(grid, block, cell - u),
                  neighbourVertex(grid, block, cell - u - v), neighbourVertex(grid, block, cell - v)};
        if (!first) std::swap(quad[1], quad[3]);
        quads.push_back(quad);
    }
}

DualMesh makeDual(const Grid& grid) {
    std::array<glm::vec3, 256> means;
    for (int i = 1; i < 255; ++i) means[size_t(i)] = crossingMean(uint8_t(i));
    DualMesh dual;
    dual.positions.reserve(grid.vertices);
    dual.blocks.reserve(grid.vertices);
    dual.quads.reserve(grid.vertices + 2);
    for (size_t b = 0; b < grid.blocks.size(); ++b) {
        const Block& block = grid.blocks[b];
        for (int i = 0; i < kCellsPerBlock; ++i) {
            if (!(block.crossed >> i & 1)) continue;
            const glm::ivec3 cell(i % 4, i / 4 % 4, i / 16);
            const uint8_t signs = cellSigns(block.inside, cell);
            const glm::vec3 corner = grid.corner(block.place * kBlockCells + cell);
            dual.positions.push_back(corner + means[signs] * grid.spacing);
            dual.blocks.push_back(uint32_t(b));
            addQuads(grid, block, cell, signs, dual.quads);
        }
    }
    return dual;
}

// One Newton step along the gradient, no longer than half a cell.
glm::vec3 towardsSurface(const Field& field, SegmentList list, glm::vec3 p, float longest) {
    const Sample s = sampleField(field, list, p);
    const float slope2 = glm::dot(s.gradient, s.gradient);
    if (slope2 < 1e-6f) return p;
    const glm::vec3 step = s.gradient * (-s.value / slope2);
    const float length = std::sqrt(glm::dot(step, step));
    return p + (length > longest ? step * (longest / length) : step);
}

void project(const Field& field, const Grid& grid, DualMesh& dual, int steps) {
    parallelRanges(dual.positions.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const SegmentList list = grid.segments(grid.blocks[dual.blocks[i]]);
            for (int s = 0; s < steps; ++s)
                dual.positions[i] = towardsSurface(field, list, dual.positions[i], 0.5f * grid.spacing);
        }
    });
}

// Moves every vertex towards the mean of the vertices it shares a quad edge with; the projection that follows takes
// the normal part away again.
void relax(DualMesh& dual) {
    std::vector<glm::vec4> sums(dual.positions.size(), glm::vec4(0));
    for (const Quad& q : dual.quads)
        for (size_t k = 0; k < 4; ++k)
            sums[q[k]] += glm::vec4(dual.positions[q[(k + 1) % 4]] + dual.positions[q[(k + 3) % 4]], 2);
    for (size_t i = 0; i < sums.size(); ++i)
        dual.positions[i] += 0.7f * (glm::vec3(sums[i]) / sums[i].w - dual.positions[i]);
}

std::vector<uint32_t> splitQuads(const DualMesh& dual) {
    std::vector<uint32_t> indices;
    indices.reserve(dual.quads.size() * 6);
    for (const Quad& q : dual.quads) {
        const glm::vec3 a = dual.positions[q[2]] - dual.positions[q[0]],
                        b = dual.positions[q[3]] - dual.positions[q[1]];
        if (glm::dot(a, a) <= glm::dot(b, b))
            indices.insert(indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
        else
            indices.insert(indices.end(), {q[1], q[2], q[3], q[1], q[3], q[0]});
    }
    return indices;
}

// --- skinning --------------------------------------------------------------------------------------------------

struct Takeover {
    uint32_t joint = 0;
    float along = 0;  // where, as arc length from the chain's first node
    float softness = 0;
};

std::vector<std::vector<Takeover>> findTakeovers(const Body& body, const Field& field) {
    std::vector<std::vector<Takeover>> result(body.chains.size());
    for (size_t c = 0; c < body.chains.size(); ++c)
        for (const ChainJoint& j : body.chains[c].joints) {
            Takeover takeover{j.joint, 0, j.softness};
            float closest = 1e9f;
            for (const Segment& s : field.segments) {
                if (s.chain != c) continue;
                const NearestPoint at = nearest(s, body.jointPositions[j.joint]);
                const glm::vec3 way = s.start + s.axis * at.t - body.jointPositions[j.joint];
                if (glm::dot(way, way) >= closest) continue;
                closest = glm::dot(way, way);
                takeover.along = s.alongStart + at.t * s.length;
            }
            result[c].push_back(takeover);
        }
    return result;
}

struct JointWeight {
    uint32_t joint = 0;
    float weight = 0;
};

void addChainWeights(const std::vector<Takeover>& takeovers, float along, float scale, std::vector<JointWeight>& to) {
    float taken = 1;
    for (size_t j = 0; j < takeovers.size(); ++j) {
        float next = 0;
        if (j + 1 < takeovers.size()) {
            const Takeover& t = takeovers[j + 1];
            next = std::min(taken, smoothStep((along - t.along) / (2 * t.softness) + 0.5f));
        }
        const float weight = (taken - next) * scale;
        taken = next;
        if (weight <= 0) continue;
        const auto same = std::find_if(to.begin(), to.end(), [&](auto& w) { return w.joint == takeovers[j].joint; });
        if (same != to.end())
            same->weight += weight;
        else
            to.push_back({takeovers[j].joint, weight});
    }
}

Influences pickInfluences(const Body& body, std::vector<JointWeight>& weights) {
    std::sort(weights.begin(), weights.end(), [](const JointWeight& a, const JointWeight& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.joint < b.joint;
    });
    float all = 0, sum = 0;
    for (const JointWeight& w : weights) all += w.weight;
    size_t count = 0;
    for (; count < weights.size() && count < size_t(body.influences); ++count) {
        if (count > 0 && weights[count].weight < body.smallestWeight * all) break;
        sum += weights[count].weight;
    }
    Influences result;
    for (size_t i = 0; i < count; ++i) {
        result.joints[i] = uint16_t(weights[i].joint);
        result.weights[i] = weights[i].weight / sum;
    }
    return result;
}

Influences skinAt(const Body& body, const Field& field, SegmentList list,
                  const std::vector<std::vector<Takeover>>& takeovers, glm::vec3 p) {
    std::vector<JointWeight> weights;
    for (size_t i = 0; i < list.size();) {
        const uint16_t c = field.segments[list[i]].chain;
        float axisDistance = 1e9f, distance = 1e9f, along = 0, blend = 0;
        for (; i < list.size() && field.segments[list[i]].chain == c; ++i) {
            const Segment& s = field.segments[list[i]];
            const NearestPoint at = nearest(s, p);
            if (at.axisDistance >= axisDistance) continue;
            axisDistance = at.axisDistance;
            distance = at.distance;
            along = s.alongStart + at.t * s.length;
            blend = s.reach;
        }
        const float g = 1 - distance / blend;
        if (g > 0) addChainWeights(takeovers[c], along, g * g, weights);
    }
    return pickInfluences(body, weights);
}

// Surface area is about vertices * spacing^2; grids that miss the wanted count correct the guess.
Grid fitGrid(const Body& body, uint32_t vertices, Field& field) {
    const glm::vec3 size = [&] {
        const Field rough = makeField(body, 0);
        return rough.max - rough.min;
    }();
    float spacing = 0.02f * std::max({size.x, size.y, size.z});
    float wanted = float(std::min(vertices, 8000u));
    Grid best;
    float bestError = 1e9f;
    for (int attempt = 0; attempt < 24; ++attempt) {
        Field f = makeField(body, spacing);
        Grid grid = makeGrid(f, spacing);
        const float count = float(grid.vertices), error = std::fabs(count - float(vertices)) / float(vertices);
        if (error < bestError) {
            bestError = error;
            best = std::move(grid);
            field = std::move(f);
        }
        if (bestError < 0.025f) break;
        if (std::fabs(count - wanted) < 0.1f * wanted) wanted = float(vertices);
        const float step = attempt < 10 ? 1.0f : 0.5f;  // thin limbs can make the guess swing around its aim
        spacing *= 1 + step * (std::sqrt(count / wanted) - 1);
    }
    return best;
}

}  // namespace

Mesh meshBody(const Body& body, uint32_t vertices) {
    Field field;
    const Grid grid = fitGrid(body, vertices, field);
    DualMesh dual = makeDual(grid);
    project(field, grid, dual, 2);
    for (int pass = 0; pass < 3; ++pass) {
        relax(dual);
        project(field, grid, dual, pass == 2 ? 2 : 1);
    }
    Mesh mesh;
    mesh.indices = splitQuads(dual);
    mesh.normals.resize(dual.positions.size());
    mesh.influences.resize(dual.positions.size());
    const auto takeovers = findTakeovers(body, field);
    parallelRanges(dual.positions.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const SegmentList list = grid.segments(grid.blocks[dual.blocks[i]]);
            const glm::vec3 p = dual.positions[i];
            mesh.normals[i] = unit(sampleField(field, list, p).gradient);
            mesh.influences[i] = skinAt(body, field, list, takeovers, p);
        }
    });
    mesh.positions = std::move(dual.positions);
    return mesh;
}

}  // namespace skinbench::builtin
