// Every shader text that a case can ask for compiles in its dialect; the text itself says where its lines come from.
#include <set>
#include <tuple>

#include <catch2/catch_test_macros.hpp>

#include <filesystem>

#include "common/cases/workload.h"
#include "common/plans/plans.h"
#include "tests/cases.h"
#include "tests/glslang_check.h"

using namespace skinbench;

TEST_CASE("every case's shaders compile in their dialect") {
    Workload workload = tinyWorkload(2);
    std::set<std::tuple<Api, Stage, std::string>> texts;  // many cases share some
    for (const Case& c : everyCase()) {
        for (bool capture : {false, true}) {
            auto input = planInput(workload, c);
            REQUIRE(input);
            input->capture = capture;
            // Capturing plans also take the ways of a device with small subgroups and other depths.
            DeviceCaps caps = generousCaps(c.route->api);
            if (capture && c.exchange != Exchange::shuffle) caps.meshSubgroups = false;
            caps.meshDepthDiffers = capture;
            auto plan = makePlan(c, *input, caps);
            INFO(caseId(c) << (capture ? " capturing" : ""));
            REQUIRE(plan);
            for (const Program& program : plan->programs)
                for (const ShaderText& shader : program.stages) {
                    if (!texts.insert({c.route->api, shader.stage, shader.text}).second) continue;
                    INFO(shader.name);
                    CHECK(glslangErrors(shader, c.route->api) == "");
                }
        }
    }
    CHECK(texts.size() > 100);
}

TEST_CASE("a device that loses the last mesh output gets a spare one in its mesh stages, and nowhere else") {
    Workload workload = tinyWorkload(2);
    size_t changed = 0;
    for (const Case& c : everyCase()) {
        auto input = planInput(workload, c);
        REQUIRE(input);
        DeviceCaps caps = generousCaps(c.route->api);
        auto healthy = makePlan(c, *input, caps);
        caps.lastMeshOutputLost = true;
        auto faulty = makePlan(c, *input, caps);
        INFO(caseId(c));
        REQUIRE(healthy);
        REQUIRE(faulty);
        for (size_t p = 0; p < faulty->programs.size(); ++p)
            for (size_t s = 0; s < faulty->programs[p].stages.size(); ++s) {
                const ShaderText& shader = faulty->programs[p].stages[s];
                const bool differs = hasStage(faulty->programs[p], Stage::mesh);
                INFO(shader.name);
                CHECK((shader.text != healthy->programs[p].stages[s].text) == differs);
                if (!differs) continue;
                CHECK(glslangErrors(shader, c.route->api) == "");
                ++changed;
            }
    }
    CHECK(changed > 20);
}

TEST_CASE("a timed plan holds no capture code") {
    Workload workload = tinyWorkload(1);
    for (const Case& c : everyCase()) {
        auto input = planInput(workload, c);
        REQUIRE(input);
        auto plan = makePlan(c, *input, generousCaps(c.route->api));
        REQUIRE(plan);
        for (const Stream& stream : plan->streams) CHECK(stream.slot != SLOT_CAPTURE);
    }
}

TEST_CASE("every file of the shader folder is used by some case, and every codec's file exists") {
    const ShaderLibrary library = testShaders();
    std::string used = " shared.h copy.glsl";  // the latter by measureCopyBandwidth
    Workload workload = tinyWorkload(1);
    std::vector<Case> cases = everyCase();
    cases.push_back(*limitCase(cases.front()));
    cases.push_back(*parseCaseId("vk/compute/wicked"));
    for (const Case& c : cases) {
        auto input = planInput(workload, c);
        REQUIRE(input);
        input->capture = true;
        auto plan = makePlan(c, *input, generousCaps(c.route->api));
        REQUIRE(plan);
        for (const Program& program : plan->programs)
            for (const ShaderText& shader : program.stages) used += shader.text.substr(0, shader.text.find('\n', 14));
    }
    for (const auto& [name, text] : library.files) {
        INFO(name);
        CHECK(used.find(name) != std::string::npos);
    }
    for (const Codec& codec : codecs()) CHECK(library.files.contains(codec.shader));
}

TEST_CASE("includes are expanded once and line numbers point into the right file") {
    ShaderLibrary library;
    library.files["a.glsl"] = "first\n#include \"b.glsl\"\n#include \"b.glsl\"\nlast\n";
    library.files["b.glsl"] = "inside\n#include <ignored>\n";
    library.files["c.glsl"] = "#include WHICH\n";
    library.files["d.glsl"] = "#include \"missing.glsl\"\n";
    auto text =
        shaderText(library, {.file = "a.glsl", .stage = Stage::vertex, .api = Api::opengl, .defines = {{"N", "3"}}});
    REQUIRE(text);
    CHECK(text->text.starts_with("#version 450\n// 1=a.glsl 2=b.glsl\n#define N 3\n"));
    const std::string inside = "#ifndef INCLUDED_2\n#define INCLUDED_2\n#line 1 2\ninside\n#line 3 2\n#endif\n";
    CHECK(text->text.ends_with("#line 1 1\nfirst\n" + inside + "#line 3 1\n" + inside + "#line 4 1\nlast\n#endif\n"));
    library.files["e.glsl"] = "#include \"e.glsl\"\n";
    auto circle = shaderText(library, {.file = "e.glsl"});
    REQUIRE(!circle);
    CHECK(circle.error().text == "shader e.glsl includes itself through e.glsl");
    auto indirect = shaderText(library, {.file = "c.glsl", .defines = {{"WHICH", "\"b.glsl\""}}});
    REQUIRE(indirect);
    CHECK(indirect->text.find("inside") != std::string::npos);
    CHECK(indirect->text.find("WHICH") == std::string::npos);
    auto missing = shaderText(library, {.file = "d.glsl"});
    REQUIRE(!missing);
    CHECK(missing.error().text == "shader missing.glsl, which d.glsl includes, does not exist");
}

TEST_CASE("only mesh stages name a mesh-shader extension, and the right one") {
    ShaderLibrary library;
    library.files["a.glsl"] = "";
    auto text = [&](Stage stage, MeshDialect dialect) {
        return shaderText(library, {.file = "a.glsl", .stage = stage, .dialect = dialect})->text;
    };
    CHECK(text(Stage::mesh, MeshDialect::ext).find("#extension GL_EXT_mesh_shader : require") != std::string::npos);
    CHECK(text(Stage::mesh, MeshDialect::nv).find("#extension GL_NV_mesh_shader : require") != std::string::npos);
    CHECK(text(Stage::fragment, MeshDialect::nv).find("mesh_shader") == std::string::npos);
}

TEST_CASE("a shader folder that is not there is one clear error") {
    auto library = loadShaders("/nonexistent");
    REQUIRE(!library);
    CHECK(library.error().fault == Fault::input);
}
