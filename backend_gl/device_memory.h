// Large buffers in memory that Vulkan allocates and OpenGL imports (GL_EXT_memory_object_fd).
//
// NVIDIA's OpenGL allocates so that vertices beyond about 450 MiB are fetched more slowly than Vulkan fetches
// them: 1.14 of the time on an H200 with driver 580.159, whatever flags the buffer has. In memory of Vulkan's the
// difference is gone, so it was none of the API but of how memory is mapped. Elsewhere OpenGL allocates itself.
#pragma once

#include <memory>

#include "backend_gl/memory.h"

namespace skinbench {

struct VulkanMemory;  // a Vulkan device on the context's GPU

// Of one context, which must be current.
class DeviceMemory {
public:
    DeviceMemory();
    ~DeviceMemory();

    // As makeBuffer, which takes over for small buffers and wherever Vulkan or the import gives out. What is in an
    // imported buffer is undefined.
    Result<GlBuffer> make(uint64_t bytes, const std::string& what);

private:
    bool tried_ = false;
    std::unique_ptr<VulkanMemory> vulkan_;
};

}  // namespace skinbench
