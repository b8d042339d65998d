// Which cases of result files belong together: cases that are equal but for some axes, in one file or in two.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "common/core/result.h"

namespace skinbench {

// An axis that the two cases of a pair may differ in. A's case has the value `base`; where that is empty, the axis'
// usual value (of the variants `vertex`), or else the first in the order of its values that A has among equal cases.
struct PairAxis {
    std::string name, base;
};

// From "codec", "vertex-fetch", "--codecs" or "codec=uc". An axis or a value that A does not have is an input error
// that lists what there is. Files as loadResults gives them.
Result<std::vector<PairAxis>> parsePairAxes(std::span<const std::string> words, const nlohmann::ordered_json& a);

struct CasePair {
    const nlohmann::ordered_json* a;  // cases of the files
    const nlohmann::ordered_json* b;
    std::string direction;  // "codec: uc → pc", every axis that they differ in
};

struct Pairing {
    std::vector<CasePair> pairs;  // those of one direction together
    size_t alone = 0;             // cases of A that no pair has
};

// Both may be the same file. An axis that means nothing to a case counts as the usual value, and one that only means
// something beside a paired one may differ too. The second of two equal cases of a self-test is left out.
Pairing pairCases(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b, std::span<const PairAxis> axes);

// For two files that have no case in common: "they differ in codec (uc in A, pc in B); --pair codec compares them".
std::string whyNoneShared(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

}  // namespace skinbench
