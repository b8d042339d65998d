// Where fuzzing begins: small inputs of each target, made here so that no binary file has to be kept.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace skinbench::fuzz {

// By the target's name.
std::map<std::string, std::vector<std::vector<uint8_t>>> makeCorpus();

}  // namespace skinbench::fuzz
