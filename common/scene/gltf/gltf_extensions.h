// What is done about each extension that changes what a mesh, node, skin or animation looks like. docs/scenes.md holds
// the same table.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/result.h"

namespace skinbench {

enum class ExtensionRole {
    supported,  // read; may be required
    harmless,   // changes nothing that is drawn here; may be required
    ignored,    // left out with a warning; refused where the file requires it
    refused,    // the file's geometry cannot be read without it
};

struct GltfExtension {
    const char* name;  // a trailing * stands for any ending
    ExtensionRole role;
    const char* effect;  // what happens, or what is not done
};

// Sorted by role, then by name.
std::span<const GltfExtension> gltfExtensions();

// Null: not known.
const GltfExtension* findGltfExtension(std::string_view name);

// The extensions that objects of a file carry, and how often.
struct FoundExtensions {
    std::map<std::string, uint64_t, std::less<>> counts;
};

// One sentence for each that is ignored; those that are not known share one.
std::vector<std::string> describe(const FoundExtensions& found);

// An error where the file cannot be drawn without it.
Result<void> checkRequired(std::string_view name);

}  // namespace skinbench
