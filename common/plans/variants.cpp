// The tables of routes and variants, and what follows from a case's rows.
#include <algorithm>

#include "common/plans/case.h"
#include "common/plans/plans.h"

namespace skinbench {

const std::vector<Route>& routes() {
    static const std::vector<Route> rows = {
        {.name = "vk", .api = Api::vulkan, .what = "Vulkan, vertex and compute stages"},
        {.name = "vk-ext", .api = Api::vulkan, .dialect = MeshDialect::ext, .what = "Vulkan, VK_EXT_mesh_shader"},
        {.name = "vk-nv", .api = Api::vulkan, .dialect = MeshDialect::nv, .what = "Vulkan, VK_NV_mesh_shader"},
        {.name = "gl", .api = Api::opengl, .what = "OpenGL, vertex and compute stages"},
        {.name = "gl-ext", .api = Api::opengl, .dialect = MeshDialect::ext, .what = "OpenGL, GL_EXT_mesh_shader"},
        {.name = "gl-nv", .api = Api::opengl, .dialect = MeshDialect::nv, .what = "OpenGL, GL_NV_mesh_shader"},
        {.name = "cpu", .api = Api::cpu, .what = "no graphics API: skinning on all cores"},
    };
    return rows;
}

const std::vector<Variant>& variants() {
    static const std::vector<Variant> rows = {
        {.name = "none",
         .what = "no skinning: the baseline",
         .onPlainRoutes = true,
         .onMeshRoutes = true,
         .skins = false,
         .fetches = true,
         .plan = planDirect},
        {.name = "vertex",
         .what = "linear blend skinning in the vertex stage",
         .onPlainRoutes = true,
         .fetches = true,
         .prepasses = true,
         .plan = planDirect},
        {.name = "compute",
         .what = "a compute pass skins into a buffer, a plain vertex stage draws it",
         .onPlainRoutes = true,
         .skinsInCompute = true,
         .prepasses = true,
         .plan = planCompute},
        {.name = "compute-cull",
         .what = "as compute, and a second pass lists the triangles that can be seen for an indirect draw",
         .onPlainRoutes = true,
         .listsTriangles = true,
         .cullsMeshlets = true,
         .plan = planComputeCull},
        {.name = "mesh",
         .what = "a mesh-shader work group skins and draws a meshlet",
         .onMeshRoutes = true,
         .prepasses = true,
         .cullsMeshlets = true,
         .plan = planDirect},
        {.name = "mesh-ci",
         .what = "as mesh, joint ids once per meshlet where its vertices share them",
         .onMeshRoutes = true,
         .prepasses = true,
         .cullsMeshlets = true,
         .storedAs = StoredAs::commonInfluences,
         .plan = planDirect},
        {.name = "compute-mesh",
         .what = "a compute pass skins into a buffer, a mesh-shader work group draws a meshlet of it",
         .onMeshRoutes = true,
         .readsSkinned = true,
         .cullsMeshlets = true,
         .plan = planComputeMesh},
        {.name = "palette",
         .what = "as vertex, in draws whose joints fit the slots of a small uniform palette",
         .onPlainRoutes = true,
         .fetches = true,
         .storedAs = StoredAs::palettePartition,
         .plan = planDirect},
        {.name = "cpu",
         .what = "the CPU skins on all cores, uploads, draws",
         .onPlainRoutes = true,
         .onCpuRoute = true,
         .skinsOnHost = true,
         .plan = planCpu},
    };
    return rows;
}

template <class Row>
static const Row* findRow(const std::vector<Row>& rows, const std::string& name) {
    const auto row = std::ranges::find(rows, name, &Row::name);
    return row == rows.end() ? nullptr : &*row;
}

const Route* findRoute(const std::string& name) { return findRow(routes(), name); }
const Variant* findVariant(const std::string& name) { return findRow(variants(), name); }

bool runsOn(const Variant& variant, const Route& route) {
    if (route.api == Api::cpu) return variant.onCpuRoute;
    return route.dialect == MeshDialect::none ? variant.onPlainRoutes : variant.onMeshRoutes;
}

bool posesVertices(const Case& c) { return c.variant->skins && !c.loadsOnly; }

bool writesFirst(const Case& c) {
    if (c.vertexWrites != VertexWrites::automatic) return c.vertexWrites == VertexWrites::first;
    return c.route->dialect == MeshDialect::nv || !c.variant->readsSkinned;
}

uint32_t triangleTestsOf(const Case& c) {
    if (c.variant->listsTriangles) return c.triangleTests;
    return c.cull != Cull::off ? TEST_BACK : 0;
}

std::vector<uint32_t> verdictsOf(const Case& c) {
    const uint32_t clusters = c.clusterCull != ClusterCull::off ? c.clusterTests : 0, triangles = triangleTestsOf(c);
    std::vector<uint32_t> verdicts{VERDICT_DRAWN};
    if (clusters & CLUSTER_TEST_FRUSTUM) verdicts.push_back(VERDICT_BEYOND);
    if (clusters & CLUSTER_TEST_CONE) verdicts.push_back(VERDICT_AWAY);
    if (triangles & TEST_FRUSTUM) verdicts.push_back(VERDICT_TRIANGLE_BEYOND);
    if (triangles & TEST_BACK) verdicts.push_back(VERDICT_TRIANGLE_AWAY);
    if (triangles & TEST_SMALL) verdicts.push_back(VERDICT_TRIANGLE_SMALL);
    return verdicts;
}

bool onMeshRoute(const Case& c) { return c.route->dialect != MeshDialect::none; }

bool sharesJointLists(const Case& c) { return c.variant->storedAs == StoredAs::commonInfluences; }

bool skinsTangents(const ComputeOptions& options) { return options.tangents || packsTangents(options); }

bool packsTangents(const ComputeOptions& options) { return options.shortTangents || options.wicked; }

bool packsVertices(const ComputeOptions& options) { return options.packed || options.wicked; }

bool usesPartition(const Case& c) { return c.variant->storedAs == StoredAs::palettePartition; }

bool storesSlim(const Case& c) { return c.builder && (sharesJointLists(c) || c.shape.joints != JointSource::vertex); }

const Codec& storedCodec(const Case& c) {
    return storesSlim(c) && c.codec->slim ? *findCodec(c.codec->slim) : *c.codec;
}

}  // namespace skinbench
