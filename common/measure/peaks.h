// What a device can do at best, measured beside the cases.
#pragma once

#include "common/frame/backend.h"
#include "common/frame/shader_text.h"

namespace skinbench {

// Bytes a second, read and written together, of a compute pass that copies one large buffer to another; the fastest of
// a few frames. 16 MiB on software drivers, else 256 MiB, so that no cache holds it.
Result<double> measureCopyBandwidth(Backend& backend, const ShaderLibrary& shaders);

}  // namespace skinbench
