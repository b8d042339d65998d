// Known slips of Kimmersdorfer's thesis, with the arithmetic.
#include <array>
#include <bit>
#include <cmath>
#include <format>

#include "common/theses/reproduce_parts.h"

namespace skinbench {

namespace {

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
    for (const ReproduceScene& scene : scenes)
        for (Geometry geometry : {Geometry::unwelded, Geometry::welded})
            if (const CodecRow* row = codecRow(scene, geometry, findBuilder("meshopt"), "pdc8");
                row && row->reason.empty())
                ours += std::format(" {} {}: pdc8 {:.2f}.", sceneOf(scene), geometryName(geometry),
                                    row->blendBytesPerVertex);
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

}  // namespace

std::vector<Slip> kimmersdorferSlips(const std::vector<ReproduceScene>& scenes) {
    std::vector<Slip> slips;
    for (const auto& part : {percentageSlips(), layoutSlips(scenes), sceneSlips(scenes), codingSlips()})
        slips.insert(slips.end(), part.begin(), part.end());
    return slips;
}

}  // namespace skinbench
