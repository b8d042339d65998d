// The drivers of this machine, opened under validation once for all tests of a program: a driver's start costs more
// than a verification.
#pragma once

#include "common/measure/bench.h"

namespace skinbench {

const Backends& openedBackends();

// Tests run under validation, unless the machine has no layers for it and SKINBENCH_NO_VALIDATION says so.
bool underValidation();
bool anyDriver();

}  // namespace skinbench
