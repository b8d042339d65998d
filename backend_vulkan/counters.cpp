#include "backend_vulkan/counters.h"

#include <array>
#include <bit>

namespace skinbench::vulkan {

namespace {

struct Statistic {
    VkQueryPipelineStatisticFlagBits bit;
    std::optional<uint64_t> Counters::*value;
};

// In the order of their bits, which is the order of the results.
constexpr std::array<Statistic, 9> kStatistics = {{
    {VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_VERTICES_BIT, &Counters::inputVertices},
    {VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_PRIMITIVES_BIT, &Counters::inputPrimitives},
    {VK_QUERY_PIPELINE_STATISTIC_VERTEX_SHADER_INVOCATIONS_BIT, &Counters::vertexInvocations},
    {VK_QUERY_PIPELINE_STATISTIC_CLIPPING_INVOCATIONS_BIT, &Counters::clippingInvocations},
    {VK_QUERY_PIPELINE_STATISTIC_CLIPPING_PRIMITIVES_BIT, &Counters::clippingPrimitives},
    {VK_QUERY_PIPELINE_STATISTIC_FRAGMENT_SHADER_INVOCATIONS_BIT, &Counters::fragmentInvocations},
    {VK_QUERY_PIPELINE_STATISTIC_COMPUTE_SHADER_INVOCATIONS_BIT, &Counters::computeInvocations},
    {VK_QUERY_PIPELINE_STATISTIC_TASK_SHADER_INVOCATIONS_BIT_EXT, &Counters::taskInvocations},
    {VK_QUERY_PIPELINE_STATISTIC_MESH_SHADER_INVOCATIONS_BIT_EXT, &Counters::meshInvocations},
}};

constexpr VkQueryPipelineStatisticFlags kRasterStatistics = VK_QUERY_PIPELINE_STATISTIC_CLIPPING_INVOCATIONS_BIT |
                                                            VK_QUERY_PIPELINE_STATISTIC_CLIPPING_PRIMITIVES_BIT |
                                                            VK_QUERY_PIPELINE_STATISTIC_FRAGMENT_SHADER_INVOCATIONS_BIT;

// A query may only count what the pipelines drawn under it have.
VkQueryPipelineStatisticFlags statisticsOf(const Device& device, const Plan& plan, PassKind kind) {
    switch (kind) {
        case PassKind::dispatch:
            return VK_QUERY_PIPELINE_STATISTIC_COMPUTE_SHADER_INVOCATIONS_BIT;
        case PassKind::drawIndexed:
            return kRasterStatistics | VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_VERTICES_BIT |
                   VK_QUERY_PIPELINE_STATISTIC_INPUT_ASSEMBLY_PRIMITIVES_BIT |
                   VK_QUERY_PIPELINE_STATISTIC_VERTEX_SHADER_INVOCATIONS_BIT;
        case PassKind::drawMesh:
            break;
    }
    if (plan.shape.dialect != MeshDialect::ext || !device.caps.meshCounters) return kRasterStatistics;
    return kRasterStatistics | VK_QUERY_PIPELINE_STATISTIC_MESH_SHADER_INVOCATIONS_BIT_EXT |
           VK_QUERY_PIPELINE_STATISTIC_TASK_SHADER_INVOCATIONS_BIT_EXT;
}

Result<VkQueryPool> makePool(Device& device, VkQueryType type, VkQueryPipelineStatisticFlags flags, uint32_t frames) {
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = type;
    info.queryCount = frames;
    info.pipelineStatistics = flags;
    VkQueryPool pool = VK_NULL_HANDLE;
    SKINBENCH_TRY(check(device, device.vk.vkCreateQueryPool(device.handle, &info, nullptr, &pool),
                        "create the pipeline statistics"));
    return pool;
}

void add(std::optional<uint64_t>& sum, uint64_t value) { sum = sum.value_or(0) + value; }

}  // namespace

CounterQueries::~CounterQueries() {
    if (device.hung) return;
    for (const PassQueries& pass : passes) {
        device.vk.vkDestroyQueryPool(device.handle, pass.statistics, nullptr);
        device.vk.vkDestroyQueryPool(device.handle, pass.meshPrimitives, nullptr);
    }
}

Result<std::unique_ptr<CounterQueries>> makeCounterQueries(Device& device, const Plan& plan, uint32_t frames) {
    auto queries = std::make_unique<CounterQueries>(device);
    for (const Pass& pass : plan.shape.passes) {
        PassQueries& made = queries->passes.emplace_back();
        made.flags = statisticsOf(device, plan, pass.kind);
        auto statistics = makePool(device, VK_QUERY_TYPE_PIPELINE_STATISTICS, made.flags, frames);
        SKINBENCH_TRY(statistics);
        made.statistics = *statistics;
        if (!(made.flags & VK_QUERY_PIPELINE_STATISTIC_MESH_SHADER_INVOCATIONS_BIT_EXT)) continue;
        auto primitives = makePool(device, VK_QUERY_TYPE_MESH_PRIMITIVES_GENERATED_EXT, 0, frames);
        SKINBENCH_TRY(primitives);
        made.meshPrimitives = *primitives;
    }
    return queries;
}

void resetCounters(const CounterQueries& queries, VkCommandBuffer commands, uint32_t frames) {
    for (const PassQueries& pass : queries.passes) {
        queries.device.vk.vkCmdResetQueryPool(commands, pass.statistics, 0, frames);
        if (pass.meshPrimitives) queries.device.vk.vkCmdResetQueryPool(commands, pass.meshPrimitives, 0, frames);
    }
}

void beginCounting(const CounterQueries& queries, VkCommandBuffer commands, size_t pass, uint32_t frame) {
    const PassQueries& of = queries.passes[pass];
    queries.device.vk.vkCmdBeginQuery(commands, of.statistics, frame, 0);
    if (of.meshPrimitives) queries.device.vk.vkCmdBeginQuery(commands, of.meshPrimitives, frame, 0);
}

void endCounting(const CounterQueries& queries, VkCommandBuffer commands, size_t pass, uint32_t frame) {
    const PassQueries& of = queries.passes[pass];
    if (of.meshPrimitives) queries.device.vk.vkCmdEndQuery(commands, of.meshPrimitives, frame);
    queries.device.vk.vkCmdEndQuery(commands, of.statistics, frame);
}

Result<Counters> readCounters(const CounterQueries& queries, uint32_t frame) {
    Device& device = queries.device;
    Counters counters;
    for (const PassQueries& pass : queries.passes) {
        std::array<uint64_t, kStatistics.size()> values{};
        auto read = [&](VkQueryPool pool, size_t count) {
            const size_t bytes = count * sizeof(uint64_t);
            return check(device,
                         device.vk.vkGetQueryPoolResults(device.handle, pool, frame, 1, bytes, values.data(), bytes,
                                                         VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
                         "read the pipeline statistics");
        };
        SKINBENCH_TRY(read(pass.statistics, static_cast<size_t>(std::popcount(pass.flags))));
        size_t place = 0;
        for (const Statistic& statistic : kStatistics)
            if (pass.flags & statistic.bit) add(counters.*statistic.value, values[place++]);
        if (!pass.meshPrimitives) continue;
        SKINBENCH_TRY(read(pass.meshPrimitives, 1));
        add(counters.meshPrimitives, values[0]);
    }
    return counters;
}

}  // namespace skinbench::vulkan
