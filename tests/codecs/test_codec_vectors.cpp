// Checks files of reference vectors row by row: codes exactly, weights as closely as single precision allows.
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <nlohmann/json.hpp>

#include "common/codecs/permutation.h"
#include "common/codecs/simplex.h"
#include "tests/codec_test.h"

using namespace skinbench;
using nlohmann::json;

namespace {

std::vector<std::filesystem::path> vectorFiles() {
    const std::string folder = test::folderOf("SKINBENCH_VECTORS", "/../shared/vectors");
    std::vector<std::filesystem::path> files;
    if (!std::filesystem::is_directory(folder)) SKIP("no folder " << folder << ": set SKINBENCH_VECTORS");
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    if (files.empty()) SKIP("no vectors in " << folder << ": set SKINBENCH_VECTORS");
    return files;
}

void requireKeys(const json& object, const std::set<std::string>& required,
                 const std::set<std::string>& optional = {}) {
    REQUIRE(object.is_object());
    for (const auto& [key, value] : object.items()) {
        INFO("key " << key);
        REQUIRE((required.contains(key) || optional.contains(key)));
    }
    for (const std::string& key : required) {
        INFO("key " << key);
        REQUIRE(object.contains(key));
    }
}

std::vector<uint32_t> rowOf(const json& row, size_t columns) {
    REQUIRE(row.is_array());
    REQUIRE(row.size() == columns);
    std::vector<uint32_t> result;
    for (const json& cell : row) {
        REQUIRE(cell.is_number_unsigned());
        REQUIRE(cell.get<uint64_t>() <= UINT32_MAX);
        result.push_back(cell.get<uint32_t>());
    }
    return result;
}

std::vector<float> floatsOf(const std::vector<uint32_t>& row, size_t first, size_t count) {
    std::vector<float> result;
    for (size_t i = 0; i < count; ++i) result.push_back(std::bit_cast<float>(row[first + i]));
    return result;
}

// decode(encode) within the bounds of docs/codecs.md 4.5 plus 1e-6; an error of the sum goes into the largest weight.
void checkWithinBounds(const PermutationCode& code, const std::vector<float>& weights, uint32_t tuple) {
    const auto blend = decodePermutation(code, encodePermutation(code, weights, tuple));
    REQUIRE(blend.has_value());
    CHECK(blend->tuple == tuple);
    double sum = 0;
    for (const float w : weights) sum += w;
    const double slack = std::abs(sum - 1) + 1e-6;
    double length = 0;
    double single = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        const double d = std::abs(double{blend->weights[i]} - weights[i]);
        length += d * d;
        single = std::max(single, d);
    }
    CHECK(std::sqrt(length) <= worstErrorLength(code) + slack);
    CHECK(single <= worstErrorSingle(code) + slack);
}

void checkPermutationRow(const PermutationCode& code, const std::vector<uint32_t>& row) {
    const size_t k = static_cast<size_t>(code.entries) + 1;
    const std::vector<float> weights = floatsOf(row, 0, k);
    const std::vector<float> expected = floatsOf(row, k + 3, k);
    const uint32_t tuple = row[k];
    const uint64_t value = row[k + 1] | uint64_t{row[k + 2]} << 32;
    const uint32_t fragile = row[2 * k + 3];
    INFO("code " << value);
    REQUIRE(fragile <= 1);
    CHECK(encodePermutation(code, weights, tuple) == value);  // fragile rows too: this build is strict

    const auto blend = decodePermutation(code, value);
    REQUIRE(blend.has_value());
    CHECK(blend->tuple == tuple);
    const float tolerance = k == 4 ? 2.5e-7f : 5e-7f;
    for (size_t i = 0; i < k; ++i) CHECK(std::abs(blend->weights[i] - expected[i]) <= tolerance);
    checkWithinBounds(code, weights, tuple);
}

void checkPermutationConfig(const json& config) {
    requireKeys(config,
                {"name", "influences", "entry_count", "code_bits", "weight_value_count", "extra_value_counts",
                 "payload_quotient_count", "tuple_count", "rows", "roundtrip_only"},
                {"columns"});
    INFO("config " << config["name"]);
    const auto code = makePermutationCode(config["extra_value_counts"].get<std::vector<uint32_t>>(),
                                          config["weight_value_count"].get<uint32_t>(),
                                          config["tuple_count"].get<uint64_t>(), config["code_bits"].get<int>());
    REQUIRE(code.has_value());
    CHECK(code->entries == config["entry_count"]);
    CHECK(code->entries + 1 == config["influences"]);
    CHECK(code->quotients == config["payload_quotient_count"]);
    if (config["name"] == "n4_b32_w58") CHECK(*code == kPermutationPc);
    if (config["name"] == "n4_b32_w36") CHECK(*code == kPermutationDpdc16);
    const size_t k = static_cast<size_t>(code->entries) + 1;
    CHECK_FALSE(config["rows"].empty());
    for (const json& row : config["rows"]) checkPermutationRow(*code, rowOf(row, 2 * k + 4));
    for (const json& row : config["roundtrip_only"]) {
        const std::vector<uint32_t> cells = rowOf(row, k + 1);
        checkWithinBounds(*code, floatsOf(cells, 0, k), cells[k]);
    }
}

void checkSimplexDecode(const SimplexCode& code, uint64_t value, const std::vector<float>& expected) {
    INFO("code " << value);
    const auto point = decodeSimplexPoint(code, value);
    REQUIRE(point.has_value());
    CHECK(encodeSimplexPoint(code, *point) == value);
    if (code.bits <= kMaxSimplexBits32) CHECK(decodeSimplexPoint32(code, static_cast<uint32_t>(value)) == *point);
    const glm::vec4 weights = simplexWeights(code, *point);
    for (int i = 0; i < 4; ++i) CHECK(std::abs(weights[i] - expected[i]) <= 2.5e-7f);
}

void checkSimplexConfig(const json& config) {
    requireKeys(config, {"name", "bits", "N", "code_count", "scale", "rows", "decode_only"}, {"columns"});
    INFO("config " << config["name"]);
    const auto code = makeSimplexCode(config["bits"].get<int>());
    REQUIRE(code.has_value());
    CHECK(code->n == config["N"]);
    CHECK(code->count == config["code_count"]);
    CHECK(code->step == config["scale"].get<double>());
    CHECK_FALSE(config["rows"].empty());
    for (const json& row : config["rows"]) {
        const std::vector<uint32_t> cells = rowOf(row, 10);
        const std::vector<float> w = floatsOf(cells, 0, 4);
        REQUIRE(cells[9] <= 1);
        CHECK(encodeSimplex(*code, {w[0], w[1], w[2], w[3]}) == cells[4]);
        checkSimplexDecode(*code, cells[4], floatsOf(cells, 5, 4));
    }
    for (const json& row : config["decode_only"]) {
        const std::vector<uint32_t> cells = rowOf(row, 5);
        checkSimplexDecode(*code, cells[0], floatsOf(cells, 1, 4));
    }
}

}  // namespace

TEST_CASE("reference vectors") {
    for (const std::filesystem::path& path : vectorFiles()) {
        INFO("file " << path.filename());
        std::ifstream stream(path);
        const json file = json::parse(stream, nullptr, false);
        REQUIRE_FALSE(file.is_discarded());
        requireKeys(file, {"schema", "configs"});
        REQUIRE_FALSE(file["configs"].empty());
        const std::string schema = file["schema"];
        INFO("schema " << schema);
        REQUIRE((schema == "permutation-coding-vectors/1" || schema == "oss-vectors/1"));
        for (const json& config : file["configs"]) {
            schema == "oss-vectors/1" ? checkSimplexConfig(config) : checkPermutationConfig(config);
        }
    }
}
