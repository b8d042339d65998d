// How much memory the host can still give.
#pragma once

#include <cstdint>

namespace skinbench {

// Bytes that can be taken without swapping, no more than the control group of this process allows; 0: unknown.
uint64_t freeHostMemory();

}  // namespace skinbench
