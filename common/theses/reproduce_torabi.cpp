#include <algorithm>
#include <format>
#include <limits>

#include "common/plans/plan.h"
#include "common/report/report.h"
#include "common/theses/reproduce_parts.h"

namespace skinbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kNoTables = "The thesis' own figures are not available to us: only its abstract was at hand.";
constexpr const char* kAbstract = "The abstract, in words; the figures of the tables are not available to us.";

// --- methods ---------------------------------------------------------------------------------------------------

// A row of the tables of times and memory: which case it is, and which one it is compared with.
struct Method {
    std::string name;
    CaseKey key;
    Figure published = notAvailable();
    bool headline = false;
};

const CaseKey kAsDrawn = {{"codec", "uc"}, {"cull", "off"}};
const CaseKey kFiveAttributes = with(kAsDrawn, {{"variant", "vertex"}, {"vertex_fetch", "attributes"}});
const CaseKey kPulling = with(kAsDrawn, {{"variant", "vertex"}, {"vertex_fetch", "pull"}});
const CaseKey kNaive = with(kAsDrawn, {{"variant", "mesh"}, {"builder", "scan"}});
const CaseKey kTorabiCommon =
    with(kAsDrawn, {{"variant", "mesh-ci"}, {"builder", "scan"}, {"ci_grouping", "triangles"}, {"ci_key", "ordered"}});
const CaseKey kSlim = with(kTorabiCommon, {{"ci_vertices", "slim"}});
const CaseKey kFat = with(kTorabiCommon, {{"ci_vertices", "fat"}});

std::vector<Method> methods() {
    const PublishedTorabi& published = publishedTorabi();
    return {
        {"none, attributes", with(kAsDrawn, {{"variant", "none"}, {"vertex_fetch", "attributes"}})},
        {"none, meshlets", with(kAsDrawn, {{"variant", "none"}, {"builder", "scan"}})},
        {"vertex, five attributes", kFiveAttributes, wordFigure("baseline")},
        {"vertex, pulling", kPulling},
        {"compute", with(kAsDrawn, {{"variant", "compute"}}), wordFigure(published.computeAgainstVertex), true},
        {"mesh, naive meshlets", kNaive, wordFigure(published.meshAgainstVertex), true},
        {"mesh-ci, Torabi's groups", kSlim, wordFigure(published.meshCiAgainstVertex), true},
        {"mesh, our meshlets", with(kAsDrawn, {{"variant", "mesh"}, {"builder", "meshopt"}})},
        {"mesh-ci, our meshlets", with(kAsDrawn, {{"variant", "mesh-ci"}, {"ci_grouping", "meshlets"}}), notAvailable(),
         true},
    };
}

const ReproduceRun* orderedRun(const ReproduceScene& scene, bool cacheOrder) {
    for (const ReproduceRun& run : scene.runs)
        if (run.cacheOrder == cacheOrder) return &run;
    return nullptr;
}

// Calls `visit` with every case of the method that a scene's run has.
template <class Visit>
void eachCase(const ReproduceRun& run, const CaseKey& key, const Visit& visit) {
    for (const std::string& route : valuesOf(run.results, "route"))
        for (const std::string& raster : valuesOf(run.results, "raster"))
            if (const Json* c = findCase(run.results, with(key, {{"route", route}, {"raster", raster}})))
                visit(*c, route, raster);
}

Figure failedOr(const Json& c, const Figure& figure) { return c["status"] == "failed" ? wordFigure("failed") : figure; }

// --- meshlets --------------------------------------------------------------------------------------------------

std::string cutName(const MeshletRow& row) {
    if (!row.grouping) return "plain";
    if (*row.grouping == CiGrouping::meshlets) return "common influences, our meshlets";
    return std::string("common influences, triangles by ") + ciKeyName(*row.key);
}

const MeshletRow* plainCut(const Inspection& inspection, const MeshletRow& like) {
    for (const MeshletRow& row : inspection.meshlets)
        if (!row.grouping && row.geometry == like.geometry && row.cacheOrder == like.cacheOrder &&
            row.builder == like.builder)
            return &row;
    return nullptr;
}

ReproduceTable meshletTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{"tables-3.1-4.2-5.2-5.3", "Tables 3.1, 4.2, 5.2, 5.3: meshlets", kNoTables,
                         "How the scene is cut: `scan` cuts greedily in index order (listing A.1: naive); "
                         "common influences group triangles whose joints agree first (listing A.2, key `ordered`), or, "
                         "as we do by default, mark the meshlets of a plain cut whose joints fit one list. With and "
                         "without vertex-cache order (5.1.1). Geometry is welded (3.2)."};
    table.labels = {"scene", "order", "builder", "cut"};
    table.measure = "meshlets";
    table.details = {
        "over the plain cut", "vertices a meshlet", "triangles a meshlet", "tuples a meshlet", "common", "records"};
    for (const ReproduceScene& scene : scenes)
        for (const MeshletRow& row : scene.inspection.meshlets) {
            if (row.geometry != Geometry::welded) continue;
            const MeshletRow* plain = plainCut(scene.inspection, row);
            const bool ordered = row.key == CiKey::ordered;
            ReproduceRow cells{{sceneOf(scene), row.cacheOrder ? "cache" : "file", row.builder->name, cutName(row)},
                               figureOf(row.stats.meshlets, wholeNumber),
                               notAvailable(),
                               {},
                               {}};
            if (plain && plain->stats.meshlets)
                cells.details.push_back(
                    figureOf(static_cast<double>(row.stats.meshlets) / plain->stats.meshlets, threeDigits));
            else
                cells.details.push_back({});
            cells.details.push_back(figureOf(row.stats.meanVertices, oneDigit));
            cells.details.push_back(figureOf(row.stats.meanTriangles, oneDigit));
            cells.details.push_back(figureOf(row.stats.meanUniqueTuples, twoDigits));
            cells.details.push_back(
                row.grouping && row.stats.meshlets
                    ? figureOf(static_cast<double>(row.commonMeshlets) / row.stats.meshlets, percentage)
                    : Figure{});
            cells.details.push_back(row.grouping ? figureOf(row.records, wholeNumber) : Figure{});
            cells.headline = row.cacheOrder && row.builder == findBuilder("scan") && (!row.grouping || ordered);
            table.rows.push_back(std::move(cells));
        }
    return table;
}

// --- accuracy and memory ---------------------------------------------------------------------------------------

ReproduceTable accuracyTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{"table-4.1", "Table 4.1: accuracy", kNoTables,
                         "The largest distance of a skinned position from linear blend skinning in double precision on "
                         "the CPU, relative to the diagonal of the posed bounding box, over all vertices of the first "
                         "and the last copy, read back from the device. `none` is compared with the bind pose."};
    table.labels = {"scene", "route", "method"};
    table.measure = "largest position error";
    table.details = {"largest normal error, radians", "allowed position error"};
    for (const ReproduceScene& scene : scenes)
        for (const Method& method : methods()) {
            const ReproduceRun* run = orderedRun(scene, true);
            if (!run) continue;
            eachCase(*run, with(method.key, {{"scenario", "direct"}}),
                     [&](const Json& c, const std::string& route, const std::string& raster) {
                         const Json& accuracy = c["accuracy"];
                         if (accuracy.is_null() || raster != valuesOf(run->results, "raster").front()) return;
                         auto cell = [&](const char* key) {
                             return accuracy[key].is_number() ? figureOf(accuracy[key].get<double>(), scientific)
                                                              : wordFigure("not finite");
                         };
                         ReproduceRow row{{sceneOf(scene), route, method.name},
                                          cell("max_position_error"),
                                          notAvailable(),
                                          {},
                                          {cell("max_normal_error"), cell("tolerance")}};
                         table.rows.push_back(std::move(row));
                     });
        }
    if (table.rows.empty()) {
        table.notes.push_back("No case could be verified on the routes that were asked for.");
        return table;
    }
    auto errorOf = [](const ReproduceRow& row) {
        return row.ours.value ? row.ours.value->high : std::numeric_limits<double>::infinity();
    };
    ReproduceRow worst = std::ranges::max(table.rows, {}, errorOf);
    worst.labels = {"all", "all", std::format("the largest of {}", table.rows.size())};
    worst.headline = true;
    table.rows.push_back(std::move(worst));
    return table;
}

ReproduceTable memoryTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{"fig-4.4", "Fig. 4.4: memory", kNoTables,
                         "Bytes on the device for one copy of the character, by buffer. The route does not change "
                         "them; the first one that ran the method is taken."};
    const std::vector<const char*> buffers = {"vertex", "index",   "meshlet", "additional_meshlet",
                                              "tuple",  "palette", "skinned"};
    table.labels = {"scene", "method"};
    table.measure = "KiB a copy";
    table.details = {"over vertex"};
    table.bars = true;
    for (const char* buffer : buffers) table.details.push_back(std::string(buffer) + ", bytes");
    for (const ReproduceScene& scene : scenes) {
        const ReproduceRun* run = orderedRun(scene, true);
        if (!run) continue;
        std::optional<double> baseline;
        auto memoryOf = [&](const CaseKey& key) {
            const Json* found = nullptr;
            eachCase(*run, with(key, {{"scenario", "direct"}}), [&](const Json& c, auto&, auto&) {
                if (!found && c["memory_bytes"].is_object()) found = &c["memory_bytes"];
            });
            return found;
        };
        if (const Json* memory = memoryOf(kFiveAttributes)) baseline = (*memory)["total"].get<double>();
        for (const Method& method : methods()) {
            const Json* memory = memoryOf(method.key);
            if (!memory) continue;
            const double total = (*memory)["total"];
            ReproduceRow row{{sceneOf(scene), method.name},
                             figureOf(total / 1024, oneDigit),
                             notAvailable(),
                             {},
                             {baseline ? figureOf(total / *baseline, threeDigits) : Figure{}}};
            for (const char* buffer : buffers) row.details.push_back(figureOf((*memory)[buffer], wholeNumber));
            row.headline = method.headline;
            table.rows.push_back(std::move(row));
        }
    }
    return table;
}

// --- times -----------------------------------------------------------------------------------------------------

ReproduceTable timeTable(const std::vector<ReproduceScene>& scenes, const std::string& scenario) {
    const bool direct = scenario == "direct";
    ReproduceTable table{
        direct ? "figs-4.2-4.3" : "figs-4.2-4.3-prepass",
        direct ? "Figs. 4.2, 4.3: frame times, drawn once" : "Figs. 4.2, 4.3: frame times with a depth pre-pass (3.3)",
        kAbstract,
        "Median frame time over that of `vertex` with five attributes on the same API, in the same "
        "run. The thesis' figures show each method without and with skinning; `none` is the one "
        "without."};
    if (!direct)
        table.caption =
            "So too, drawn twice: the first pass lays down the depth and keeps the skinned vertices, the second draws "
            "them where the depth is equal. The baseline draws twice as well.";
    table.labels = {"scene", "route", "method", "raster"};
    table.measure = "time / vertex";
    table.details = {"interval", "median ms"};
    table.bars = true;
    for (const ReproduceScene& scene : scenes) {
        const ReproduceRun* run = orderedRun(scene, true);
        if (!run) continue;
        for (const Method& method : methods())
            eachCase(
                *run, with(method.key, {{"scenario", scenario}}),
                [&](const Json& c, const std::string& route, const std::string& raster) {
                    if (c["status"] == "skipped") return;
                    const CaseKey baseline = with(
                        kFiveAttributes, {{"scenario", scenario}, {"route", plainRoute(route)}, {"raster", raster}});
                    const Json* base = findCase(run->results, baseline);
                    ReproduceRow row{{sceneOf(scene), route, method.name, raster},
                                     failedOr(c, base ? timeRatio(run->results, c, *base) : wordFigure("no baseline")),
                                     direct ? method.published : notAvailable(),
                                     {},
                                     {base ? ratioInterval(c, *base) : Figure{},
                                      medianOf(c) ? figureOf(*medianOf(c), milliseconds) : Figure{}}};
                    row.headline = direct && method.headline;
                    table.rows.push_back(std::move(row));
                });
    }
    table.notes = timeNotes(runsOf(scenes));
    return table;
}

ReproduceTable perMeshletTable(const std::vector<ReproduceScene>& scenes) {
    const Range less = publishedTorabi().lessTimePerMeshlet;
    ReproduceTable table{
        "abstract", "Abstract: time per meshlet of common influences over naive meshlets",
        "The abstract says that common influences are faster at processing individual meshlets and names 15 to 22 %; "
        "the copy at hand breaks off there, so that it means less time, and how it was taken, is our reading.",
        "(frame time / meshlets) of `mesh-ci` with Torabi's groups over that of `mesh` with naive meshlets."};
    table.labels = {"scene", "route", "raster"};
    table.measure = "time a meshlet / naive";
    table.details = {"meshlets", "naive meshlets", "frame time / naive"};
    for (const ReproduceScene& scene : scenes) {
        const ReproduceRun* run = orderedRun(scene, true);
        if (!run) continue;
        eachCase(*run, with(kSlim, {{"scenario", "direct"}}),
                 [&](const Json& c, const std::string& route, const std::string& raster) {
                     const Json* naive = findCase(
                         run->results, with(kNaive, {{"scenario", "direct"}, {"route", route}, {"raster", raster}}));
                     if (!naive || !medianOf(c) || !medianOf(*naive) || *medianOf(*naive) <= 0) return;
                     const double own = c["meshlets"], other = (*naive)["meshlets"];
                     const double ratio = *medianOf(c) / own / (*medianOf(*naive) / other);
                     Figure ours = figureOf(ratio, threeDigits);
                     if (isSoftwareRoute(run->results, route)) ours = markedSoftware(ours);
                     const Range published = {1 - less.high, 1 - less.low};
                     ReproduceRow row{{sceneOf(scene), route, raster},
                                      ours,
                                      figureOf(published, twoDigits),
                                      ratioTo(ours, published),
                                      {figureOf(own, wholeNumber), figureOf(other, wholeNumber),
                                       timeRatio(run->results, c, *naive)}};
                     row.headline = true;
                     table.rows.push_back(std::move(row));
                 });
    }
    table.notes = timeNotes(runsOf(scenes));
    return table;
}

// --- chapter 5 -------------------------------------------------------------------------------------------------

struct Comparison {
    std::string name;
    CaseKey key, baseline;
};

ReproduceTable chapterTable(const std::string& id, const std::string& title, const std::string& caption) {
    ReproduceTable table{id, title,
                         "Which of figs. 5.1 to 5.4 and tables 5.1 and 5.4 shows this is not known to us, and none of "
                         "their figures is available.",
                         caption};
    table.labels = {"scene", "route", "comparison", "raster"};
    table.measure = "time ratio";
    table.details = {"interval", "memory ratio"};
    table.bars = true;
    return table;
}

void addComparison(ReproduceTable& table, const ReproduceScene& scene, const ReproduceRun& run,
                   const ReproduceRun& baseRun, const Comparison& what) {
    eachCase(run, with(what.key, {{"scenario", "direct"}}),
             [&](const Json& c, const std::string& route, const std::string& raster) {
                 const Json* base =
                     findCase(baseRun.results,
                              with(what.baseline, {{"scenario", "direct"}, {"route", route}, {"raster", raster}}));
                 if (!base || c["status"] == "skipped") return;
                 Figure memory;
                 if (c["memory_bytes"].is_object() && (*base)["memory_bytes"].is_object())
                     memory = figureOf(
                         c["memory_bytes"]["total"].get<double>() / (*base)["memory_bytes"]["total"].get<double>(),
                         threeDigits);
                 table.rows.push_back({{sceneOf(scene), route, what.name, raster},
                                       failedOr(c, timeRatio(run.results, c, *base)),
                                       notAvailable(),
                                       {},
                                       {ratioInterval(c, *base), memory},
                                       table.id != "section-5.1.1"});
             });
}

std::vector<ReproduceTable> chapterFive(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable order = chapterTable("section-5.1.1", "Section 5.1.1: vertex-cache order",
                                        "Median frame time in the file's order of triangles over that in cache order. "
                                        "The two orders are two runs of one process, one after the other.");
    ReproduceTable cull = chapterTable(
        "section-5.1.3", "Section 5.1.3: back-face culling in the mesh stage",
        "Median frame time with culling over that without: Torabi's form, the determinant of (x, y, w) after all "
        "outputs, and ours, which tests first and writes only the triangles that are left.");
    ReproduceTable fat = chapterTable("section-5.1.4", "Section 5.1.4: slim and fat vertices",
                                      "Median frame time with joint ids kept in every vertex (fat, nothing reads them) "
                                      "over that without (slim).");
    for (const ReproduceScene& scene : scenes) {
        const ReproduceRun *ordered = orderedRun(scene, true), *unordered = orderedRun(scene, false);
        if (!ordered) continue;
        if (unordered)
            for (const Comparison& what : {Comparison{"vertex, file / cache order", kFiveAttributes, kFiveAttributes},
                                           Comparison{"mesh naive, file / cache order", kNaive, kNaive},
                                           Comparison{"mesh-ci Torabi, file / cache order", kSlim, kSlim}})
                addComparison(order, scene, *unordered, *ordered, what);
        for (const char* form : {"torabi", "compact"})
            addComparison(cull, scene, *ordered, *ordered,
                          {std::string("mesh naive, cull ") + form + " / off", with(kNaive, {{"cull", form}}), kNaive});
        addComparison(fat, scene, *ordered, *ordered, {"mesh-ci Torabi, fat / slim", kFat, kSlim});
    }
    std::vector<ReproduceTable> tables = {std::move(order), std::move(cull), std::move(fat)};
    for (ReproduceTable& table : tables) table.notes = timeNotes(runsOf(scenes));
    return tables;
}

// --- slips -----------------------------------------------------------------------------------------------------

// The determinant of the rows (x, y, w) of three vertices.
template <class T>
T determinant(const std::array<std::array<T, 3>, 3>& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Slip cullingSlip() {
    // A front face of about 0.05 by 0.05 pixels at 1920x1080.
    const std::array<std::array<float, 3>, 3> rows = {
        {{4.1f, 2.9f, 5.3f}, {4.1003f, 2.9f, 5.3f}, {4.1f, 2.9005f, 5.3f}}};
    std::array<std::array<double, 3>, 3> exact;
    for (size_t i = 0; i < 3; ++i)
        for (size_t k = 0; k < 3; ++k) exact[i][k] = rows[i][k];
    return {
        "5.1.3, culling", "a triangle is dropped by the sign of the determinant of (x, y, w)",
        std::format("The products that cancel in it are near {:.0f}, so single precision leaves an error near {:.0e}. "
                    "Rows (4.1, 2.9, 5.3), (4.1003, 2.9, 5.3), (4.1, 2.9005, 5.3), a front face: {:.2e} in double, "
                    "{:.2e} in single precision, so it is dropped.",
                    exact[0][0] * exact[1][1] * exact[2][2], exact[0][0] * exact[1][1] * exact[2][2] * 0x1p-24,
                    determinant(exact), determinant(rows)),
        "`--cull compact`: edge differences of x/w and y/w, kept whenever the rasteriser could still see it"};
}

Slip groupingSlip(const std::vector<ReproduceScene>& scenes) {
    std::string arithmetic;
    for (const ReproduceScene& scene : scenes) {
        std::map<CiKey, const MeshletRow*> byKey;
        const MeshletRow* plain = nullptr;
        for (const MeshletRow& row : scene.inspection.meshlets) {
            if (row.geometry != Geometry::welded || !row.cacheOrder || row.builder != findBuilder("scan")) continue;
            if (!row.grouping) plain = &row;
            if (row.key) byKey[*row.key] = &row;
        }
        if (!plain || !plain->stats.meshlets) continue;
        arithmetic += (arithmetic.empty() ? "" : " ") + sceneOf(scene) + ":";
        for (const auto& [key, row] : byKey)
            arithmetic += std::format(" {} {}/{} = {:+.1f} % meshlets;", ciKeyName(key), row->stats.meshlets,
                                      plain->stats.meshlets, 100.0 * row->stats.meshlets / plain->stats.meshlets - 100);
    }
    return {"listing A.2, grouping", "triangles go together when their vertices name the same joints in the same order",
            arithmetic.empty() ? "no scene was cut" : arithmetic,
            "the set of joints, or what fits one list (`--ci-key set`, `fit`): the order of influences changes nothing "
            "in the picture"};
}

Slip baselineSlip(const std::vector<ReproduceScene>& scenes) {
    std::string arithmetic;
    for (const ReproduceScene& scene : scenes) {
        const ReproduceRun* run = orderedRun(scene, true);
        if (!run) continue;
        eachCase(*run, with(kFiveAttributes, {{"scenario", "direct"}}),
                 [&](const Json& c, const std::string& route, const std::string& raster) {
                     const Json* pull = findCase(
                         run->results, with(kPulling, {{"scenario", "direct"}, {"route", route}, {"raster", raster}}));
                     if (!pull || !medianOf(c) || !medianOf(*pull)) return;
                     arithmetic += std::format("{}{}, {}, {}: five attributes / pulling {}/{} = {}.",
                                               arithmetic.empty() ? "" : " ", sceneOf(scene), route, raster,
                                               milliseconds(*medianOf(c)), milliseconds(*medianOf(*pull)),
                                               timeRatio(run->results, c, *pull).text);
                 });
    }
    return {"4, baseline", "the vertex stage is fed by five attributes",
            arithmetic.empty() ? "no vertex stage was timed both ways" : arithmetic,
            "both baselines: attributes, and pulling from storage buffers (`--vertex-fetch`)"};
}

}  // namespace

Reproduction reproduceTorabi(const std::vector<ReproduceScene>& scenes) {
    Reproduction all{"torabi",
                     "Skeletal Animation Optimization Using Mesh Shaders",
                     "Peyman Torabi, master's thesis, Blekinge Institute of Technology, 2019",
                     {meshletTable(scenes), accuracyTable(scenes), timeTable(scenes, "direct"),
                      timeTable(scenes, "prepass"), memoryTable(scenes), perMeshletTable(scenes)},
                     {cullingSlip(), groupingSlip(scenes), baselineSlip(scenes)},
                     {"Tables 3.1, 4.1, 4.2, 5.1 to 5.4 and figs. 4.2 to 4.4, 5.1 to 5.4: their figures are not "
                      "available, because only the abstract of the thesis was at hand.",
                      "Tables 5.1 and 5.4 and figs. 5.1 to 5.4: which section each belongs to is not known either; the "
                      "three comparisons of chapter 5 that are known are rebuilt by section (5.1.1, 5.1.3, 5.1.4)."}};
    for (ReproduceTable& table : chapterFive(scenes)) all.tables.push_back(std::move(table));
    return all;
}

}  // namespace skinbench
