// One case changed into another, value by value, as controls do it.
#pragma once

#include "common/cases/axes.h"

namespace skinbench {

// Made again in the order of the table, so that each value means something beside those before it: a variant that the
// route has, a meshlet builder where there was none, no option that means nothing. Route and variant are not null.
Case completed(const Case& c);

// The case with another value, completed; a variant that its route lacks takes it to the first one of its API that has
// it. Fails for a word that the axis does not have.
Result<Case> withValue(const Case& c, const Axis& axis, const std::string& word);

// Whether several words of the axis go together, joined with +.
bool joinsWords(const Case& c, const Axis& axis);

// Such a value with the word taken in, or out.
std::string toggledWord(const Axis& axis, const std::string& value, const std::string& word);

}  // namespace skinbench
