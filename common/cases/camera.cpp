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

// To one side and to the other in turn, ever farther: 15, -15, 30, … degrees. The main view is number 0.
float turnOf(uint32_t view) { return 15.0f * static_cast<float>((view + 1) / 2) * (view % 2 ? 1.0f : -1.0f); }

// A turned view steps back until the grid's near end fits.
glm::mat4 fromTheFront(const Framing& framing, const Grid& grid, uint32_t view) {
    const float aspect = static_cast<float>(framing.width) / static_cast<float>(framing.height);
    const float fieldOfView = glm::radians(20.0f);
    const float turn = glm::radians(turnOf(view)), aside = std::abs(std::sin(turn));
    const float gridWidth = grid.columns * grid.cellWidth;
    const float width = gridWidth * std::cos(turn) + grid.depth * aside;
    const float whole = std::max(grid.rows * grid.cellHeight, width / aspect) * 0.5f;
    // The grid reaches the view's edges one way; how far it reaches the other way says how much a nearer view leaves
    // out.
    const float least = std::min(grid.rows * grid.cellHeight, width / aspect) * 0.5f / whole;
    const float half = least <= 0.5f ? 0.5f : std::sqrt(0.5f * least);
    const float height = static_cast<float>(framing.height);
    const float halfHeight = framing.camera == Camera::half ? whole * half
                             : framing.characterPixels > 0  ? grid.height * 0.5f * height / framing.characterPixels
                                                            : whole;
    const float distance = halfHeight / std::tan(fieldOfView * 0.5f) + grid.depth * 0.55f + gridWidth * 0.5f * aside;
    const float yaw = glm::radians(framing.yaw) + turn;
    const glm::vec3 eye =
        grid.target + distance * glm::vec3(std::sin(yaw), framing.yaw == 0 ? 0 : 0.12f, std::cos(yaw));
    return glm::perspectiveRH_ZO(fieldOfView, aspect, distance * 0.2f, distance * 2 + grid.depth * 2) *
           glm::lookAtRH(eye, grid.target, glm::vec3(0, 1, 0));
}

// Just before the middle of the grid, whose copies stand in one plane, and nearly along it. The other views look ever
// more towards the plane, the last one along it the other way.
glm::mat4 fromInside(const Framing& framing, const Grid& grid, uint32_t view) {
    const float aspect = static_cast<float>(framing.width) / static_cast<float>(framing.height);
    const glm::vec3 eye = grid.target + glm::vec3(0, 0, grid.depth);
    constexpr float towards = 0.25f;
    const float turn = view * (glm::pi<float>() - 2 * std::atan(towards)) / (MOST_VIEWS - 1);
    const glm::vec3 along = glm::normalize(
        glm::vec3(std::cos(turn) - towards * std::sin(turn), 0, -std::sin(turn) - towards * std::cos(turn)));
    const float farthest = grid.columns * grid.cellWidth + 4 * grid.depth;
    return glm::perspectiveRH_ZO(glm::radians(60.0f), aspect, grid.depth * 0.05f, farthest) *
           glm::lookAtRH(eye, eye + along, glm::vec3(0, 1, 0));
}

glm::mat4 viewProjection(const Framing& framing, const Grid& grid, uint32_t view) {
    glm::mat4 matrix =
        framing.camera == Camera::inside ? fromInside(framing, grid, view) : fromTheFront(framing, grid, view);
    for (int column = 0; column < 4; ++column) matrix[column].y = -matrix[column].y;  // y points down
    return matrix;
}

}  // namespace

FrameConstants frameConstants(const Framing& framing, uint32_t frame) {
    const Grid grid = layOut(framing);
    FrameConstants constants;
    constants.viewProjection = viewProjection(framing, grid, 0);
    for (uint32_t view = 1; view < MOST_VIEWS; ++view)
        constants.otherViews[view - 1] = viewProjection(framing, grid, view);
    const bool together = framing.camera == Camera::close;
    constants.grid = {static_cast<float>(grid.columns), together ? 0 : grid.cellWidth, together ? 0 : grid.cellHeight,
                      static_cast<float>(frame)};
    return constants;
}

}  // namespace skinbench
