// usage: write_corpus FOLDER     One folder for each target in it.
#include <filesystem>
#include <fstream>

#include "tests/fuzz/corpus.h"

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    for (const auto& [target, inputs] : skinbench::fuzz::makeCorpus()) {
        const std::filesystem::path folder = std::filesystem::path(argv[1]) / target;
        std::filesystem::create_directories(folder);
        for (size_t i = 0; i < inputs.size(); ++i) {
            std::ofstream file(folder / std::to_string(i), std::ios::binary);
            file.write(reinterpret_cast<const char*>(inputs[i].data()), static_cast<std::streamsize>(inputs[i].size()));
            if (!file.flush()) return 1;
        }
    }
}
