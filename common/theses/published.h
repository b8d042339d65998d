// What the two theses print, as far as it is known here. Only figures that a text at hand gives are in these tables;
// what is missing stays empty and is shown as "not available". Nothing here is measured or estimated by us.
//
// T: P. Torabi, "Skeletal Animation Optimization Using Mesh Shaders", master's thesis, Blekinge Institute of
//    Technology, 2019. At hand: its abstract.
// K: G. Kimmersdorfer, "Vertex Compression with Mesh Shaders for Skinned Meshes", bachelor's thesis, TU Wien.
//    At hand: figures from its text; none of its plots.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skinbench {

// Both ends are printed figures; equal where one figure is printed.
struct Range {
    double low = 0;
    double high = 0;
    bool operator==(const Range&) const = default;
};

// --- Torabi ----------------------------------------------------------------------------------------------------

struct PublishedTorabi {
    Range lessTimePerMeshlet;          // mesh-ci against mesh, a fraction
    const char* meshAgainstVertex;     // in words: the abstract gives no figure
    const char* meshCiAgainstVertex;   // "
    const char* computeAgainstVertex;  // "
};
const PublishedTorabi& publishedTorabi();

// --- Kimmersdorfer ---------------------------------------------------------------------------------------------

// Tables 4.1 and 4.3, and the tuple counts. An empty optional is a figure that is not known here.
struct PublishedScene {
    const char* name;
    std::optional<uint32_t> vertices;
    bool derived = false;  // `vertices` follows from the printed size of the uncompressed vertex buffer, 64 bytes each
    std::optional<uint32_t> triangles, joints, meshlets;
    std::optional<double> influences;  // mean
    std::optional<uint32_t> tuples, reusedTuples, mergedTuples;
    std::map<std::string, double> blendBytes;  // codec to bytes a vertex, table 4.3; empty: the scene is not in it
};

struct PublishedKimmersdorfer {
    std::map<int, Range> positionErrors;             // table 2.1: bits to mean error, over its scenes
    Range euclidean, spherical, octahedral;          // table 2.2: mean error, over its scenes
    uint32_t playgroundMeshlets = 0;                 // table 3.2
    std::vector<PublishedScene> scenes;              // tables 4.1, 4.3
    std::map<std::string, double> blendAverages;     // table 4.3, last row
    std::map<std::string, uint32_t> bytesPerVertex;  // 3.3 and table 4.2; codecs with a fixed size only
    std::map<std::string, Range> timesOverPc;        // table 4.4, codec to frame time over that of pc
    uint32_t baseBytes = 0;                          // of a compressed vertex without its blend attributes
    uint32_t fixedMeshletBytes = 0;                  // 3.2, the fixed layout

    // Percentages in the running text.
    double pdc8ShareOfBuffer = 0, pdc32ShareOfBuffer = 0;  // "of the vertex buffer"
    double bestSaving = 0, bestSavingOverRaw = 0;          // PDC8 on Playground against PC and against 32 bytes
    double meanSaving = 0, meanBufferSaving = 0;           // PDC8 against PC over the scenes of table 4.3
    double tupleSaving = 0;                                // merging against reuse alone
    double layoutSaving = 0;                               // 3.2, redirect against fixed
    double layoutSavingRecomputed = 0;                     // the same from its own sizes
    double indexSaving = 0;                                // 3.2, meshlet indices against the index buffer
    Range indexSavingRecomputed;
};
const PublishedKimmersdorfer& publishedKimmersdorfer();

}  // namespace skinbench
