// Records and times batches of frames.
#include <algorithm>
#include <format>
#include <map>
#include <utility>

#include "backend_vulkan/batch.h"
#include "backend_vulkan/counters.h"
#include "backend_vulkan/in_flight.h"

namespace skinbench {

namespace vulkan {

namespace {

using Clock = std::chrono::steady_clock;

class VulkanBackend final : public Backend {
public:
    VulkanBackend(std::unique_ptr<Device> device, VkPipelineCache cache)
        : device_(std::move(device)), pipelineCache_(cache) {}
    ~VulkanBackend() override;

    const DeviceCaps& caps() const override { return device_->caps; }
    Result<PlanId> prepare(const FramePlan& plan) override;
    Result<std::vector<Timing>> run(PlanId id, std::span<const FrameInput> frames, RunMode mode) override;
    Result<void> begin(PlanId id, const FrameInput& frame) override;
    Result<FinishedFrame> finish(PlanId id) override;
    Result<Image> readImage(PlanId id) override;
    Result<std::vector<std::byte>> readStream(PlanId id, uint32_t slot) override;
    void release(PlanId id) override;
    std::vector<std::string> takeMessages() override;

private:
    Result<Plan*> findPlan(PlanId id) const;
    InFlight* framesOf(PlanId id) const;
    Result<std::shared_ptr<Target>> targetFor(const FramePlan& plan);
    Result<double> copySkinned(Plan& plan, std::span<const std::byte> skinned);
    void recordOverlapped(const FrameRecord& record, uint32_t query) const;
    Result<void> runBatch(const Plan& plan, size_t first, std::span<Timing> timings, RunMode mode);
    Result<void> runTogether(const Plan& plan, std::span<Timing> timings);
    Result<void> countBatch(const Plan& plan, size_t first, std::span<Timing> timings);

    std::unique_ptr<Device> device_;
    VkPipelineCache pipelineCache_;
    Timestamps times_;
    std::unique_ptr<TwoQueues> twoQueues_;  // null before the first batch over two queues
    FrameData frameData_;
    std::map<std::pair<uint32_t, uint32_t>, std::weak_ptr<Target>> targets_;
    std::map<PlanId, std::unique_ptr<Plan>> plans_;
    std::map<PlanId, std::unique_ptr<InFlight>> inFlight_;  // of plans that a frame of began
    PlanId nextPlan_ = 1;
};

VulkanBackend::~VulkanBackend() {
    if (!device_->hung) device_->vk.vkDeviceWaitIdle(device_->handle);
    inFlight_.clear();
    plans_.clear();
    twoQueues_.reset();
    destroy(*device_, frameData_.buffer);
    destroy(*device_, times_);
    closePipelineCache(*device_, pipelineCache_);
}

Result<Plan*> VulkanBackend::findPlan(PlanId id) const {
    if (device_->lost) return std::unexpected(*device_->lost);
    auto plan = plans_.find(id);
    if (plan == plans_.end()) return unknownPlan(id);
    return plan->second.get();
}

Result<std::shared_ptr<Target>> VulkanBackend::targetFor(const FramePlan& plan) {
    if (!drawsImage(plan)) return nullptr;
    std::weak_ptr<Target>& known = targets_[{plan.width, plan.height}];
    if (auto target = known.lock()) return target;
    auto target = createTarget(*device_, {plan.width, plan.height});
    if (target) known = *target;
    return target;
}

Result<PlanId> VulkanBackend::prepare(const FramePlan& plan) {
    if (device_->lost) return std::unexpected(*device_->lost);
    SKINBENCH_TRY(checkPlan(plan, caps()));
    auto target = targetFor(plan);
    SKINBENCH_TRY(target);
    auto objects = makePlanObjects(*device_, pipelineCache_, plan, std::move(*target));
    SKINBENCH_TRY(objects);
    plans_.emplace(nextPlan_, std::move(*objects));
    return nextPlan_++;
}

Result<double> VulkanBackend::copySkinned(Plan& plan, std::span<const std::byte> skinned) {
    const Buffer& stream = bufferOf(plan, *plan.hostWritten, 0);
    const auto start = Clock::now();
    std::ranges::copy(skinned, plan.hostStaging.mapped);
    SKINBENCH_TRY(flush(*device_, plan.hostStaging));
    auto commands = beginCommands(*device_);
    SKINBENCH_TRY(commands);
    const VkBufferCopy region{0, 0, stream.bytes};
    device_->vk.vkCmdCopyBuffer(*commands, plan.hostStaging.handle, stream.handle, 1, &region);
    fullBarrier(*device_, *commands);
    SKINBENCH_TRY(endCommands(*device_));
    SKINBENCH_TRY(submitAndWait(*device_));
    return elapsedMs(start);
}

void VulkanBackend::recordOverlapped(const FrameRecord& record, uint32_t query) const {
    const Pass* const first = firstDrawing(record.plan.shape);
    if (first && first->clear) clearTarget(record);
    fullBarrier(*device_, record.commands);
    writeTimestamp(*device_, record.commands, times_.pool, query);
    recordPasses(record, 0, record.plan.shape.passes.size(), nullptr, first);
    writeTimestamp(*device_, record.commands, times_.pool, query + 1);
    fullBarrier(*device_, record.commands);
}

Result<void> VulkanBackend::runBatch(const Plan& plan, size_t first, std::span<Timing> timings, RunMode mode) {
    const auto pairs = static_cast<uint32_t>(timesOfFrame(plan.shape, mode));
    const uint32_t count = static_cast<uint32_t>(timings.size()) * pairs * 2;
    SKINBENCH_TRY(needTimestamps(*device_, times_, count));
    const auto start = Clock::now();
    auto commands = beginCommands(*device_);
    SKINBENCH_TRY(commands);
    if (count) device_->vk.vkCmdResetQueryPool(*commands, times_.pool, 0, count);
    fullBarrier(*device_, *commands);
    for (uint32_t i = 0; i < timings.size(); ++i) {
        const FrameRecord record{plan, frameData_, *commands, first + i};
        bindFrame(record);
        if (mode != RunMode::timed) recordOverlapped(record, i * 2);
        if (mode == RunMode::timed) recordTimed(record, times_.pool, i * pairs * 2);
    }
    SKINBENCH_TRY(endCommands(*device_));
    const double record = elapsedMs(start);
    auto submit = submitAndWait(*device_, [&] { return timestampsDone(*device_, times_, count); });
    SKINBENCH_TRY(submit);
    for (Timing& timing : timings) {
        timing.record = record / static_cast<double>(timings.size());
        timing.submit = *submit / static_cast<double>(timings.size());
    }
    return readTimings(*device_, times_, pairs, timings);
}

// RunMode::batch.
Result<void> VulkanBackend::runTogether(const Plan& plan, std::span<Timing> timings) {
    const auto count = static_cast<uint32_t>(2 + timings.size());
    SKINBENCH_TRY(needTimestamps(*device_, times_, count));
    HostTimes host;
    if (plan.shape.passesAhead) {
        if (!twoQueues_) {
            auto opened = openTwoQueues(*device_);
            SKINBENCH_TRY(opened);
            twoQueues_ = std::move(*opened);
        }
        auto times = runOverTwoQueues(*twoQueues_, plan, frameData_, timings.size(), times_.pool);
        SKINBENCH_TRY(times);
        host = *times;
    } else {
        const auto start = Clock::now();
        auto commands = beginCommands(*device_);
        SKINBENCH_TRY(commands);
        device_->vk.vkCmdResetQueryPool(*commands, times_.pool, 0, count);
        fullBarrier(*device_, *commands);
        recordBatch(plan, frameData_, *commands, timings.size(), times_.pool);
        SKINBENCH_TRY(endCommands(*device_));
        host.record = elapsedMs(start);
        auto submit = submitAndWait(*device_, [&] { return timestampsDone(*device_, times_, count); });
        SKINBENCH_TRY(submit);
        host.submit = *submit;
    }
    const auto frames = static_cast<double>(timings.size());
    Timing one;
    SKINBENCH_TRY(readTimings(*device_, times_, 1, std::span(&one, 1)));
    for (double& milliseconds : one.passes) milliseconds /= frames;
    one.record = host.record / frames;
    one.submit = host.submit / frames;
    std::ranges::fill(timings, one);
    return {};
}

Result<void> VulkanBackend::countBatch(const Plan& plan, size_t first, std::span<Timing> timings) {
    const auto frames = static_cast<uint32_t>(timings.size());
    auto counters = makeCounterQueries(*device_, plan, frames);
    SKINBENCH_TRY(counters);
    auto commands = beginCommands(*device_);
    SKINBENCH_TRY(commands);
    resetCounters(**counters, *commands, frames);
    fullBarrier(*device_, *commands);
    for (uint32_t i = 0; i < frames; ++i) {
        const FrameRecord record{plan, frameData_, *commands, first + i};
        bindFrame(record);
        for (size_t pass = 0; pass < plan.shape.passes.size(); ++pass)
            recordPass(record, pass,
                       [&](uint32_t end) { (end ? endCounting : beginCounting)(**counters, *commands, pass, i); });
    }
    SKINBENCH_TRY(endCommands(*device_));
    SKINBENCH_TRY(submitAndWait(*device_));
    for (uint32_t i = 0; i < frames; ++i) {
        auto read = readCounters(**counters, i);
        SKINBENCH_TRY(read);
        timings[i].counters = *read;
    }
    return {};
}

Result<std::vector<Timing>> VulkanBackend::run(PlanId id, std::span<const FrameInput> frames, RunMode mode) {
    auto found = findPlan(id);
    SKINBENCH_TRY(found);
    Plan& plan = **found;
    SKINBENCH_TRY(checkFrames(plan.shape, frames));
    std::vector<Timing> timings(frames.size());
    if (frames.empty() || (mode == RunMode::counted && !caps().pipelineStatistics)) return timings;
    if (InFlight* begun = framesOf(id)) SKINBENCH_TRY(waitForFrames(*begun));
    SKINBENCH_TRY(uploadFrames(*device_, frameData_, plan, frames));
    if (plan.target) plan.target->lastPlan = id;
    plan.lastTurn = (frames.size() - 1) % plan.turns.size();
    auto batch = [&](size_t first, std::span<Timing> of) {
        return mode == RunMode::counted ? countBatch(plan, first, of) : runBatch(plan, first, of, mode);
    };
    if (runsTogether(plan.shape, mode)) {
        SKINBENCH_TRY(runTogether(plan, timings));
        return timings;
    }
    if (!plan.hostWritten) {
        SKINBENCH_TRY(batch(0, timings));
        return timings;
    }
    for (size_t i = 0; i < frames.size(); ++i) {
        auto milliseconds = copySkinned(plan, frames[i].skinned);
        SKINBENCH_TRY(milliseconds);
        SKINBENCH_TRY(batch(i, std::span(timings).subspan(i, 1)));
        timings[i].upload = *milliseconds;
    }
    return timings;
}

InFlight* VulkanBackend::framesOf(PlanId id) const {
    const auto frames = inFlight_.find(id);
    return frames == inFlight_.end() ? nullptr : frames->second.get();
}

Result<void> VulkanBackend::begin(PlanId id, const FrameInput& frame) {
    auto plan = findPlan(id);
    SKINBENCH_TRY(plan);
    InFlight* frames = framesOf(id);
    SKINBENCH_TRY(checkBegin((*plan)->shape, frame, frames ? frames->slots.begun : 0));
    if (!frames) {
        auto opened = openInFlight(*device_, **plan);
        SKINBENCH_TRY(opened);
        frames = inFlight_.emplace(id, std::move(*opened)).first->second.get();
    }
    SKINBENCH_TRY(beginFrame(*frames, **plan, frame));
    (*plan)->target->lastPlan = id;
    return {};
}

Result<FinishedFrame> VulkanBackend::finish(PlanId id) {
    auto plan = findPlan(id);
    SKINBENCH_TRY(plan);
    InFlight* frames = framesOf(id);
    SKINBENCH_TRY(checkFinish((*plan)->shape, frames ? frames->slots.begun : 0));
    return finishFrame(*frames);
}

void VulkanBackend::release(PlanId id) {
    inFlight_.erase(id);
    plans_.erase(id);
}

Result<Image> VulkanBackend::readImage(PlanId id) {
    auto plan = findPlan(id);
    SKINBENCH_TRY(plan);
    const Target* target = (*plan)->target.get();
    SKINBENCH_TRY(checkImage((*plan)->shape, id, target ? target->lastPlan : 0));
    return downloadImage(*device_, *target);
}

Result<std::vector<std::byte>> VulkanBackend::readStream(PlanId id, uint32_t slot) {
    auto plan = findPlan(id);
    SKINBENCH_TRY(plan);
    auto number = streamOfSlot((*plan)->shape, slot);
    SKINBENCH_TRY(number);
    return download(*device_, bufferOf(**plan, *number, (*plan)->lastTurn),
                    streamBytes((*plan)->shape.streams[*number]));
}

std::vector<std::string> VulkanBackend::takeMessages() {
    MessageLog& log = device_->instance->messages;
    std::lock_guard lock(log.mutex);
    return std::exchange(log.texts, {});
}

}  // namespace

}  // namespace vulkan

Result<std::unique_ptr<Backend>> openVulkan(const BackendOptions& options) {
    auto device = vulkan::openDevice(options);
    SKINBENCH_TRY(device);
    auto cache = vulkan::openPipelineCache(**device);
    SKINBENCH_TRY(cache);
    return std::make_unique<vulkan::VulkanBackend>(std::move(*device), *cache);
}

}  // namespace skinbench
