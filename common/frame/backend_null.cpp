#include <cstring>
#include <map>

#include "common/frame/backend.h"

namespace skinbench {
namespace {

class NullBackend final : public Backend {
public:
    explicit NullBackend(const DeviceCaps& caps) : caps_(caps) {}

    const DeviceCaps& caps() const override { return caps_; }

    Result<PlanId> prepare(const FramePlan& plan) override {
        plans_[next_] = plan;
        return next_++;
    }

    Result<std::vector<Timing>> run(PlanId plan, std::span<const FrameInput> frames, RunMode mode) override {
        const FramePlan* kept = find(plan);
        if (!kept) return deviceError("null backend: no such plan");
        for (const FrameInput& frame : frames)
            if (frame.palette.size() != kept->paletteBytes)
                return deviceError("null backend: a palette has not the plan's size");
        Timing timing;
        if (mode == RunMode::counted)
            timing.counters.emplace();
        else
            timing.passes.assign(mode == RunMode::overlap ? 1 : kept->passes.size(), 0.0);
        return std::vector<Timing>(frames.size(), timing);
    }

    Result<Image> readImage(PlanId plan) override {
        const FramePlan* kept = find(plan);
        if (!kept) return deviceError("null backend: no such plan");
        return Image{kept->width, kept->height, std::vector<uint8_t>(size_t{kept->width} * kept->height * 4, 0)};
    }

    Result<std::vector<std::byte>> readStream(PlanId plan, uint32_t slot) override {
        const FramePlan* kept = find(plan);
        if (!kept) return deviceError("null backend: no such plan");
        for (const Stream& stream : kept->streams)
            if (stream.slot == slot) return content(stream);
        return deviceError("null backend: the plan has no stream in slot " + std::to_string(slot));
    }

    void release(PlanId plan) override { plans_.erase(plan); }

    std::vector<std::string> takeMessages() override { return {}; }

private:
    const FramePlan* find(PlanId plan) const {
        auto kept = plans_.find(plan);
        return kept == plans_.end() ? nullptr : &kept->second;
    }

    static std::vector<std::byte> content(const Stream& stream) {
        if (!stream.bytes) return std::vector<std::byte>(stream.gpuBytes);
        std::vector<std::byte> all;
        for (uint32_t replica = 0; replica < stream.replicas; ++replica) {
            const size_t start = all.size();
            all.insert(all.end(), stream.bytes->begin(), stream.bytes->end());
            for (size_t at = start; stream.replicaAdd && at + 4 <= all.size(); at += 4) {
                uint32_t word;
                std::memcpy(&word, &all[at], 4);
                word += stream.replicaAdd * replica;
                std::memcpy(&all[at], &word, 4);
            }
        }
        return all;
    }

    DeviceCaps caps_;
    std::map<PlanId, FramePlan> plans_;
    PlanId next_ = 1;
};

}  // namespace

std::unique_ptr<Backend> openNull(const DeviceCaps& caps) { return std::make_unique<NullBackend>(caps); }

}  // namespace skinbench
