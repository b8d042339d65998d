// What tests of plans, shaders and backends share: every case, devices that allow everything, a tiny scene.
#pragma once

#include <string>
#include <vector>

#include "common/cases/workload.h"

namespace skinbench {

// Every route, variant and codec, each with every value of every axis, and some values together. Raster modes
// share everything with the first of them and are left out.
std::vector<Case> everyCase();

// Everything else at its default; meshopt and redirect on mesh routes.
Case makeCase(const char* route, const char* variant, const char* codec = "uc");

DeviceCaps generousCaps(Api api);

ShaderLibrary testShaders();

// A bar of `segments` boxes along y with a joint each and a clip that bends it; smooth weights of up to 8 influences.
Scene tinyScene(uint32_t segments = 12);

Workload tinyWorkload(uint32_t copies);

// The folder with the shared models, or empty when this machine has none.
std::string modelFolder();
std::vector<std::string> modelFiles();

}  // namespace skinbench
