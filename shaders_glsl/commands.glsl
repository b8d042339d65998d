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

// Each view has commands of its own; 0 is the main one.
uint commandOf(uint copyNumber, uint view) {
#if BATCHED
    uint place = 0u;
#else
    uint place = copyNumber;
#endif
    return view * uint(COMMANDS_OF_VIEW) + place;
}
