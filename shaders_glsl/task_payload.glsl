// What a task work group hands to the mesh work groups that it starts: which of its TASK_GROUP meshlets are drawn, in
// their order. 36 bytes.
#if MESH_NV
taskNV PAYLOAD_WAY Payload {
#else
struct Payload {
#endif
    uint first;                   // the work group's first meshlet, counted as mesh work groups are without a task stage
    uint places[TASK_GROUP / 4];  // behind it, a byte each
#if MESH_NV
} payload;
#else
};
taskPayloadSharedEXT Payload payload;
#endif
