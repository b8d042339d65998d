#include "common/core/host_memory.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

namespace skinbench {

// The number behind `key` in a file of the kernel, or the file's only one; empty where it has none ("max").
static std::optional<uint64_t> numberIn(const char* file, const std::string& key = "") {
    std::ifstream words(file);
    std::string word;
    while (!key.empty() && word != key)
        if (!(words >> word)) return std::nullopt;
    uint64_t number = 0;
    return words >> number ? std::optional(number) : std::nullopt;
}

uint64_t freeHostMemory() {
    uint64_t free = numberIn("/proc/meminfo", "MemAvailable:").value_or(0) * 1024;
    // What the group uses already counts pages that would be given back, so its limit alone is sure.
    if (const auto most = numberIn("/sys/fs/cgroup/memory.max"); free && most) free = std::min(free, *most);
    return free;
}

}  // namespace skinbench
