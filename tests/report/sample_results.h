// A result file of every kind of case, for tests of what is written and read.
#pragma once

#include <limits>

#include <nlohmann/json.hpp>

#include "common/report/report.h"
#include "tests/cases.h"

namespace skinbench {

using Json = nlohmann::ordered_json;

inline Case scanCase(const char* route, const char* variant) {
    Case c = makeCase(route, variant);
    if (c.builder) c.builder = findBuilder("scan");
    return c;
}

inline CaseResult makeResult(const Case& c, CaseStatus status, std::string reason = {}) {
    CaseResult result;
    result.theCase = c;
    result.id = caseId(c);
    result.status = status;
    result.reason = std::move(reason);
    return result;
}

inline RunContext makeContext() {
    RunContext context;
    context.version = "1.2.3";
    context.revision = "abc";
    context.buildType = "Release";
    context.os = "Test OS";
    context.cpu = "Test CPU";
    DeviceCaps vulkan = generousCaps(Api::vulkan), opengl = generousCaps(Api::opengl);
    vulkan.name = "Lava <pipe> & co";
    vulkan.software = true;
    opengl.name = "Real GPU";
    opengl.ext.available = false;
    context.devices = {vulkan, opengl};
    context.sceneName = "hero, \"the\" <b>&amp;";
    context.scene = {100, 200, 30, 40, 1.5, 4};
    context.workload.copies = 7;
    context.workload.animated = false;
    return context;
}

// A timed case on a software driver, one on hardware, a skipped one, a failed one, and one that was only verified.
inline std::vector<CaseResult> makeResults() {
    std::vector<CaseResult> results;
    results.push_back(makeResult(scanCase("vk-ext", "mesh"), CaseStatus::ok));
    results[0].total = {1, 2, 4, 9};
    results[0].roundSizes = {2, 2};
    results[0].limitId = "vk-ext/none/ids/scan/redirect+ordered-records";
    results[0].counters = Counters{.clippingPrimitives = 77, .meshInvocations = 64};
    results[0].passes = {{"draw", {1, 2, 4, 9}}};
    results[0].record = {0.25, 0.5, 0.75};
    results[0].submit = {0.125};
    results[0].meshlets = 12;
    results[0].memory = MemoryBytes{1000, 0, 24, 0, 0, 0, 0};
    results[0].accuracy = Accuracy{{1.5e-7, 2e-6}, 2e-6, {1.5e-7, 2e-6}, 0, "vk-ext/mesh/uc/scan/redirect"};
    results.push_back(makeResult(scanCase("gl", "compute"), CaseStatus::ok));
    results[1].total = {0.5};
    results[1].roundSizes = {1};
    results[1].overlapped = {0.4};
    results[1].passes = {{"skin", {0.2}}, {"draw", {0.3}}};
    results[1].memory = MemoryBytes{2048, 512, 0, 0, 0, 0, 1024};
    results[1].accuracy = Accuracy{{1e-7, 1e-6}, 2e-6, {3e-5, 4e-4}, 0.25, "vk-ext/mesh/uc/scan/redirect"};
    results.push_back(makeResult(scanCase("gl-nv", "mesh"), CaseStatus::skipped, "Real GPU has no GL_NV_mesh_shader"));
    results.push_back(makeResult(scanCase("vk", "vertex"), CaseStatus::failed, "off by \"1\", <far>\nand more"));
    results[3].accuracy = Accuracy{{std::numeric_limits<double>::infinity(), 0.5}, 2e-6, {}, 0, {}};
    results.push_back(makeResult(scanCase("cpu", "cpu"), CaseStatus::ok));
    results[4].accuracy = Accuracy{{0, 0}, 2e-6, 0, {}};
    results.push_back(makeResult(*limitCase(results[0].theCase), CaseStatus::ok));
    results[5].isLimit = true;
    results[5].total = {0.75, 1.25};
    results[5].roundSizes = {1, 1};
    for (size_t timed : {0, 1, 5}) results[timed].figures = figuresOf(results[timed]);
    results[0].figures->interval = {1.5, 6.5};
    return results;
}

inline Json sample() { return resultsJson(makeContext(), makeResults()); }

}  // namespace skinbench
