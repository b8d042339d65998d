// The commands of indirect draws (common/frame/backend.h, DrawCommand), and whose triangles each of them draws.
#include "shared.h"

struct DrawCommand {
    uint count;
    uint instances;
    uint firstIndex;
    int baseVertex;
    uint firstInstance;
};
layout(std430, binding = SLOT_COMMAND) restrict buffer CommandBlock { DrawCommand commands[]; };

uint commandOf(uint copyNumber) {
#if BATCHED
    return 0u;
#else
    return copyNumber;
#endif
}
