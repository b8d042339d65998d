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

float aspectOf(const Framing& framing) {
    return static_cast<float>(framing.width) / static_cast<float>(framing.height);
}

// A turned view steps back until the grid's near end fits.
Look fromTheFront(const Framing& framing, const Grid& grid, uint32_t view) {
    const float aspect = aspectOf(framing);
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
    return {eye, grid.target, fieldOfView, distance * 0.2f, distance * 2 + grid.depth * 2};
}

// Just before the middle of the grid, whose copies stand in one plane, and nearly along it; where a row is so short
// that the view would pass by its end, towards that end. The other views look ever more towards the plane, the last one
// along it the other way.
Look fromInside(const Grid& grid, uint32_t view) {
    const glm::vec3 eye = grid.target + glm::vec3(0, 0, grid.depth);
    const float towards = std::max(0.25f, grid.depth / (grid.columns * grid.cellWidth * 0.5f));
    const float turn = view * (glm::pi<float>() - 2 * std::atan(towards)) / (MOST_VIEWS - 1);
    const glm::vec3 along = glm::normalize(
        glm::vec3(std::cos(turn) - towards * std::sin(turn), 0, -std::sin(turn) - towards * std::cos(turn)));
    const float farthest = grid.columns * grid.cellWidth + 4 * grid.depth;
    return {eye, eye + along, glm::radians(60.0f), grid.depth * 0.05f, farthest};
}

Look lookOf(const Framing& framing, const Grid& grid, uint32_t view) {
    return framing.camera == Camera::inside ? fromInside(grid, view) : fromTheFront(framing, grid, view);
}

// What cameras leave out lies beside, behind and far from them. An eye that has a corner of the grid inside an edge of
// the image is at least as far, along `towards` and away from the edge, as the corner is: four such bounds, the largest
// of all corners, give the nearest eye.
Look fromAside(const Framing& framing, const Grid& grid) {
    const float turn = glm::radians(framing.yaw + 35), pitch = glm::radians(15.0f), fieldOfView = glm::radians(20.0f);
    const glm::vec3 towards(std::cos(pitch) * std::sin(turn), std::sin(pitch), std::cos(pitch) * std::cos(turn));
    const glm::vec3 right(std::cos(turn), 0, -std::sin(turn)), up = glm::cross(towards, right);
    const glm::vec3 half = glm::vec3(grid.columns * grid.cellWidth, grid.rows * grid.cellHeight, grid.depth) * 0.5f;
    const float slopeUp = std::tan(fieldOfView * 0.5f), slopeRight = slopeUp * aspectOf(framing);
    float atRight = 0, atLeft = 0, atTop = 0, atBottom = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 corner = half * glm::vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
        const float x = glm::dot(corner, right), y = glm::dot(corner, up), z = glm::dot(corner, towards);
        atRight = std::max(atRight, z * slopeRight + x);
        atLeft = std::max(atLeft, z * slopeRight - x);
        atTop = std::max(atTop, z * slopeUp + y);
        atBottom = std::max(atBottom, z * slopeUp - y);
    }
    const float distance = std::max((atRight + atLeft) / slopeRight, (atTop + atBottom) / slopeUp) * 0.5f;
    const glm::vec3 target = grid.target + (right * (atRight - atLeft) + up * (atTop - atBottom)) * 0.5f;
    return {target + distance * towards, target, fieldOfView, distance * 0.02f, distance + glm::length(half)};
}

glm::mat4 viewProjection(const Framing& framing, const Look& look) {
    const float aspect = aspectOf(framing);
    glm::mat4 matrix = glm::perspectiveRH_ZO(look.fieldOfView, aspect, look.nearest, look.farthest) *
                       glm::lookAtRH(look.eye, look.target, glm::vec3(0, 1, 0));
    for (int column = 0; column < 4; ++column) matrix[column].y = -matrix[column].y;  // y points down
    return matrix;
}

}  // namespace

Look lookOf(const Framing& framing) { return lookOf(framing, layOut(framing), 0); }

Look overviewOf(const Framing& framing) { return fromAside(framing, layOut(framing)); }

FrameConstants frameConstants(const Framing& framing, uint32_t frame, const CameraMove& move,
                              const CameraMove& overview) {
    const Grid grid = layOut(framing);
    const auto matrix = [&](const Look& look) { return viewProjection(framing, movedLook(look, move)); };
    FrameConstants constants;
    constants.viewProjection = matrix(lookOf(framing, grid, 0));
    for (uint32_t view = 1; view < MOST_VIEWS; ++view)
        constants.otherViews[view - 1] = matrix(lookOf(framing, grid, view));
    constants.overview = viewProjection(framing, movedLook(fromAside(framing, grid), overview));
    const bool together = framing.camera == Camera::close;
    constants.grid = {static_cast<float>(grid.columns), together ? 0 : grid.cellWidth, together ? 0 : grid.cellHeight,
                      static_cast<float>(frame)};
    return constants;
}

Look movedLook(const Look& usual, const CameraMove& move) {
    if (move == CameraMove{}) return usual;
    const glm::vec3 from = usual.eye - usual.target;
    const float distance = glm::length(from);
    // Short of the poles, where there is no up.
    const float height = std::asin(from.y / distance);
    const float pitch = std::clamp(height + glm::radians(move.pitch), -1.55f, 1.55f);
    const float turn = std::atan2(from.x, from.z) + glm::radians(move.turn);
    Look look = usual;
    look.target = usual.target + move.moved * distance;
    look.eye = look.target +
               distance * move.zoom *
                   glm::vec3(std::cos(pitch) * std::sin(turn), std::sin(pitch), std::cos(pitch) * std::cos(turn));
    look.farthest = glm::distance(look.eye, usual.target) + usual.farthest;
    look.nearest = std::min(usual.nearest * std::min(move.zoom, 1.0f), look.farthest / 100);
    return look;
}

CameraMove dragged(CameraMove move, const Look& usual, const glm::vec2& drag, bool flying) {
    const glm::vec3 eye = movedLook(usual, move).eye;
    move.turn = std::remainder(move.turn - drag.x * 180, 360.0f);
    move.pitch = std::clamp(move.pitch + drag.y * 120, -89.0f, 89.0f);
    if (flying) move.moved += (eye - movedLook(usual, move).eye) / glm::distance(usual.eye, usual.target);
    return move;
}

CameraMove gone(CameraMove move, const Look& usual, const glm::vec3& by) {
    const Look look = movedLook(usual, move);
    const glm::vec3 ahead = glm::normalize(look.target - look.eye);
    const glm::vec3 right = glm::normalize(glm::cross(ahead, glm::vec3(0, 1, 0)));
    move.moved += (right * by.x + glm::cross(right, ahead) * by.y + ahead * by.z) * move.zoom;
    return move;
}

}  // namespace skinbench
