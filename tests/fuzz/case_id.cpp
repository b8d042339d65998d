// Lines: a case's id, or an axis with its values as the command line names them, "codec=uc,pc".
#include <sstream>

#include "common/cases/axes.h"
#include "tests/fuzz/input.h"

using namespace skinbench;

namespace {

constexpr size_t kMaxCases = 1000;

// What follows from a case, and its id names it again.
void checkCase(const Case& c) {
    const std::string id = caseId(c);
    const auto again = parseCaseId(id);
    SKINBENCH_ASSERT(again && caseId(*again) == id);
    SKINBENCH_ASSERT(keyOf(*again, Changes::raster) == keyOf(c, Changes::raster));
    SKINBENCH_ASSERT(pictureOf(*again) == pictureOf(c) && definesOf(*again) == definesOf(c));
    if (const auto limit = limitCase(c)) SKINBENCH_ASSERT(parseCaseId(caseId(*limit)).has_value());
}

void readSelector(const std::string& line, size_t equals, AxisWords& words, size_t& most) {
    if (!findAxis(line.substr(0, equals))) return;
    std::vector<std::string> values;
    std::istringstream list(line.substr(equals + 1));
    for (std::string word; std::getline(list, word, ',');) values.push_back(word);
    most *= std::max<size_t>(values.size(), 1);
    if (most <= kMaxCases) words[line.substr(0, equals)] = values;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    std::istringstream lines(std::string(data, data + size));
    AxisWords words;
    size_t most = 1;
    for (std::string line; std::getline(lines, line);) {
        if (const size_t equals = line.find('='); equals != line.npos) {
            readSelector(line, equals, words, most);
        } else if (const auto parsed = parseCaseId(line)) {
            checkCase(*parsed);
        } else {
            SKINBENCH_ASSERT(!parsed.error().text.empty());
        }
    }
    if (words.empty()) return 0;
    const auto cases = crossCases(words);
    for (size_t i = 0; cases && i < cases->size(); i += 1 + cases->size() / 16) checkCase((*cases)[i]);
    return 0;
}
