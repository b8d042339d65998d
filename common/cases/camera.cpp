#include "common/cases/camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace skinbench {

// Columns such that a grid of cells w x h comes closest to the image's aspect ratio.
static uint32_t gridColumns(uint32_t copies, double cellWidth, double cellHeight, double aspect) {
    const double ideal = std::sqrt(copies * aspect * cellHeight / cellWidth);
    return std::clamp(static_cast<uint32_t>(std::lround(ideal)), 1u, copies);
}

const std::vector<std::string>& cameraNames() {
    static const std::vector<std::string> names = {"crowd", "half", "inside", "close"};
    return names;
}

namespace {

// A grid of cells whose middle cell `target` is the centre of.
struct Grid {
    uint32_t columns = 1, rows = 1;
    float cellWidth = 0, cellHeight = 0;
    float height = 0, depth = 0;  // of one copy
    glm::vec3 target{0};
};

Grid layOut(const Framing& framing) {
    const glm::vec3 size = glm::max(framing.bounds.max - framing.bounds.min, glm::vec3(1e-6f));
    Grid grid;
    grid.height = size.y;
    grid.depth = std::max(size.x, size.z);  // a turning character needs its widest side
    grid.cellWidth = (framing.yaw == 0 ? size.x : grid.depth) * 1.08f;
    grid.cellHeight = size.y * 1.08f;
    const uint32_t copies = framing.camera == Camera::close ? 1 : framing.copies;
    const double aspect = static_cast<double>(framing.width) / framing.height;
    grid.columns = gridColumns(copies, grid.cellWidth, grid.cellHeight, aspect);
    grid.rows = (copies + grid.columns - 1) / grid.columns;
    const glm::vec3 middle = (framing.bounds.min + framing.bounds.max) * 0.5f;
    grid.target =
        middle + glm::vec3((grid.columns - 1) * grid.cellWidth, -((grid.rows - 1.0f) * grid.cellHeight), 0) * 0.5f;
    return grid;
}

glm::mat4 fromTheFront(const Framing& framing, const Grid& grid) {
    const float aspect = static_cast<float>(framing.width) / static_cast<float>(framing.height);
    const float fieldOfView = glm::radians(20.0f);
    const float whole = std::max(grid.rows * grid.cellHeight, grid.columns * grid.cellWidth / aspect) * 0.5f;
    // The grid reaches the view's edges one way; how far it reaches the other way says how much a nearer view leaves
    // out.
    const float least = std::min(grid.rows * grid.cellHeight, grid.columns * grid.cellWidth / aspect) * 0.5f / whole;
    const float half = least <= 0.5f ? 0.5f : std::sqrt(0.5f * least);
    const float height = static_cast<float>(framing.height);
    const float halfHeight = framing.camera == Camera::half ? whole * half
                             : framing.characterPixels > 0  ? grid.height * 0.5f * height / framing.characterPixels
                                                            : whole;
    const float distance = halfHeight / std::tan(fieldOfView * 0.5f) + grid.depth * 0.55f;
    const float yaw = glm::radians(framing.yaw);
    const glm::vec3 eye =
        grid.target + distance * glm::vec3(std::sin(yaw), framing.yaw == 0 ? 0 : 0.12f, std::cos(yaw));
    return glm::perspectiveRH_ZO(fieldOfView, aspect, distance * 0.2f, distance * 2 + grid.depth * 2) *
           glm::lookAtRH(eye, grid.target, glm::vec3(0, 1, 0));
}

// Just before the middle of the grid, whose copies stand in one plane, and nearly along it.
glm::mat4 fromInside(const Framing& framing, const Grid& grid) {
    const float aspect = static_cast<float>(framing.width) / static_cast<float>(framing.height);
    const glm::vec3 eye = grid.target + glm::vec3(0, 0, grid.depth);
    const glm::vec3 along = glm::normalize(glm::vec3(1, 0, -0.25f));
    const float farthest = grid.columns * grid.cellWidth + 4 * grid.depth;
    return glm::perspectiveRH_ZO(glm::radians(60.0f), aspect, grid.depth * 0.05f, farthest) *
           glm::lookAtRH(eye, eye + along, glm::vec3(0, 1, 0));
}

}  // namespace

FrameConstants frameConstants(const Framing& framing, uint32_t frame) {
    const Grid grid = layOut(framing);
    FrameConstants constants;
    constants.viewProjection =
        framing.camera == Camera::inside ? fromInside(framing, grid) : fromTheFront(framing, grid);
    for (int column = 0; column < 4; ++column)
        constants.viewProjection[column].y = -constants.viewProjection[column].y;  // y points down
    const bool together = framing.camera == Camera::close;
    constants.grid = {static_cast<float>(grid.columns), together ? 0 : grid.cellWidth, together ? 0 : grid.cellHeight,
                      static_cast<float>(frame)};
    return constants;
}

}  // namespace skinbench
