#include <algorithm>
#include <format>

#include "common/theses/reproduce_parts.h"

namespace skinbench {

using Json = nlohmann::ordered_json;

Result<RoundedErrors> roundedErrors(const Scene& stored) {
    auto scene = prepareScene(stored, {4, Geometry::unwelded, false});
    SKINBENCH_TRY(scene);
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

const MeshletRow* plainCut(const ReproduceScene& scene, Geometry geometry, const Builder* builder) {
    for (const MeshletRow& row : scene.inspection.meshlets)
        if (!row.grouping && row.cacheOrder && row.geometry == geometry && row.builder == builder) return &row;
    return nullptr;
}

ReproduceTable builderTable(const std::vector<ReproduceScene>& scenes) {
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
            for (const Json& c : run.results["cases"]) {
                if (c["status"] == "skipped") continue;
                auto word = [&](const char* key) { return c[key].is_string() ? c[key].get<std::string>() : ""; };
                CaseKey baseline = {{"codec", "pc"}};
                for (const char* key : {"route", "variant", "builder", "layout", "raster"}) baseline[key] = word(key);
                const Json* base = findCase(run.results, baseline);
                const bool mesh = !word("builder").empty();
                const auto published = mesh && run.geometry == Geometry::unwelded
                                           ? lookUp(publishedKimmersdorfer().timesOverPc, word("codec"))
                                           : std::nullopt;
                Figure ours = base ? timeRatio(run.results, c, *base) : wordFigure("no baseline");
                if (word("status") == "failed") ours = wordFigure("failed");
                table.rows.push_back(
                    {{sceneOf(scene), geometryName(run.geometry), word("route"),
                      word("variant") + " " + word("codec") + (mesh ? " " + word("layout") : ""), word("raster")},
                     ours,
                     word("codec") == "pc" ? wordFigure("baseline") : publishedOr(published, threeDigits),
                     ratioTo(ours, published),
                     {base ? ratioInterval(c, *base) : Figure{},
                      medianOf(c) ? figureOf(*medianOf(c), milliseconds) : Figure{}},
                     published.has_value()});
            }
    table.notes = timeNotes(runsOf(scenes));
    return table;
}

}  // namespace

Reproduction reproduceKimmersdorfer(const std::vector<ReproduceScene>& scenes) {
    return {
        "kimmersdorfer",
        "Vertex Compression with Mesh Shaders for Skinned Meshes",
        "Gerald Kimmersdorfer, bachelor's thesis, TU Wien",
        {positionTable(scenes), normalTable(scenes), builderTable(scenes), sceneTable(scenes), bufferTable(scenes),
         blendTable(scenes), printedBlendTable(), timeTable(scenes)},
        kimmersdorferSlips(scenes),
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
}

}  // namespace skinbench
