// Feeds the corpus and every file below REGRESSIONS/TARGET to its target, without a fuzzer.
// usage: fuzz_replay REGRESSIONS
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/corpus.h"

// tests/fuzz/CMakeLists.txt renames each target's function.
#define SKINBENCH_TARGETS(X) X(case_id) X(decode) X(encode) X(gltf) X(meshopt) X(results)
#define SKINBENCH_DECLARE(name) extern "C" int fuzz_##name(const uint8_t* data, size_t size);
SKINBENCH_TARGETS(SKINBENCH_DECLARE)

int main(int argc, char** argv) {
    namespace fs = std::filesystem;
    if (argc != 2) return 2;
    auto inputs = skinbench::fuzz::makeCorpus();
    std::error_code none;  // of them is there yet
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(argv[1], none)) {
        if (!entry.is_regular_file()) continue;
        std::ifstream file(entry.path(), std::ios::binary);
        inputs[entry.path().parent_path().filename()].emplace_back(std::istreambuf_iterator<char>(file),
                                                                   std::istreambuf_iterator<char>());
    }
#define SKINBENCH_ROW(name) {#name, fuzz_##name},
    const std::map<std::string, int (*)(const uint8_t*, size_t)> targets = {SKINBENCH_TARGETS(SKINBENCH_ROW)};
    for (const auto& [name, list] : inputs) {
        const auto target = targets.find(name);
        if (target == targets.end()) {
            std::fprintf(stderr, "no target '%s'\n", name.c_str());
            return 1;
        }
        for (size_t i = 0; i < list.size(); ++i) {
            std::printf("%s %zu: %zu bytes\n", name.c_str(), i, list[i].size());
            std::fflush(stdout);  // the last line names the input that aborts
            target->second(list[i].data(), list[i].size());
        }
    }
    return targets.size() == inputs.size() ? 0 : 1;
}
