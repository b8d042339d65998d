// Verdicts on meshlets and triangles: which of them a pass shows, and where they are stored.
//
// A pass shows what is drawn. In the view `culled` it shows what has one verdict, the number of the pass; a meshlet
// that is left out is shown whole.
#include "frame.glsl"

#if VIEW == VIEW_CULLED
bool showsMeshlets(uint verdict) { return verdict == (VIEW_NUMBER > VERDICT_AWAY ? VERDICT_DRAWN : VIEW_NUMBER); }

bool showsTriangles(uint verdict) {
    return VIEW_NUMBER == verdict || VIEW_NUMBER == VERDICT_BEYOND || VIEW_NUMBER == VERDICT_AWAY;
}
#else
bool showsMeshlets(uint verdict) { return verdict == VERDICT_DRAWN; }
bool showsTriangles(uint verdict) { return verdict == VERDICT_DRAWN; }
#endif

#if STORES_VERDICTS
layout(std430, binding = SLOT_VERDICT) restrict buffer VerdictBlock { uint verdicts[]; };
#endif
