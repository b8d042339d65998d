// Where the surface passes through a uniform grid: only blocks of 4x4x4 cells that hold a piece of it are kept. A cell
// that the surface crosses becomes one vertex of the dual mesh, a grid edge that it crosses one quad.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/scene/builtin/field.h"

namespace skinbench::builtin {

inline constexpr int kBlockCells = 4;
inline constexpr int kBlockCorners = kBlockCells + 1;
inline constexpr int kCellsPerBlock = kBlockCells * kBlockCells * kBlockCells;

using CornerBits = std::bitset<kBlockCorners * kBlockCorners * kBlockCorners>;  // inside; x runs fastest

struct Block {
    glm::ivec3 place{0};  // in blocks
    CornerBits inside;
    uint32_t firstSegment = 0;
    uint32_t segmentCount = 0;
    uint64_t crossed = 0;  // a bit a cell; x runs fastest
    uint32_t firstVertex = 0;
};

struct Grid {
    glm::vec3 origin{0};
    float spacing = 0;
    glm::ivec3 blockCount{0};
    std::vector<Block> blocks;       // sorted by place: z, then y, then x
    std::vector<uint32_t> rowStart;  // first block of each row of blocks along x, one more at the end
    std::vector<uint16_t> segmentLists;
    uint32_t vertices = 0;

    glm::vec3 corner(glm::ivec3 c) const { return origin + glm::vec3(c) * spacing; }
    SegmentList segments(const Block& b) const { return {segmentLists.data() + b.firstSegment, b.segmentCount}; }
};

// The dual mesh of the grid is a closed manifold: cells that would make it none are filled.
Grid makeGrid(const Field& field, float spacing);

const Block* findBlock(const Grid& grid, glm::ivec3 place);

// Bit i is corner i of the cell: x + 2 y + 4 z.
uint8_t cellSigns(const CornerBits& inside, glm::ivec3 cell);

// Calls work(begin, end) for disjoint ranges on several threads.
void parallelRanges(size_t count, const std::function<void(size_t, size_t)>& work);

}  // namespace skinbench::builtin
