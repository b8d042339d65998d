// The runner: every case is verified against the reference, then the cases that are right are timed in rounds, each
// round in a new shuffled order, so that a drift of the machine hits all alike. Rounds go on until the medians are
// known well enough.
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "common/cases/workload.h"
#include "common/core/stats.h"
#include "common/frame/backend.h"
#include "common/measure/culling.h"
#include "common/measure/verify.h"
#include "common/plans/plan.h"
#include "common/scene/skin_cpu.h"

namespace skinbench {

struct BenchSettings {
    uint32_t frames = 30;  // timed frames of a case, over the first `rounds` rounds
    uint32_t warmup = 3;   // untimed frames in every round, repeated until their mean holds still (3 s at most)
    uint32_t rounds = 3;
    double precision = 0;         // above 0: more such rounds, kMostRounds at the most, for each case whose interval of
                                  // the median has a larger relative half-width
    double timeLimit = 0;         // seconds after which no such round begins; 0: none
    bool limits = false;          // also time every case's limitCase
    bool selfTest = false;        // time every case twice, as if it were two
    bool freshPlacement = false;  // prepare every case anew for every round, so that its memory lies elsewhere
    uint32_t seed = 1;            // of the order within a round
    bool timed = true;            // false: verify only
    double tolerance = 2e-6;      // largest position error, relative to the posed bounding box's diagonal
    uint32_t imageThreshold = 2;  // a pixel differs when a channel differs by more
    double imageFraction = 0.001;  // that many pixels may differ between two routes
};

inline constexpr uint32_t kMostRounds = 20;

enum class CaseStatus { ok, skipped, failed };

struct Accuracy {
    SkinError error;  // against the decoded vertices, the larger of the two captured copies
    double tolerance = 0;
    SkinError codecError;                // against the vertices before encoding
    double imageDifference = 0;          // fraction of pixels that differ from the first image of the run
    std::string imageReference;          // id of the case that made that image
    std::optional<double> codecBound;    // what codecError.position may be at most; empty: the codec promises nothing
    std::optional<RowsError> rowsError;  // of palettes in half floats
};

// What the samples of a case say, in milliseconds per frame for all copies.
struct CaseFigures {
    Summary total;
    Interval interval;      // 95 %, of the median of `total`
    Interval wideInterval;  // the same at 99.5 %, for the pairs of BenchSettings::selfTest
    size_t outliers = 0;
    Drift drift;
    std::map<std::string, Summary> passes;
    Summary record, submit;
    std::optional<Summary> overlapped;
    std::optional<Interval> overlappedInterval;
    std::optional<Summary> batch;
    std::optional<Interval> batchInterval;
};

// Samples are milliseconds per frame for all copies. `total` is the sum of the passes, and for the variant `cpu` also
// of the skinning and the upload on the host (passes "skin" and "upload").
struct CaseResult {
    Case theCase;
    std::string id;
    bool isLimit = false;  // added by BenchSettings::limits
    bool isAgain = false;  // added by BenchSettings::selfTest: the second one of two equal cases
    std::string limitId;   // of the result that is this case's limit; empty: none
    CaseStatus status = CaseStatus::skipped;
    std::string reason;  // empty when ok
    std::vector<double> total;
    std::vector<size_t> roundSizes;   // of `total`, round after round
    std::vector<double> overlapped;   // frames of several passes in RunMode::overlap
    std::vector<double> batches;      // a frame of each batch in RunMode::batch, in runs that have Queues::async
    std::vector<size_t> batchRounds;  // of `batches`, round after round
    std::map<std::string, std::vector<double>> passes;
    std::vector<double> record;  // host time to record a frame, and to submit it
    std::vector<double> submit;
    std::optional<CaseFigures> figures;  // of the samples, made when a round of the case ends
    std::optional<Counters> counters;    // of one frame
    uint32_t meshlets = 0;
    std::optional<MemoryBytes> memory;
    std::optional<Accuracy> accuracy;
    std::optional<Culling> culling;  // of a frame of the first pose
};

// Of at least one sample.
CaseFigures figuresOf(const CaseResult& result);

// Whether the case has times that may be published.
bool isTimed(const CaseResult& result);

// Milliseconds of the device for all passes, of a case that is timed.
double medianOf(const CaseResult& result);

// Backends by API; an API that could not be opened has a null backend and the reason.
struct OpenBackend {
    Backend* backend = nullptr;
    std::string missing;
};
using Backends = std::map<Api, OpenBackend>;

using Checkpoint = std::function<void(const std::vector<CaseResult>&)>;

struct Progress {
    std::string what;                   // is being done; empty at the end
    double fraction = 0;                // of the work that is done; never falls
    std::optional<double> secondsLeft;  // empty until something like it was measured
};

struct BenchEvents {
    std::function<void(const Progress&)> progress;
    Checkpoint checkpoint;         // after every case
    std::function<void()> timing;  // right after the first warm-up, and right behind the last timed frame
    std::function<bool()> stop;    // true: end after the current case
};

// One result a case, in the order given, then those that settings add. Fails only when nothing can be measured at all
// (the scene cannot be prepared). What a case throws, such as a lack of memory, fails that case alone, and so do times
// that cannot be: zero, negative, or longer than the host waited for them.
Result<std::vector<CaseResult>> runBench(Workload& workload, const std::vector<Case>& cases, const Backends& backends,
                                         const BenchSettings& settings, const BenchEvents& events);

// One frame of one case, and what a check like that of a benchmarked one found.
struct Picture {
    Image image;
    std::string fault;                 // empty: it is right
    std::optional<Accuracy> accuracy;  // empty: the fault was found before
    std::optional<Culling> culling;    // of a case that culls
};
Result<Picture> renderPicture(Workload& workload, const Case& c, Backend& backend);

// Its image; an error where it is not right.
Result<Image> renderImage(Workload& workload, const Case& c, Backend& backend);

}  // namespace skinbench
