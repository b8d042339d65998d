#include <map>

#include "common/frame/check_plan.h"

namespace skinbench {
namespace {

class NullBackend final : public Backend {
public:
    explicit NullBackend(const DeviceCaps& caps) : caps_(caps) {}

    const DeviceCaps& caps() const override { return caps_; }

    Result<PlanId> prepare(const FramePlan& plan) override {
        SKINBENCH_TRY(checkPlan(plan, caps_));
        plans_[next_] = plan;
        return next_++;
    }

    Result<std::vector<Timing>> run(PlanId id, std::span<const FrameInput> frames, RunMode mode) override {
        auto plan = plans_.find(id);
        if (plan == plans_.end()) return unknownPlan(id);
        SKINBENCH_TRY(checkFrames(plan->second, frames));
        const bool counted = mode == RunMode::counted;
        Timing timing;
        if (counted && caps_.pipelineStatistics) timing.counters.emplace();
        timing.passes.resize(timesOfFrame(plan->second, mode));
        const bool runs = !frames.empty() && (!counted || caps_.pipelineStatistics);
        if (runs && drawsImage(plan->second)) lastOfSize_[sizeOf(plan->second)] = id;
        return std::vector<Timing>(frames.size(), timing);
    }

    Result<void> begin(PlanId id, const FrameInput& frame) override {
        auto plan = plans_.find(id);
        if (plan == plans_.end()) return unknownPlan(id);
        SKINBENCH_TRY(checkBegin(plan->second, frame, begun_[id]));
        ++begun_[id];
        lastOfSize_[sizeOf(plan->second)] = id;
        return {};
    }

    Result<FinishedFrame> finish(PlanId id) override {
        auto plan = plans_.find(id);
        if (plan == plans_.end()) return unknownPlan(id);
        SKINBENCH_TRY(checkFinish(plan->second, begun_[id]));
        --begun_[id];
        FinishedFrame finished{{}, emptyImage(plan->second)};
        finished.timing.passes.resize(plan->second.passes.size());
        return finished;
    }

    Result<Image> readImage(PlanId id) override {
        auto plan = plans_.find(id);
        if (plan == plans_.end()) return unknownPlan(id);
        SKINBENCH_TRY(checkImage(plan->second, id, lastOfSize_[sizeOf(plan->second)]));
        return emptyImage(plan->second);
    }

    Result<std::vector<std::byte>> readStream(PlanId id, uint32_t slot) override {
        auto plan = plans_.find(id);
        if (plan == plans_.end()) return unknownPlan(id);
        auto number = streamOfSlot(plan->second, slot);
        SKINBENCH_TRY(number);
        const Stream& stream = plan->second.streams[*number];
        std::vector<std::byte> bytes(streamBytes(stream));
        if (stream.bytes) copyReplicas(stream, 0, bytes);
        return bytes;
    }

    void release(PlanId id) override { plans_.erase(id); }

    std::vector<std::string> takeMessages() override { return {}; }

private:
    using Size = std::pair<uint32_t, uint32_t>;
    static Size sizeOf(const FramePlan& plan) { return {plan.width, plan.height}; }
    static Image emptyImage(const FramePlan& plan) {
        return {plan.width, plan.height, std::vector<uint8_t>(size_t{plan.width} * plan.height * 4)};
    }

    DeviceCaps caps_;
    std::map<PlanId, FramePlan> plans_;
    std::map<Size, PlanId> lastOfSize_;
    std::map<PlanId, size_t> begun_;
    PlanId next_ = 1;
};

}  // namespace

std::unique_ptr<Backend> openNull(const DeviceCaps& caps) { return std::make_unique<NullBackend>(caps); }

}  // namespace skinbench
