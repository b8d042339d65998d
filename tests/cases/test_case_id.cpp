// Ids, the way back from them, and what else follows from the axes of one case. No driver takes part.
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

#include "common/cases/axes.h"
#include "common/core/file.h"
#include "tests/cases.h"

using namespace skinbench;
using Catch::Matchers::ContainsSubstring;

TEST_CASE("case ids stay what result files of the past say") {
    CHECK(caseId(makeCase("cpu", "cpu")) == "cpu/cpu/uc");
    CHECK(caseId(makeCase("vk", "none")) == "vk/none/uc");
    CHECK(caseId(makeCase("gl", "vertex")) == "gl/vertex/uc");
    CHECK(caseId(makeCase("vk", "compute")) == "vk/compute/uc");
    CHECK(caseId(makeCase("vk-ext", "mesh")) == "vk-ext/mesh/uc/meshopt/redirect");

    Case compute = makeCase("vk", "compute");
    compute.compute = {.staged = true, .packed = true};
    CHECK(caseId(compute) == "vk/compute/uc+staged+packed");
    compute.compute = {true, true, true, true, true, true};
    compute.influences = 8;
    compute.scenario = Scenario::prepass;
    CHECK(caseId(compute) == "vk/compute/uc+staged+previous+tangents+early-exit+packed+half-rate+8-influences+prepass");

    Case pull = makeCase("vk", "vertex");
    pull.fetch = VertexFetch::pull;
    CHECK(caseId(pull) == "vk/vertex/uc+pull");
    pull.influences = 8;
    pull.submission = Submission::batched;
    pull.keepBackFaces = true;
    pull.raster = RasterMode::noFragments;
    CHECK(caseId(pull) == "vk/vertex/uc+8-influences+pull+batched+keep-back-faces+no-fragments");

    Case mesh = makeCase("vk-nv", "mesh");
    CHECK(caseId(mesh) == "vk-nv/mesh/uc/meshopt/redirect");
    mesh.builder = findBuilder("scan");
    mesh.limits = {128, 252};
    mesh.groupSize = 64;
    mesh.packedWrites = false;
    mesh.raster = RasterMode::discard;
    CHECK(caseId(mesh) == "vk-nv/mesh/uc/scan/redirect+128-252+group-64+unpacked-writes+discard");
    // Packed writes exist in the NV dialect only.
    mesh.route = findRoute("gl-ext");
    mesh.limits = {};
    mesh.groupSize = 32;
    mesh.raster = RasterMode::full;
    CHECK(caseId(mesh) == "gl-ext/mesh/uc/scan/redirect");
}

TEST_CASE("ids say every option that is not the default") {
    Case mesh = makeCase("vk-nv", "mesh");
    mesh.shape = {JointSource::staged, true, true, true};
    mesh.layout = findMeshletLayout("fixed");
    mesh.cull = Cull::compact;
    mesh.exchange = Exchange::shared;
    mesh.scenario = Scenario::prepass;
    CHECK(caseId(mesh) ==
          "vk-nv/mesh/uc/meshopt/fixed+joints-staged+clamped-loads+ordered-records+uniform-palette+cull-compact+shared"
          "+prepass");
    Case common = makeCase("gl-ext", "mesh-ci");
    CHECK(caseId(common) == "gl-ext/mesh-ci/uc/meshopt/redirect");
    common.ci = {CiGrouping::triangles, CiKey::ordered, 32, true};
    common.cull = Cull::torabi;
    CHECK(caseId(common) == "gl-ext/mesh-ci/uc/meshopt/redirect+ci-triangles+ci-ordered+ci-min-32+fat+cull-torabi");
    CHECK(caseId(makeCase("gl", "palette")) == "gl/palette/uc+slots-32");
    CHECK(caseId(makeCase("vk-ext", "mesh", "dpdc16")) == "vk-ext/mesh/dpdc16/meshopt/redirect");
}

TEST_CASE("different cases have different ids, and an id leads back to its case") {
    std::set<std::string> ids;
    for (const Case& c : everyCase()) {
        const std::string id = caseId(c);
        INFO(id);
        CHECK(ids.insert(id).second);
        CHECK(id.find(' ') == std::string::npos);
        const auto parsed = parseCaseId(id);
        REQUIRE(parsed);
        CHECK(caseId(*parsed) == id);
        CHECK(keyOf(*parsed, Changes::raster) == keyOf(c, Changes::raster));
    }
    CHECK(ids.contains("gl-nv/none/uc/scan/redirect+unpacked-writes+8-influences+batched"));
}

// The ids of cases, limits and calibrations in the text of a result file.
static std::vector<std::string> idsIn(const std::string& text) {
    static const std::regex field("\"(?:id|limit_id|chosen|image_reference)\": *\"([^\"]+)\"");
    std::vector<std::string> ids;
    for (auto match = std::sregex_iterator(text.begin(), text.end(), field); match != std::sregex_iterator(); ++match)
        ids.push_back((*match)[1]);
    return ids;
}

TEST_CASE("every id of the published results is read and written back") {
    size_t files = 0;
    std::set<std::string> known;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(SKINBENCH_SOURCE_DIR "/docs/results")) {
        if (entry.path().extension() != ".json") continue;
        const auto text = readWholeFile(entry.path().string());
        REQUIRE(text);
        ++files;
        for (const std::string& id : idsIn(*text)) {
            if (!id.contains('/') || !known.insert(id).second) continue;
            INFO(entry.path() << ": " << id);
            const auto parsed = parseCaseId(id);
            if (id.ends_with("+again")) {
                REQUIRE(!parsed);
                CHECK_THAT(parsed.error().text, ContainsSubstring("self-test"));
                continue;
            }
            REQUIRE(parsed);
            CHECK(caseId(*parsed) == id);
        }
    }
    CHECK(files > 0);
    CHECK(known.size() > 500);
}

TEST_CASE("an id that no case has is refused with the part that is wrong") {
    const std::pair<const char*, const char*> wrong[] = {
        {"", "no route ''"},
        {"vk", "its variant is missing"},
        {"vk/vertex", "its codec is missing"},
        {"dx/vertex/uc", "no route 'dx'"},
        {"vk/mesh/uc", "mesh does not exist on route vk"},
        {"vk-ext/mesh/uc", "its builder is missing"},
        {"vk-ext/mesh/uc/meshopt", "its layout is missing"},
        {"vk/vertex/uc/meshopt/redirect", "'meshopt' is one part too many"},
        {"vk-ext/mesh/uc/meshopt/redirect/x", "'x' is one part too many"},
        {"vk/vertex/uc+fast", "there is no option 'fast'"},
        {"vk/vertex/uc+", "there is no option ''"},
        {"vk/vertex/uc+cull-compact", "cull compact means nothing to it"},
        {"vk-ext/mesh/uc/meshopt/redirect+pull", "vertex_fetch pull means nothing to it"},
        {"vk-ext/mesh/uc/meshopt/redirect+group-0", "there is no option 'group-0'"},
        {"vk-ext/mesh/uc/meshopt/redirect+group-99999999999", "there is no option"},
        {"vk-ext/mesh/uc/meshopt/redirect+1-124", "there is no option '1-124'"},
        {"vk/vertex/uc_slim", "no codec 'uc_slim'"},
        {"vk/vertex/uc+again", "'again' marks the second one of two equal cases"},
    };
    for (const auto& [id, why] : wrong) {
        const auto parsed = parseCaseId(id);
        INFO(id);
        REQUIRE(!parsed);
        CHECK(parsed.error().fault == Fault::input);
        CHECK_THAT(parsed.error().text, ContainsSubstring(why));
    }
}

TEST_CASE("options of an id may come in any order") {
    const auto parsed = parseCaseId("vk/vertex/uc+no-fragments+pull+8-influences");
    REQUIRE(parsed);
    CHECK(caseId(*parsed) == "vk/vertex/uc+8-influences+pull+no-fragments");
}
