// GLSL text to SPIR-V (glslang, in the process) and SPIR-V to pipelines.
#pragma once

#include "backend_vulkan/device.h"

namespace skinbench::vulkan {

using Spirv = std::shared_ptr<const std::vector<uint32_t>>;

// Kept for the life of the process: a text that compiled is not compiled again, for another device neither. The error
// is glslang's first error line.
Result<Spirv> compileGlsl(const ShaderText& shader, const DeviceCaps& caps);

// One pipeline of a program. Graphics pipelines leave rasteriser discard, culling and the depth test to the command
// buffer, so that every raster mode runs the same compiled shaders.
Result<VkPipeline> makePipeline(Device& device, VkPipelineCache cache, VkPipelineLayout layout, const Program& program,
                                PassKind kind, bool writeColor);

// The driver's pipeline cache, kept in ${XDG_CACHE_HOME:-~/.cache}/skinbench. A file that is broken or of another
// driver is ignored, and so is a folder that cannot be written: it only saves time.
Result<VkPipelineCache> openPipelineCache(Device& device);
void closePipelineCache(Device& device, VkPipelineCache cache);

}  // namespace skinbench::vulkan
