#include "common/report/answers.h"

#include <algorithm>
#include <format>

#include <nlohmann/json.hpp>

namespace skinbench {
using Json = nlohmann::ordered_json;

namespace {

using Found = std::vector<const CaseResult*>;

bool isRival(const CaseResult& result) {
    const Case& c = result.theCase;
    return isTimed(result) && !result.isLimit && !result.isAgain && c.variant->skins && c.route->api != Api::cpu &&
           !c.compute.halfRate && medianOf(result) > 0;
}

template <class Belongs>
const CaseResult* fastestOf(const Found& rivals, const Belongs& belongs) {
    const CaseResult* best = nullptr;
    for (const CaseResult* rival : rivals)
        if (belongs(*rival) && (!best || medianOf(*rival) < medianOf(*best))) best = rival;
    return best;
}

enum class Stage { vertex, compute, mesh, host };

Stage stageOf(const Case& c) {
    if (c.variant->skinsOnHost) return Stage::host;
    if (c.variant->skinsInCompute || c.variant->listsTriangles || c.variant->readsSkinned) return Stage::compute;
    return onMeshRoute(c) ? Stage::mesh : Stage::vertex;
}

// One work's rivals.
struct Contest {
    const RunContext* context;
    double noiseFloor = kDefaultNoiseFloor;
    Found rivals;

    bool software(const CaseResult& result) const {
        const auto device = std::ranges::find(context->devices, result.theCase.route->api, &DeviceCaps::api);
        return device != context->devices.end() && device->software;
    }
};

void ask(std::vector<Answer>& answers, const Contest& contest, const std::string& question, const std::string& on,
         const CaseResult* first, const CaseResult* second) {
    if (!first) return;
    Answer answer{workOf(first->theCase),
                  question,
                  on,
                  first->id,
                  second ? second->id : "",
                  medianOf(*first),
                  contest.software(*first) || (second && contest.software(*second)),
                  {}};
    if (second && second != first && medianOf(*second) > 0)
        answer.ratio = judgeRatio(medianOf(*first) / medianOf(*second), {second->total, second->roundSizes},
                                  {first->total, first->roundSizes}, contest.noiseFloor);
    answers.push_back(std::move(answer));
}

void askBoth(std::vector<Answer>& answers, const Contest& contest, const std::string& question, const std::string& on,
             const CaseResult* first, const CaseResult* second) {
    if (first && second && contest.software(*first) == contest.software(*second))
        ask(answers, contest, question, on, first, second);
}

void askWhoWins(std::vector<Answer>& answers, const Contest& contest, const std::vector<CaseResult>& results) {
    const bool hardware =
        std::ranges::any_of(contest.rivals, [&](const auto* rival) { return !contest.software(*rival); });
    auto counts = [&](const CaseResult& rival) { return !hardware || !contest.software(rival); };
    const CaseResult* const fastest = fastestOf(contest.rivals, counts);
    if (!fastest) return;
    ask(answers, contest, "fastest", "", fastest, baselineOf(*contest.context, results, *fastest));
    ask(answers, contest, "next", "",
        fastestOf(contest.rivals, [&](const CaseResult& rival) { return &rival != fastest && counts(rival); }),
        fastest);
}

void askStages(std::vector<Answer>& answers, const Contest& contest, Api api) {
    auto best = [&](Stage stage) {
        return fastestOf(contest.rivals, [&](const CaseResult& rival) {
            return rival.theCase.route->api == api && stageOf(rival.theCase) == stage;
        });
    };
    const CaseResult *vertex = best(Stage::vertex), *compute = best(Stage::compute), *mesh = best(Stage::mesh);
    const char* const name = namesOf(api).name;
    askBoth(answers, contest, "mesh against compute", name, mesh, compute);
    askBoth(answers, contest, "mesh against vertex", name, mesh, vertex);
    askBoth(answers, contest, "compute against vertex", name, compute, vertex);
}

// Of the routes of one dialect of mesh shaders, or of none.
const CaseResult* bestOn(const Contest& contest, Api api, MeshDialect dialect) {
    return fastestOf(contest.rivals, [&](const CaseResult& rival) {
        return rival.theCase.route->api == api && rival.theCase.route->dialect == dialect;
    });
}

void askRoutes(std::vector<Answer>& answers, const Contest& contest) {
    for (const Api api : {Api::vulkan, Api::opengl})
        askBoth(answers, contest, "EXT against NV", namesOf(api).name, bestOn(contest, api, MeshDialect::ext),
                bestOn(contest, api, MeshDialect::nv));
    for (const MeshDialect dialect : {MeshDialect::none, MeshDialect::ext, MeshDialect::nv}) {
        const CaseResult *vulkan = bestOn(contest, Api::vulkan, dialect),
                         *opengl = bestOn(contest, Api::opengl, dialect);
        if (!vulkan || !opengl) continue;
        askBoth(answers, contest, std::string(vulkan->theCase.route->name) + " against " + opengl->theCase.route->name,
                "", vulkan, opengl);
    }
}

}  // namespace

std::string workOf(const Case& c) {
    const Axis& raster = *findAxis("raster");
    std::string text = raster.get(c);
    for (const Axis& axis : axes())
        if (axis.changesWork && &axis != &raster && !axis.idPart(c).empty()) text += ", " + axis.idPart(c);
    return text;
}

const CaseResult* baselineOf(const RunContext& context, const std::vector<CaseResult>& results,
                             const CaseResult& result) {
    const Variant* const variant = findVariant(context.baseline);
    const CaseResult* best = nullptr;
    for (const CaseResult& other : results) {
        if (other.isLimit || other.isAgain || !isTimed(other)) continue;
        const Case &a = other.theCase, &b = result.theCase;
        const bool fits = variant ? a.variant == variant && a.route->api == b.route->api && sameWork(a, b)
                                  : other.id == context.baseline;
        if (fits && (!best || medianOf(other) < medianOf(*best))) best = &other;
    }
    return best;
}

std::vector<Answer> answersOf(const RunContext& context, const std::vector<CaseResult>& results) {
    const double floor = noiseFloor(results).value_or(kDefaultNoiseFloor);
    std::vector<Contest> works;
    for (const CaseResult& result : results) {
        if (!isRival(result)) continue;
        auto work = std::ranges::find_if(
            works, [&](const Contest& other) { return sameWork(other.rivals.front()->theCase, result.theCase); });
        if (work == works.end()) work = works.insert(works.end(), Contest{&context, floor, {}});
        work->rivals.push_back(&result);
    }
    std::vector<Answer> answers;
    for (const Contest& work : works) {
        askWhoWins(answers, work, results);
        for (const Api api : {Api::vulkan, Api::opengl}) askStages(answers, work, api);
        askRoutes(answers, work);
    }
    return answers;
}

Json answersJson(const RunContext& context, const std::vector<CaseResult>& results) {
    auto text = [](const std::string& value) { return value.empty() ? Json(nullptr) : Json(value); };
    Json rows = Json::array();
    for (const Answer& answer : answersOf(context, results)) {
        const auto& ratio = answer.ratio;
        rows.push_back(
            {{"work", answer.work},
             {"question", answer.question},
             {"on", text(answer.on)},
             {"first", answer.first},
             {"second", text(answer.second)},
             {"first_ms", answer.median},
             {"ratio", ratio ? Json(ratio->ratio) : Json(nullptr)},
             {"interval", ratio && ratio->interval ? Json{ratio->interval->low, ratio->interval->high} : Json(nullptr)},
             {"first_is", ratio ? Json(changeName(ratio->change)) : Json(nullptr)},
             {"software", answer.software}});
    }
    return rows;
}

}  // namespace skinbench
