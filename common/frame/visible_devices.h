// The part of devices.h that follows the environment's variables.
#pragma once

#include "common/frame/devices.h"

namespace skinbench {

// Sets hiddenBy of the machine's devices, its order and its notes.
void hideDevices(Machine& machine, const Environment& environment);

}  // namespace skinbench
