#include <format>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/apps.h"
#include "common/core/file.h"
#include "common/core/text.h"

namespace skinbench {

int runSceneList(bool json) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const BuiltinScene& scene : builtinScenes()) {
        if (!json)
            std::cout << std::format("builtin:{:<10} {:>7} vertices  {}\n", scene.name, scene.defaultVertices,
                                     scene.what);
        rows.push_back({{"name", std::string("builtin:") + scene.name},
                        {"what", scene.what},
                        {"default_vertices", scene.defaultVertices}});
    }
    if (json) std::cout << dumpJson(rows) << "\n";
    return kExitDone;
}

int runSceneExport(const std::string& name, const std::string& out) {
    const bool bare = !name.empty() && !name.contains(':') && !name.contains('.');
    auto scene = loadScene(bare ? "builtin:" + name : name);
    if (!scene) return reportError(scene.error());
    for (const std::string& warning : scene->warnings) warn(scene->name + ": " + warning);
    if (auto possible = checkOutput(out, {&name, 1}); !possible) return reportError(possible.error());
    auto saved = saveGlb(*scene, out);
    if (!saved) return reportError(saved.error());
    say(out);
    return kExitDone;
}

}  // namespace skinbench
