// A file of a stranger: loaded or refused in one line. What is loaded holds every promise of loadScene.
#include "common/scene/pose.h"
#include "tests/fuzz/input.h"

using namespace skinbench;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto scene = loadGltf(fuzz::fileOf({data, size}));
    if (!scene) {
        SKINBENCH_ASSERT(!scene.error().text.empty());
        return 0;
    }
    SKINBENCH_ASSERT(checkScene(*scene).has_value());
    for (const Clip& clip : scene->clips)
        for (const float time : {0.0f, clip.duration / 2, clip.duration})
            SKINBENCH_ASSERT(poseScene(*scene, &clip, time).size() == scene->skeleton.joints.size());
    return 0;
}
