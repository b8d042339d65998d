#include "common/scene/builtin/grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "common/core/parallel.h"

namespace skinbench::builtin {

namespace {

constexpr int kTopCells = 32;  // the descent starts here: 32, 16, 8, 4

int cornerIndex(glm::ivec3 c) { return c.x + kBlockCorners * (c.y + kBlockCorners * c.z); }

bool placeLess(const Block& a, const Block& b) {
    if (a.place.z != b.place.z) return a.place.z < b.place.z;
    if (a.place.y != b.place.y) return a.place.y < b.place.y;
    return a.place.x < b.place.x;
}

// --- finding the blocks --------------------------------------------------------------------------------------

enum class Where { outside, inside, surface };

// Interval bounds of F over the ball around `centre`; `kept` receives the segments that matter there: those of the
// chains in reach that are nearest to some point of the ball.
Where classify(const Field& field, SegmentList list, glm::vec3 centre, float radius, float margin,
               std::vector<uint16_t>& kept) {
    kept.clear();
    float upper = 0, lower = 0;
    std::vector<NearestPoint> points(list.size());
    for (size_t i = 0; i < list.size(); ++i) points[i] = nearest(field.segments[list[i]], centre);
    for (size_t i = 0, end = 0; i < list.size(); i = end) {
        const Segment& first = field.segments[list[i]];
        float nearestAxis = 1e9f;
        for (end = i; end < list.size() && field.segments[list[end]].chain == first.chain; ++end)
            nearestAxis = std::min(nearestAxis, points[end].axisDistance);
        float least = 1e9f, most = -1e9f;
        bool inReach = false;
        const size_t firstKept = kept.size();
        for (size_t k = i; k < end; ++k) {
            const Segment& s = field.segments[list[k]];
            const float d = points[k].distance, ahead = points[k].axisDistance - nearestAxis;
            if (ahead > 2 * (radius + margin)) continue;
            kept.push_back(list[k]);
            inReach = inReach || d - s.lipschitz * (radius + margin) < s.reach;
            if (ahead > 2 * radius) continue;
            least = std::min(least, d - s.lipschitz * radius);
            most = std::max(most, d + s.lipschitz * radius);
        }
        if (!inReach) kept.resize(firstKept);
        const float high = 1 - least * first.inverseBlend, low = 1 - most * first.inverseBlend;
        if (high > 0) upper += high * high;
        if (low > 0) lower += low * low;
    }
    return upper < 0.999f ? Where::outside : lower > 1.001f ? Where::inside : Where::surface;
}

struct Found {
    std::vector<Block> blocks;
    std::vector<uint16_t> segmentLists;
};

void sampleBlock(const Field& field, const Grid& grid, glm::ivec3 firstCell, SegmentList list, Found& found) {
    Block block;
    block.place = firstCell / kBlockCells;
    for (int z = 0; z < kBlockCorners; ++z)
        for (int y = 0; y < kBlockCorners; ++y)
            for (int x = 0; x < kBlockCorners; ++x) {
                const glm::ivec3 c(x, y, z);
                block.inside[size_t(cornerIndex(c))] = isInside(field, list, grid.corner(firstCell + c));
            }
    if (block.inside.none() || block.inside.all()) return;
    block.firstSegment = uint32_t(found.segmentLists.size());
    block.segmentCount = uint32_t(list.size());
    found.segmentLists.insert(found.segmentLists.end(), list.begin(), list.end());
    found.blocks.push_back(block);
}

void descend(const Field& field, const Grid& grid, glm::ivec3 firstCell, int cells, SegmentList list, Found& found) {
    const float half = 0.5f * float(cells) * grid.spacing;
    const glm::vec3 centre = grid.corner(firstCell) + glm::vec3(half);
    std::vector<uint16_t> kept;
    const float radius = half * 1.7321f + 0.01f * grid.spacing;  // the margin lets vertices leave their block a little
    if (classify(field, list, centre, radius, grid.spacing, kept) != Where::surface) return;
    if (cells == kBlockCells) return sampleBlock(field, grid, firstCell, kept, found);
    const int h = cells / 2;
    for (int i = 0; i < 8; ++i)
        descend(field, grid, firstCell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2) * h, h, kept, found);
}

void findBlocks(const Field& field, Grid& grid) {
    std::vector<uint16_t> all(field.segments.size());
    for (size_t i = 0; i < all.size(); ++i) all[i] = uint16_t(i);
    const glm::ivec3 tops = grid.blockCount / (kTopCells / kBlockCells);
    std::vector<Found> found(size_t(tops.x * tops.y * tops.z));
    parallelRanges(found.size(), [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const glm::ivec3 top(int(i) % tops.x, int(i) / tops.x % tops.y, int(i) / tops.x / tops.y);
            descend(field, grid, top * kTopCells, kTopCells, all, found[i]);
        }
    });
    for (const Found& part : found) {
        const auto offset = uint32_t(grid.segmentLists.size());
        for (Block block : part.blocks) {
            block.firstSegment += offset;
            grid.blocks.push_back(block);
        }
        grid.segmentLists.insert(grid.segmentLists.end(), part.segmentLists.begin(), part.segmentLists.end());
    }
}

void sortBlocks(Grid& grid) {
    std::sort(grid.blocks.begin(), grid.blocks.end(), placeLess);
    grid.rowStart.assign(size_t(grid.blockCount.y * grid.blockCount.z) + 1, 0);
    for (const Block& b : grid.blocks) ++grid.rowStart[size_t(b.place.z * grid.blockCount.y + b.place.y) + 1];
    for (size_t i = 1; i < grid.rowStart.size(); ++i) grid.rowStart[i] += grid.rowStart[i - 1];
}

// --- making it a manifold ------------------------------------------------------------------------------------

// True where one vertex in the cell would join two sheets of the surface: a face whose diagonals differ in sign, or
// inside (or outside) corners that no path along the cell's edges connects.
bool isBad(uint8_t signs) {
    if (signs == 0 || signs == 0xFF) return false;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, o = side << axis;
            const int a = signs >> o & 1, b = signs >> (o | u) & 1, c = signs >> (o | u | v) & 1,
                      d = signs >> (o | v) & 1;
            if (a == c && b == d && a != b) return true;
        }
    for (const int wanted : {signs & 0xFF, ~signs & 0xFF}) {
        int reached = wanted & -wanted;
        for (int step = 0; step < 8; ++step) {
            const int x = (reached & 0x55) << 1 | (reached & 0xAA) >> 1;
            const int y = (reached & 0x33) << 2 | (reached & 0xCC) >> 2;
            const int z = (reached & 0x0F) << 4 | (reached & 0xF0) >> 4;
            reached |= (x | y | z) & wanted;
        }
        if (reached != wanted) return true;
    }
    return false;
}

std::array<bool, 256> makeBadTable() {
    std::array<bool, 256> table{};
    for (int i = 0; i < 256; ++i) table[size_t(i)] = isBad(uint8_t(i));
    return table;
}

struct Filler {
    const Field& field;
    Grid& grid;
    std::map<std::array<int, 3>, Block> added;  // blocks that were all outside before
    std::vector<glm::ivec3> open{};             // cells to look at

    Block* at(glm::ivec3 place) {
        if (const Block* b = findBlock(grid, place)) return const_cast<Block*>(b);
        const auto it = added.find({place.x, place.y, place.z});
        return it == added.end() ? nullptr : &it->second;
    }

    void fillCorner(glm::ivec3 c, const Block& source) {
        const glm::ivec3 place = c / kBlockCells;
        for (int i = 0; i < 8; ++i) {
            const glm::ivec3 p = place - glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
            const glm::ivec3 local = c - p * kBlockCells;
            if (std::max({local.x, local.y, local.z}) > kBlockCells) continue;
            Block* b = at(p);
            if (!b) {
                b = &added[{p.x, p.y, p.z}];
                b->place = p;
                b->firstSegment = source.firstSegment;
                b->segmentCount = source.segmentCount;
            }
            b->inside.set(size_t(cornerIndex(local)));
        }
        for (int i = 0; i < 8; ++i) open.push_back(c - glm::ivec3(i & 1, i >> 1 & 1, i >> 2));
    }

    // Makes the outside corner that is nearest to the surface an inside one. Corners only ever turn inside: it ends.
    void fillCell(glm::ivec3 cell, const std::array<bool, 256>& bad) {
        const Block* b = at(cell / kBlockCells);
        if (!b) return;
        const uint8_t signs = cellSigns(b->inside, cell % kBlockCells);
        if (!bad[signs]) return;
        glm::ivec3 best(0);
        float most = -1;
        for (int i = 0; i < 8; ++i) {
            if (signs >> i & 1) continue;
            const glm::ivec3 c = cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
            const float f = density(field, grid.segments(*b), grid.corner(c));
            if (f > most) {
                most = f;
                best = c;
            }
        }
        fillCorner(best, *b);
    }
};

void fillBadCells(const Field& field, Grid& grid) {
    static const std::array<bool, 256> bad = makeBadTable();
    Filler filler{field, grid, {}};
    for (const Block& b : grid.blocks)
        for (int i = 0; i < kCellsPerBlock; ++i) {
            const glm::ivec3 cell(i % 4, i / 4 % 4, i / 16);
            if (bad[cellSigns(b.inside, cell)]) filler.open.push_back(b.place * kBlockCells + cell);
        }
    while (!filler.open.empty()) {
        const glm::ivec3 cell = filler.open.back();
        filler.open.pop_back();
        filler.fillCell(cell, bad);
    }
    if (filler.added.empty()) return;
    for (const auto& [place, block] : filler.added) grid.blocks.push_back(block);
    sortBlocks(grid);
}

}  // namespace

void parallelRanges(size_t count, const std::function<void(size_t, size_t)>& work) {
    const size_t threads = std::min<size_t>(coreCount(), 8);
    const size_t chunk = std::max<size_t>((count + threads * 4 - 1) / (threads * 4), 1);
    if (threads == 1 || count < 64) return work(0, count);
    parallelEach(threads, [&](size_t t) {
        for (size_t begin = t * chunk; begin < count; begin += threads * chunk)
            work(begin, std::min(begin + chunk, count));
    });
}

uint8_t cellSigns(const CornerBits& inside, glm::ivec3 cell) {
    unsigned signs = 0;
    for (int i = 0; i < 8; ++i)
        signs |= unsigned(inside[size_t(cornerIndex(cell + glm::ivec3(i & 1, i >> 1 & 1, i >> 2)))]) << i;
    return uint8_t(signs);
}

const Block* findBlock(const Grid& grid, glm::ivec3 place) {
    const size_t row = size_t(place.z * grid.blockCount.y + place.y);
    const auto begin = grid.blocks.begin() + grid.rowStart[row], end = grid.blocks.begin() + grid.rowStart[row + 1];
    const auto it = std::lower_bound(begin, end, place.x, [](const Block& b, int x) { return b.place.x < x; });
    return it != end && it->place.x == place.x ? &*it : nullptr;
}

Grid makeGrid(const Field& field, float spacing) {
    Grid grid;
    grid.spacing = spacing;
    // A block of room on every side, so that filling never reaches the border.
    grid.origin = field.min - glm::vec3(float(kBlockCells) * spacing);
    const glm::vec3 size = (field.max - grid.origin) / spacing;
    for (int i = 0; i < 3; ++i)
        grid.blockCount[i] =
            (int(std::floor(size[i])) + kBlockCells) / kTopCells * (kTopCells / kBlockCells) + kTopCells / kBlockCells;
    findBlocks(field, grid);
    sortBlocks(grid);
    fillBadCells(field, grid);
    for (Block& b : grid.blocks) {
        b.firstVertex = grid.vertices;
        for (int i = 0; i < kCellsPerBlock; ++i) {
            const uint8_t signs = cellSigns(b.inside, {i % 4, i / 4 % 4, i / 16});
            if (signs != 0 && signs != 0xFF) b.crossed |= uint64_t(1) << i;
        }
        grid.vertices += uint32_t(std::popcount(b.crossed));
    }
    return grid;
}

}  // namespace skinbench::builtin
