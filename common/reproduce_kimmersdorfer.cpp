#include <algorithm>
#include <bit>
#include <cmath>
#include <format>
#include <numeric>

#include "common/reproduce_parts.h"

namespace skinbench {

using Json = nlohmann::ordered_json;

Result<RoundedErrors> roundedErrors(const Scene& stored) {
    auto scene = prepareScene(stored, {4, Geometry::unwelded, false});
    if (!scene) return std::unexpected(scene.error());
    RoundedErrors errors;
    errors.stats = sceneStats(*scene);
    for (int bits : {8, 10, 16, 21}) {
        errors.positionFloor[bits] = positionError(scene->mesh, bits, Rounding::floor);
        errors.positionNearest[bits] = positionError(scene->mesh, bits, Rounding::nearest);
    }
    for (const auto& [rounding, into] :
         {std::pair{Rounding::floor, &errors.normalFloor}, {Rounding::nearest, &errors.normalNearest}})
        *into = {euclideanRawError(scene->mesh, rounding), normalError(scene->mesh, NormalFormat::spherical, rounding),
                 normalError(scene->mesh, NormalFormat::octahedral, rounding)};
    return errors;
}

namespace {

constexpr const char* kNotes = "Figures from its text; none of its plots was at hand.";

// In the thesis' order.
const std::vector<std::string> kCodecs = {"uc", "oss", "pc", "pdc8", "pdc16", "pdc32", "dpdc16"};

Figure publishedOr(const std::optional<Range>& range, FormatNumber format) {
    return range ? figureOf(*range, format) : notAvailable();
}

template <class Key, class Value>
std::optional<Value> lookUp(const std::map<Key, Value>& table, const Key& key) {
    const auto row = table.find(key);
    return row == table.end() ? std::nullopt : std::optional(row->second);
}

// --- errors of attributes --------------------------------------------------------------------------------------

ReproduceTable positionTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{
        "table-2.1", "Table 2.1: error of quantised positions", kNotes,
        "Mean distance before and after coding in the unit cube (equation 2.4), rounding down in single "
        "precision as the thesis does; the published range is over its scenes. `nearest` is what our "
        "codecs store: the same bits, half the error. One vertex a triangle corner."};
    table.labels = {"scene", "bits"};
    table.measure = "mean error";
    table.details = {"largest error", "nearest: mean error", "nearest: largest error"};
    for (const ReproduceScene& scene : scenes) {
        if (!scene.errors) continue;
        for (const auto& [bits, error] : scene.errors->positionFloor) {
            const auto published = lookUp(publishedKimmersdorfer().positionErrors, bits);
            const ErrorFigure& nearest = scene.errors->positionNearest.at(bits);
            table.rows.push_back({{sceneOf(scene), std::to_string(bits)},
                                  figureOf(error.mean, scientific),
                                  publishedOr(published, scientific),
                                  ratioTo(error.mean, published),
                                  {figureOf(error.max, scientific), figureOf(nearest.mean, scientific),
                                   figureOf(nearest.max, scientific)},
                                  true});
        }
    }
    return table;
}

ReproduceTable normalTable(const std::vector<ReproduceScene>& scenes) {
    const PublishedKimmersdorfer& published = publishedKimmersdorfer();
    ReproduceTable table{
        "table-2.2", "Table 2.2: error of normals in 32 bits", kNotes,
        "Mean distance of the unit normals before and after coding, rounded to nearest as the table was "
        "made; the Euclidean one before renormalisation. `floor` is what the thesis' program stores: "
        "twice the error where directions are spread evenly."};
    table.labels = {"scene", "method"};
    table.measure = "mean error";
    table.details = {"largest error", "floor: mean error", "floor: largest error"};
    using Normals = RoundedErrors::Normals;
    struct Format {
        const char* name;
        ErrorFigure Normals::*error;
        Range published;
    };
    const Format formats[] = {{"Euclidean, 3 x 10 bits", &Normals::euclidean, published.euclidean},
                              {"spherical, 2 x 16 bits", &Normals::spherical, published.spherical},
                              {"octahedral, 2 x 16 bits", &Normals::octahedral, published.octahedral}};
    for (const ReproduceScene& scene : scenes) {
        if (!scene.errors) continue;
        for (const Format& format : formats) {
            const ErrorFigure &nearest = scene.errors->normalNearest.*format.error,
                              &floor = scene.errors->normalFloor.*format.error;
            table.rows.push_back(
                {{sceneOf(scene), format.name},
                 figureOf(nearest.mean, scientific),
                 figureOf(format.published, scientific),
                 ratioTo(nearest.mean, format.published),
                 {figureOf(nearest.max, scientific), figureOf(floor.mean, scientific), figureOf(floor.max, scientific)},
                 true});
        }
    }
    return table;
}

// --- meshlets --------------------------------------------------------------------------------------------------

const CodecRow* codecRow(const ReproduceScene& scene, Geometry geometry, const Builder* builder,
                         const std::string& codec) {
    for (const CodecRow& row : scene.inspection.codecs)
        if (row.geometry == geometry && row.builder == builder && row.codec->name == codec) return &row;
    return nullptr;
}

const MeshletRow* plainCut(const ReproduceScene& scene, Geometry geometry, const Builder* builder) {
    for (const MeshletRow& row : scene.inspection.meshlets)
        if (!row.grouping && row.cacheOrder && row.geometry == geometry && row.builder == builder) return &row;
    return nullptr;
}

uint64_t layoutBytes(const CodecRow& row, const char* layout) {
    return row.descriptorBytes.at(layout) + row.dataBytes.at(layout);
}

ReproduceTable meshletTable(const std::vector<ReproduceScene>& scenes) {
    const PublishedKimmersdorfer& published = publishedKimmersdorfer();
    ReproduceTable table{"tables-3.1-3.2", "Tables 3.1, 3.2: meshlets per builder and layout", kNotes,
                         "At most 64 vertices and 124 triangles a meshlet. `scan` is its AVK-Default, `meshopt` "
                         "meshoptimizer. `fixed` takes 640 bytes a meshlet, `redirect` a descriptor and one stream of "
                         "indices."};
    table.labels = {"scene", "geometry", "builder"};
    table.measure = "meshlets";
    table.details = {"redirect, KiB", "fixed, KiB", "redirect saves", "index buffer, KiB", "redirect / index buffer"};
    for (const ReproduceScene& scene : scenes)
        for (Geometry geometry : {Geometry::unwelded, Geometry::welded})
            for (const Builder& builder : builders()) {
                const MeshletRow* cut = plainCut(scene, geometry, &builder);
                const CodecRow* row = codecRow(scene, geometry, &builder, "uc");
                if (!cut || !row || !row->reason.empty() || !row->indexBytes) continue;
                const double redirect = static_cast<double>(layoutBytes(*row, "redirect")),
                             fixed = static_cast<double>(layoutBytes(*row, "fixed")),
                             index = static_cast<double>(*row->indexBytes);
                table.rows.push_back({{sceneOf(scene), geometryName(geometry), builder.name},
                                      figureOf(cut->stats.meshlets, wholeNumber),
                                      wordFigure("other scene"),
                                      {},
                                      {figureOf(redirect / 1024, oneDigit), figureOf(fixed / 1024, oneDigit),
                                       figureOf(1 - redirect / fixed, percentage), figureOf(index / 1024, oneDigit),
                                       figureOf(redirect / index, threeDigits)},
                                      geometry == Geometry::unwelded});
            }
    ReproduceRow playground{{"Playground (Kimmersdorfer)", "not known", "not known"},
                            wordFigure("not at hand"),
                            figureOf(published.playgroundMeshlets, wholeNumber),
                            {},
                            std::vector<Figure>(table.details.size())};
    table.rows.push_back(std::move(playground));
    return table;
}

// --- scenes ----------------------------------------------------------------------------------------------------

template <class T>
Figure optionalFigure(const std::optional<T>& value, FormatNumber format) {
    return value ? figureOf(*value, format) : notAvailable();
}

ReproduceTable sceneTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{
        "table-4.1", "Table 4.1: scenes", kNotes,
        "One row a scene. The thesis measured without welding; its scenes are not at hand. Vertex counts "
        "marked ~ follow from the printed sizes, 64 bytes a vertex."};
    table.labels = {"scene", "geometry"};
    table.measure = "meshlets";
    table.details = {"vertices", "triangles", "joints", "tuples", "influences a vertex"};
    for (const ReproduceScene& scene : scenes)
        for (Geometry geometry : {Geometry::unwelded, Geometry::welded}) {
            const MeshletRow* cut = plainCut(scene, geometry, findBuilder("meshopt"));
            if (!cut || !scene.errors) continue;
            const SceneStats& stats = geometry == Geometry::welded ? scene.inspection.stats : scene.errors->stats;
            table.rows.push_back({{sceneOf(scene), geometryName(geometry)},
                                  figureOf(cut->stats.meshlets, wholeNumber),
                                  wordFigure("other scene"),
                                  {},
                                  {figureOf(stats.vertices, wholeNumber), figureOf(stats.triangles, wholeNumber),
                                   figureOf(stats.joints, wholeNumber), figureOf(stats.uniqueTuples, wholeNumber),
                                   figureOf(stats.meanInfluences, twoDigits)},
                                  geometry == Geometry::unwelded});
        }
    for (const PublishedScene& scene : publishedKimmersdorfer().scenes) {
        Figure vertices = optionalFigure(scene.vertices, wholeNumber);
        if (scene.derived) vertices.text = "~ " + vertices.text;
        table.rows.push_back(
            {{std::string(scene.name) + " (Kimmersdorfer)", "unwelded"},
             wordFigure("not at hand"),
             optionalFigure(scene.meshlets, wholeNumber),
             {},
             {vertices, optionalFigure(scene.triangles, wholeNumber), optionalFigure(scene.joints, wholeNumber),
              optionalFigure(scene.tuples, wholeNumber), optionalFigure(scene.influences, twoDigits)}});
    }
    return table;
}

// --- sizes -----------------------------------------------------------------------------------------------------

// Calls `visit` with every codec of the thesis on every scene, unwelded first.
template <class Visit>
void eachCodec(const std::vector<ReproduceScene>& scenes, const Visit& visit) {
    for (const ReproduceScene& scene : scenes)
        for (Geometry geometry : {Geometry::unwelded, Geometry::welded})
            for (const std::string& codec : kCodecs) {
                const CodecRow* row = codecRow(scene, geometry, findBuilder("meshopt"), codec);
                const CodecRow* raw = codecRow(scene, geometry, findBuilder("meshopt"), "uc");
                if (row && raw) visit(scene, geometry, *row, *raw);
            }
}

ReproduceTable bufferTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{
        "table-4.2", "Table 4.2: buffers", kNotes,
        "Bytes of the vertex buffer over the vertices before splitting; a vertex that meshlets with "
        "other differences share is stored again and counts in full. The thesis' sizes in bytes are not "
        "available; that its vertex buffers have 64 and 18 bytes a vertex is."};
    table.labels = {"scene", "geometry", "codec"};
    table.measure = "vertex buffer, bytes a vertex";
    table.details = {"vertex, KiB", "meshlets, KiB", "AMB, KiB", "TIB, KiB", "sum, KiB", "sum / uc", "copies made"};
    table.bars = true;
    const PublishedKimmersdorfer& published = publishedKimmersdorfer();
    auto kib = [](uint64_t bytes) { return figureOf(static_cast<double>(bytes) / 1024, oneDigit); };
    auto sum = [](const CodecRow& row) {
        return row.vertexBytes + layoutBytes(row, "redirect") + row.meshletExtraBytes.value_or(0) +
               row.tupleBytes.value_or(0);
    };
    eachCodec(scenes, [&](const ReproduceScene& scene, Geometry geometry, const CodecRow& row, const CodecRow& raw) {
        const std::vector<std::string> labels = {sceneOf(scene), geometryName(geometry), row.codec->name};
        if (!row.reason.empty()) {
            table.rows.push_back({labels, wordFigure("cannot encode"), notAvailable(), {}, {wordFigure(row.reason)}});
            return;
        }
        const double perVertex = static_cast<double>(row.vertexBytes) / raw.vertices;
        std::optional<Range> fixed;
        if (const auto bytes = lookUp(published.bytesPerVertex, std::string(row.codec->name)))
            fixed = Range{static_cast<double>(*bytes), static_cast<double>(*bytes)};
        if (geometry == Geometry::welded) fixed.reset();
        table.rows.push_back({labels,
                              figureOf(perVertex, twoDigits),
                              publishedOr(fixed, wholeNumber),
                              ratioTo(perVertex, fixed),
                              {kib(row.vertexBytes), kib(layoutBytes(row, "redirect")),
                               row.meshletExtraBytes ? kib(*row.meshletExtraBytes) : Figure{},
                               row.tupleBytes ? kib(*row.tupleBytes) : Figure{}, kib(sum(row)),
                               figureOf(static_cast<double>(sum(row)) / static_cast<double>(sum(raw)), threeDigits),
                               figureOf(row.vertices - raw.vertices, wholeNumber)}});
    });
    return table;
}

std::vector<double> publishedBlend(const std::string& codec) {
    std::vector<double> bytes;
    for (const PublishedScene& scene : publishedKimmersdorfer().scenes)
        if (const auto value = lookUp(scene.blendBytes, codec)) bytes.push_back(*value);
    return bytes;
}

double meanOf(const std::vector<double>& values) {
    return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

ReproduceTable blendTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{"table-4.3", "Table 4.3: bytes a vertex for blend attributes", kNotes,
                         "Joints and weights with AMB and TIB, over the vertices before splitting. Published is the "
                         "average over five scenes, none of them welded; the range is over these scenes. Welded, a "
                         "vertex that is split costs its 14 base bytes again, which the thesis could not see."};
    table.labels = {"scene", "geometry", "codec"};
    table.measure = "bytes a vertex";
    table.details = {"published range", "mean weight error", "largest weight error"};
    table.bars = true;
    eachCodec(scenes, [&](const ReproduceScene& scene, Geometry geometry, const CodecRow& row, const CodecRow&) {
        if (!row.reason.empty()) return;
        const std::string codec = row.codec->name;
        std::optional<Range> average;
        Figure range;
        if (const auto value = lookUp(publishedKimmersdorfer().blendAverages, codec);
            value && geometry == Geometry::unwelded) {
            average = Range{*value, *value};
            const std::vector<double> all = publishedBlend(codec);
            range = figureOf(Range{std::ranges::min(all), std::ranges::max(all)}, twoDigits);
        }
        table.rows.push_back(
            {{sceneOf(scene), geometryName(geometry), codec},
             figureOf(row.blendBytesPerVertex, twoDigits),
             publishedOr(average, twoDigits),
             ratioTo(row.blendBytesPerVertex, average),
             {range, figureOf(row.errors.weight.mean, scientific), figureOf(row.errors.weight.max, scientific)},
             average.has_value()});
    });
    return table;
}

ReproduceTable printedBlendTable() {
    ReproduceTable table{"table-4.3-printed", "Table 4.3 as printed, and its averages recomputed", kNotes,
                         "The mean of the printed scenes against the printed average; differences of 0.01 come from "
                         "rounding."};
    table.labels = {"codec"};
    table.measure = "mean of the scenes";
    for (const PublishedScene& scene : publishedKimmersdorfer().scenes)
        if (!scene.blendBytes.empty()) table.details.push_back(scene.name);
    for (const std::string& codec : kCodecs) {
        const std::vector<double> bytes = publishedBlend(codec);
        const auto average = lookUp(publishedKimmersdorfer().blendAverages, codec);
        if (bytes.empty() || !average) continue;
        ReproduceRow row{{codec},
                         figureOf(meanOf(bytes), threeDigits),
                         figureOf(*average, twoDigits),
                         ratioTo(meanOf(bytes), Range{*average, *average}),
                         {}};
        for (double value : bytes) row.details.push_back(figureOf(value, twoDigits));
        table.rows.push_back(std::move(row));
    }
    return table;
}

// --- times -----------------------------------------------------------------------------------------------------

ReproduceTable timeTable(const std::vector<ReproduceScene>& scenes) {
    ReproduceTable table{"table-4.4", "Table 4.4: frame times", kNotes,
                         "Median frame time over that of `pc` on the same route, variant, layout and geometry, in the "
                         "same run. The published ranges are over the thesis' scenes and its GPU, in mesh shaders."};
    table.labels = {"scene", "geometry", "route", "case", "raster"};
    table.measure = "time / pc";
    table.details = {"interval", "median ms"};
    table.bars = true;
    for (const ReproduceScene& scene : scenes)
        for (const ReproduceRun& run : scene.runs)
            for (const Json& which : run.results["cases"]) {
                if (which["status"] == "skipped") continue;
                auto word = [&](const char* key) {
                    return which[key].is_string() ? which[key].get<std::string>() : "";
                };
                CaseKey baseline = {{"codec", "pc"}};
                for (const char* key : {"route", "variant", "builder", "layout", "raster"}) baseline[key] = word(key);
                const Json* base = findCase(run.results, baseline);
                const bool mesh = !word("builder").empty();
                const auto published = mesh && run.geometry == Geometry::unwelded
                                           ? lookUp(publishedKimmersdorfer().timesOverPc, word("codec"))
                                           : std::nullopt;
                Figure ours = base ? timeRatio(run.results, which, *base) : wordFigure("no baseline");
                if (word("status") == "failed") ours = wordFigure("failed");
                table.rows.push_back(
                    {{sceneOf(scene), geometryName(run.geometry), word("route"),
                      word("variant") + " " + word("codec") + (mesh ? " " + word("layout") : ""), word("raster")},
                     ours,
                     word("codec") == "pc" ? wordFigure("baseline") : publishedOr(published, threeDigits),
                     ratioTo(ours, published),
                     {base ? ratioInterval(which, *base) : Figure{},
                      medianOf(which) ? figureOf(*medianOf(which), milliseconds) : Figure{}},
                     published.has_value()});
            }
    table.notes = timeNotes(runsOf(scenes));
    return table;
}

// --- slips -----------------------------------------------------------------------------------------------------

std::vector<Slip> percentageSlips() {
    const PublishedKimmersdorfer& k = publishedKimmersdorfer();
    const double base = k.baseBytes, pc = k.blendAverages.at("pc"), pdc8 = k.blendAverages.at("pdc8"),
                 pdc32 = k.blendAverages.at("pdc32");
    auto shares = [&](double blend) {
        return std::format("{0}/{1} = {2:.1f} %, but {0}/({1} + {0}) = {3:.1f} %", blend, base, 100 * blend / base,
                           100 * blend / (base + blend));
    };
    const PublishedScene& playground = k.scenes.front();
    const double bestPdc8 = playground.blendBytes.at("pdc8"), bestPc = playground.blendBytes.at("pc");
    const std::vector<double> pcAll = publishedBlend("pc"), pdc8All = publishedBlend("pdc8");
    std::vector<double> savings;
    for (size_t i = 0; i < pcAll.size(); ++i) savings.push_back(1 - pdc8All[i] / pcAll[i]);
    uint32_t reused = 0, merged = 0;
    for (const PublishedScene& scene : k.scenes)
        if (scene.mergedTuples) reused += *scene.reusedTuples, merged += *scene.mergedTuples;
    return {
        {"4, share of the blend attributes",
         std::format("{:.0f} % (PDC8) and {:.0f} % (PDC32) of the vertex buffer", k.pdc8ShareOfBuffer * 100,
                     k.pdc32ShareOfBuffer * 100),
         std::format("PDC8 {}; PDC32 {}; PC {}.", shares(pdc8), shares(pdc32), shares(pc)),
         "the printed figures are relative to the other 14 bytes, not to the buffer"},
        {"4, best saving", std::format("{:.2f} %", k.bestSaving * 100),
         std::format(
             "1 - {}/{} = {:.2f} % and, against 32 bytes, 1 - {}/32 = {:.2f} %: Playground alone, {} influences a "
             "vertex. Over its five scenes the mean saving is {:.2f} %, the saving of the means {:.2f} %.",
             bestPdc8, bestPc, 100 * (1 - bestPdc8 / bestPc), bestPdc8, 100 * (1 - bestPdc8 / 32),
             *playground.influences, 100 * meanOf(savings), 100 * (1 - meanOf(pdc8All) / meanOf(pcAll))),
         "the mean over scenes"},
        {"4, saving of the whole buffer", std::format("{:.2f} %", k.meanBufferSaving * 100),
         std::format("{:.2f} % x 4/18 = {:.2f} %: consistent.", 100 * meanOf(savings), 100 * meanOf(savings) * 4 / 18),
         "as printed"},
        {"4, merged tuples", std::format("{:.2f} % smaller tables", k.tupleSaving * 100),
         std::format("From the printed counts 1 - {}/{} = {:.2f} %: consistent within rounding.", merged, reused,
                     100.0 * (1 - static_cast<double>(merged) / reused)),
         "as printed"},
    };
}

std::vector<Slip> layoutSlips(const std::vector<ReproduceScene>& scenes) {
    const PublishedKimmersdorfer& k = publishedKimmersdorfer();
    std::string ours, index;
    for (const ReproduceScene& scene : scenes)
        if (const CodecRow* row = codecRow(scene, Geometry::welded, findBuilder("meshopt"), "uc");
            row && row->reason.empty() && row->indexBytes) {
            const double redirect = static_cast<double>(layoutBytes(*row, "redirect")),
                         fixed = static_cast<double>(layoutBytes(*row, "fixed")),
                         indices = static_cast<double>(*row->indexBytes);
            ours += std::format(" Ours, {} welded: 1 - {}/{} = {:.1f} %.", sceneOf(scene), redirect, fixed,
                                100 * (1 - redirect / fixed));
            index += std::format(" Ours, {} welded: 1 - {}/{} = {:.1f} %.", sceneOf(scene), redirect, indices,
                                 100 * (1 - redirect / indices));
        }
    const double saved = k.layoutSavingRecomputed;
    return {
        {"3.2, redirected layout", std::format("{:.0f} % less", k.layoutSaving * 100),
         std::format(
             "Its own sizes give {:.1f} % less; 1/(1 - {}) - 1 = {:.1f} % is how much larger the fixed one is.{}",
             saved * 100, saved, 100 * (1 / (1 - saved) - 1), ours),
         "the saving relative to the larger one"},
        {"3.2, index buffer", std::format("{:.0f} % saved", k.indexSaving * 100),
         std::format("Its own sizes give {:.0f} to {:.0f} %.{}", k.indexSavingRecomputed.low * 100,
                     k.indexSavingRecomputed.high * 100, index),
         "the recomputed range"},
    };
}

std::vector<Slip> sceneSlips(const std::vector<ReproduceScene>& scenes) {
    const PublishedKimmersdorfer& k = publishedKimmersdorfer();
    const PublishedScene& playground = k.scenes.front();
    const auto robot =
        std::ranges::find(k.scenes, std::string("Robot"), [](const auto& s) { return std::string(s.name); });
    std::string ours;
    eachCodec(scenes, [&](const ReproduceScene& scene, Geometry geometry, const CodecRow& row, const CodecRow&) {
        if (std::string(row.codec->name) != "pdc8" || !row.reason.empty()) return;
        ours += std::format(" {} {}: pdc8 {:.2f}.", sceneOf(scene), geometryName(geometry), row.blendBytesPerVertex);
    });
    return {
        {"4.1, welding", "not mentioned",
         std::format(
             "Robot has about {:.1f} thousand vertices and 20.8 thousand faces: {:.2f} a face. Playground has {} "
             "meshlets in table 4.1 and {} in table 3.2, {:.2f} times as many. So nothing was welded, hardly a vertex "
             "was shared between meshlets, and splitting cost nothing.{}",
             *robot->vertices / 1000.0, *robot->vertices / 20'800.0, *playground.meshlets, k.playgroundMeshlets,
             static_cast<double>(*playground.meshlets) / k.playgroundMeshlets, ours),
         "report welded and unwelded, and count vertices that splitting copied"},
        {"4.2, 4.3, Michelle", "in tables 4.1 and 4.4",
         std::format("absent from tables 4.2 and 4.3: their averages are over {} scenes, not {}.",
                     publishedBlend("pc").size(), k.scenes.size()),
         "no average of sizes holds for it"},
    };
}

// w2, w3, w4 in the order of the thesis.
std::array<double, 3> transformed(double w2, double w3, double w4) { return {2 * w2 + w3 + w4, 3 * w3 + w4, 4 * w4}; }

double weightBits(double values) { return 3 * std::log2(values) - std::log2(6.0) + 1; }

std::vector<Slip> codingSlips() {
    const auto equal = transformed(0.25, 0.25, 0.25);
    const uint32_t difference = 1u << 24;
    const float single = std::ceil(std::log2(static_cast<float>(difference) + 1.0f));
    return {
        {"equations 2.20, 2.21", "a transform with its indices reversed",
         std::format(
             "For four equal weights it gives 0.5, 1, 1.5, outside the unit cube; the right one gives {}, {}, {}.",
             equal[0], equal[1], equal[2]),
         "w'2 = 2 w2 + w3 + w4, w'3 = 3 w3 + w4, w'4 = 4 w4"},
        {"3.3, DPDC16", "13 + 5 + 14 bits with 36 values a weight",
         std::format("36 values take {:.2f} bits, with 5 + 14 others {:.2f} of 32; 29 values take {:.2f}. The "
                     "program spends 14 on weights, 5 on the permutation and 13 on the tuple.",
                     weightBits(36), weightBits(36) + 19, weightBits(29)),
         "36 values with 13 bits of tuple, or 29 with 14"},
        {"program, bits of a difference", "log2 in single precision",
         std::format("For a difference of {} it gives {:.0f} bits; {} are needed.", difference, single,
                     std::bit_width(difference)),
         "the bit length of the integer"},
        {"program, decoders", "16-bit values divided by 65534",
         std::format("The largest value decodes to 65535/65534 = {:.7f}.", 65535.0 / 65534.0), "65535"},
        {"equation 2.6", "the azimuth in 0 to pi, the polar angle in 0 to 2 pi",
         std::format(
             "The polar angle of (0, 0, -1) is {:.4f}, the azimuth of (-1, 0, 0) is {:.4f} and that of (0, -1, 0) "
             "{:.4f}.",
             std::acos(-1.0), std::atan2(0.0, -1.0), std::atan2(-1.0, 0.0)),
         "azimuth in -pi to pi, polar angle in 0 to pi"},
        {"equations 2.9, 2.11, 2.12", "signs of the octahedral fold", "no figure takes part",
         "sgn of (n'x, n'y) when encoding, f - sgn(f) t when decoding"},
        {"2.1.3 and the program", "table 2.2 rounds to nearest, the program stores floor",
         "see table 2.2 above: where directions are spread evenly, floor is twice the error", "nearest"},
        {"program, bounding boxes", "the maximum starts at the smallest positive float",
         "a mesh whose coordinates are all negative gets a box that reaches to 0", "the lowest float"},
    };
}

template <class T>
void append(std::vector<T>& to, std::vector<T> from) {
    for (T& value : from) to.push_back(std::move(value));
}

}  // namespace

Reproduction reproduceKimmersdorfer(const std::vector<ReproduceScene>& scenes) {
    Reproduction all{
        "kimmersdorfer",
        "Vertex Compression with Mesh Shaders for Skinned Meshes",
        "Gerald Kimmersdorfer, bachelor's thesis, TU Wien",
        {positionTable(scenes), normalTable(scenes), meshletTable(scenes), sceneTable(scenes), bufferTable(scenes),
         blendTable(scenes), printedBlendTable(), timeTable(scenes)},
        {},
        {"Tables 3.1 and 3.2: of their figures only the meshlets of Playground are known here.",
         "Table 4.1: complete for Michelle only, for the other scenes in part.",
         "Table 4.2: its sizes in bytes are not available; what is known of them is bytes a vertex and the sums that "
         "table 4.3 is made of.",
         "Table 4.4: not the times but their ratios to PC are known, as ranges over its scenes; none for UC and "
         "DPDC16.",
         "Figs. 4.1 to 4.4: not available, because only text was at hand; tables 4.2 to 4.4 are drawn as bars on the "
         "page instead.",
         "Its scenes (Playground, Mixamo Group, Monsters, Dragon, Robot, Michelle) are not at hand: its rows stand "
         "beside ours, on other scenes."}};
    append(all.slips, percentageSlips());
    append(all.slips, layoutSlips(scenes));
    append(all.slips, sceneSlips(scenes));
    append(all.slips, codingSlips());
    return all;
}

}  // namespace skinbench
