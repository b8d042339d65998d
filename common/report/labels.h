// Short names of the cases of one table: what all ids share is said once.
#pragma once

#include <string>
#include <vector>

namespace skinbench {

// An id's parts: route, variant, codec[, builder, layout]; and its options.
struct IdParts {
    std::vector<std::string> path, options;
};
IdParts readIdParts(const std::string& id);

struct SharedParts {
    std::string codec;                 // empty: they differ
    std::string meshlets;              // "meshopt/redirect", of those that have meshlets; empty: they differ
    std::vector<std::string> options;  // that every case has
};

// Of the ids of at least two cases; of fewer, nothing is shared.
SharedParts sharedParts(const std::vector<std::string>& ids);

// With the options that name the work of a case, "no-fragments, 8-influences", where that is said.
SharedParts withWork(SharedParts shared, const std::string& work);

// "/uc, with meshlets /meshopt/redirect, +no-fragments"; empty: nothing is shared.
std::string sharedText(const SharedParts& shared);

// Variant and whatever is not shared, "mesh-ci/pdc8+ordered-records"; the route is not in it.
std::string shortName(const std::string& id, const SharedParts& shared);

}  // namespace skinbench
