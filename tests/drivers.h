// The drivers of this machine, opened under validation once for all tests of a program: a driver's start costs more
// than a verification.
#pragma once

#include "common/measure/bench.h"

namespace skinbench {

const Backends& openedBackends();
bool anyDriver();

}  // namespace skinbench
