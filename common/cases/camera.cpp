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

FrameConstants frameConstants(const Framing& framing, uint32_t frame) {
    const glm::vec3 size = glm::max(framing.bounds.max - framing.bounds.min, glm::vec3(1e-6f));
    const float depth = std::max(size.x, size.z);  // a turning character needs its widest side
    const float cellWidth = (framing.yaw == 0 ? size.x : depth) * 1.08f, cellHeight = size.y * 1.08f;
    const double aspect = static_cast<double>(framing.width) / framing.height;
    const uint32_t columns = gridColumns(framing.copies, cellWidth, cellHeight, aspect);
    const uint32_t rows = (framing.copies + columns - 1) / columns;

    const glm::vec3 middle = (framing.bounds.min + framing.bounds.max) * 0.5f;
    const glm::vec3 target = middle + glm::vec3((columns - 1) * cellWidth, -((rows - 1.0f) * cellHeight), 0) * 0.5f;
    const float fieldOfView = glm::radians(20.0f);
    const float halfHeight = std::max(rows * cellHeight, columns * cellWidth / static_cast<float>(aspect)) * 0.5f;
    const float distance = halfHeight / std::tan(fieldOfView * 0.5f) + depth * 0.55f;
    const float yaw = glm::radians(framing.yaw);
    const glm::vec3 eye = target + distance * glm::vec3(std::sin(yaw), framing.yaw == 0 ? 0 : 0.12f, std::cos(yaw));

    glm::mat4 projection =
        glm::perspectiveRH_ZO(fieldOfView, static_cast<float>(aspect), distance * 0.2f, distance * 2 + depth * 2);
    projection[1][1] = -projection[1][1];
    FrameConstants constants;
    constants.viewProjection = projection * glm::lookAtRH(eye, target, glm::vec3(0, 1, 0));
    constants.grid = {static_cast<float>(columns), cellWidth, cellHeight, static_cast<float>(frame)};
    return constants;
}

}  // namespace skinbench
