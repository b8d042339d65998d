#include "common/scene/builtin/solids.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/scene/builtin/exact.h"

namespace skinbench::builtin {

namespace {

int divisions(float length, float spacing, int least) {
    return std::max(least, int(std::floor(length / spacing + 0.5f)));
}

void addVertex(Mesh& mesh, uint32_t joint, glm::vec3 position, glm::vec3 normal) {
    Influences bound;
    bound.joints[0] = uint16_t(joint);
    bound.weights[0] = 1;
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
    mesh.influences.push_back(bound);
}

void addQuad(Mesh& mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const glm::vec3 ac = mesh.positions[c] - mesh.positions[a], bd = mesh.positions[d] - mesh.positions[b];
    if (glm::dot(ac, ac) <= glm::dot(bd, bd))
        mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
    else
        mesh.indices.insert(mesh.indices.end(), {b, c, d, b, d, a});
}

// On a coarse grid edges grow rounder instead of becoming rows of slivers.
float bevelFor(const Solid& s, float spacing) {
    const float smallest = s.kind == Solid::Kind::box ? std::min({s.half.x, s.half.y, s.half.z})
                                                      : 0.8f * std::min({s.bottom, s.top, s.length});
    return std::max(s.bevel, std::min(0.45f * spacing, smallest));
}

// --- box -------------------------------------------------------------------------------------------------------

// Grid lines across one axis of a rounded box: an eighth of a circle, the flat part, an eighth of a circle.
struct BoxLine {
    float core = 0;   // on the box that the bevel is swept around
    float slope = 0;  // tangent of the angle of the normal: -1..1
};

std::vector<BoxLine> boxLines(float half, float bevel, float spacing) {
    const float core = half - bevel;
    const int arc = divisions(bevel * 0.7853982f, spacing, 1);
    const int flat = divisions(2 * core, spacing, 0);
    std::vector<BoxLine> lines;
    for (int i = 0; i < arc; ++i) {
        const SinCos a = sinCosTurns(0.125 * (arc - i) / arc);
        lines.push_back({-core, float(-a.sin / a.cos)});
    }
    for (int i = 0; i <= flat; ++i) lines.push_back({flat ? core * (2 * float(i) / float(flat) - 1) : 0, 0});
    for (int i = arc; i-- > 0;) lines.push_back({core, -lines[size_t(i)].slope});
    lines.front().slope = -1;
    lines.back().slope = 1;
    return lines;
}

std::array<std::vector<BoxLine>, 3> boxGrid(const Solid& s, float spacing) {
    const float bevel = bevelFor(s, spacing);
    return {boxLines(s.half.x, bevel, spacing), boxLines(s.half.y, bevel, spacing), boxLines(s.half.z, bevel, spacing)};
}

void addBox(const Solid& s, float spacing, Mesh& mesh) {
    const auto lines = boxGrid(s, spacing);
    const float bevel = bevelFor(s, spacing);
    const glm::ivec3 n(int(lines[0].size()) - 1, int(lines[1].size()) - 1, int(lines[2].size()) - 1);
    std::vector<uint32_t> ids(size_t(n.x + 1) * size_t(n.y + 1) * size_t(n.z + 1));
    const auto id = [&](glm::ivec3 c) -> uint32_t& {
        return ids[size_t(c.x) + size_t(n.x + 1) * (size_t(c.y) + size_t(n.y + 1) * size_t(c.z))];
    };
    for (int z = 0; z <= n.z; ++z)
        for (int y = 0; y <= n.y; ++y)
            for (int x = 0; x <= n.x; ++x) {
                const bool rim = y == 0 || y == n.y || z == 0 || z == n.z;
                if (!rim && x != 0 && x != n.x) continue;
                const BoxLine &lx = lines[0][size_t(x)], &ly = lines[1][size_t(y)], &lz = lines[2][size_t(z)];
                const glm::vec3 normal = unit({lx.slope, ly.slope, lz.slope});
                id({x, y, z}) = uint32_t(mesh.positions.size());
                addVertex(mesh, s.joint, s.centre + glm::vec3(lx.core, ly.core, lz.core) + normal * bevel, normal);
            }
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const int side : {0, n[axis]})
            for (int i = 0; i < n[u]; ++i)
                for (int j = 0; j < n[v]; ++j) {
                    glm::ivec3 a(0);
                    a[axis] = side;
                    a[u] = i;
                    a[v] = j;
                    glm::ivec3 b = a, c = a, d = a;
                    ++b[u];
                    ++c[u];
                    ++c[v];
                    ++d[v];
                    if (side == 0) std::swap(b, d);
                    addQuad(mesh, id(a), id(b), id(c), id(d));
                }
    }
}

// --- lathe -----------------------------------------------------------------------------------------------------

struct ProfilePoint {
    glm::vec2 place{0};  // radius, height
    glm::vec2 normal{0};
};

struct Profile {
    int rings = 1;                     // of each cap, a square grid of 2 rings x 2 rings cells; 8 rings points around
    std::vector<ProfilePoint> points;  // from the bottom's rim to the top's rim
    float capBottom = 0, capTop = 0;   // radii of those
};

// Rounds a corner between two straight pieces with the given normals; ends are included.
void addCorner(glm::vec2 corner, glm::vec2 n0, glm::vec2 n1, float bevel, float spacing, Profile& profile) {
    const glm::vec2 centre = corner - (n0 + n1) * (bevel / (1 + glm::dot(n0, n1)));
    const int steps = divisions(bevel * 1.6f, spacing, 1);
    for (int i = 0; i <= steps; ++i) {
        const glm::vec2 mixed = n0 + (n1 - n0) * (float(i) / float(steps));
        const glm::vec2 normal = mixed / std::sqrt(glm::dot(mixed, mixed));
        profile.points.push_back({centre + normal * bevel, normal});
    }
}

Profile makeProfile(const Solid& s, float spacing) {
    Profile profile;
    profile.rings = divisions(0.7853982f * std::max(s.bottom, s.top), spacing, 1);
    const float bevel = bevelFor(s, spacing);
    const glm::vec2 way(s.top - s.bottom, 2 * s.length);
    const glm::vec2 side = glm::vec2(way.y, -way.x) / std::sqrt(glm::dot(way, way));
    addCorner({s.bottom, -s.length}, {0, -1}, side, bevel, spacing, profile);
    const glm::vec2 low = profile.points.back().place;
    Profile upper;
    addCorner({s.top, s.length}, side, {0, 1}, bevel, spacing, upper);
    const glm::vec2 rise = upper.points.front().place - low;
    const int steps = divisions(std::sqrt(glm::dot(rise, rise)), spacing, 1);
    for (int i = 1; i < steps; ++i) profile.points.push_back({low + rise * (float(i) / float(steps)), side});
    profile.points.insert(profile.points.end(), upper.points.begin(), upper.points.end());
    profile.capBottom = profile.points.front().place.x;
    profile.capTop = profile.points.back().place.x;
    return profile;
}

// Where point (i, j) of a square ring lies on the circle: equal angles along each side of the square.
glm::vec2 onCircle(int i, int j) {
    const int ring = std::max(std::abs(i), std::abs(j));
    if (ring == 0) return {0, 0};
    const bool alongI = std::abs(i) >= std::abs(j);
    const SinCos a = sinCosTurns(0.125 * double(alongI ? j : i) / ring);
    const auto c = float(alongI ? (i > 0 ? a.cos : -a.cos) : a.sin);
    const auto d = float(alongI ? a.sin : (j > 0 ? a.cos : -a.cos));
    return {c, d};
}

// Counter-clockwise around the outermost square, from its corner (-n, -n).
glm::ivec2 rimPoint(int k, int n) {
    const int side = k / (2 * n), step = k % (2 * n);
    switch (side & 3) {
        case 0:
            return {-n + step, -n};
        case 1:
            return {n, -n + step};
        case 2:
            return {n - step, n};
        default:
            return {-n, n - step};
    }
}

struct Lathe {
    const Solid& solid;
    const Profile& profile;
    Mesh& mesh;

    // Heights run along the axis; the other two axes follow in right-handed order.
    glm::vec3 turn(float a, float b, float height) const {
        switch (solid.axis) {
            case Axis::x:
                return {height, a, b};
            case Axis::y:
                return {b, height, a};
            default:
                return {a, b, height};
        }
    }
    void add(glm::vec2 circle, glm::vec2 place, glm::vec2 normal) const {
        addVertex(mesh, solid.joint, solid.centre + turn(circle.x * place.x, circle.y * place.x, place.y),
                  unit(turn(circle.x * normal.x, circle.y * normal.x, normal.y)));
    }

    // Returns the index of the cap's point (0, 0) of the square grid.
    uint32_t addCap(float radius, float height, float up) const {
        const int n = profile.rings;
        const auto first = uint32_t(mesh.positions.size());
        for (int j = -n; j <= n; ++j)
            for (int i = -n; i <= n; ++i) {
                const int ring = std::max(std::abs(i), std::abs(j));
                add(onCircle(i, j), {radius * float(ring) / float(n), height}, {0, up});
            }
        const auto row = uint32_t(2 * n + 1);
        for (uint32_t j = 0; j + 1 < row; ++j)
            for (uint32_t i = 0; i + 1 < row; ++i) {
                const uint32_t a = first + j * row + i;
                if (up > 0)
                    addQuad(mesh, a, a + 1, a + row + 1, a + row);
                else
                    addQuad(mesh, a, a + row, a + row + 1, a + 1);
            }
        return first;
    }

    void build() const {
        const int n = profile.rings, around = 8 * n, row = 2 * n + 1;
        const glm::vec2 bottom = profile.points.front().place, top = profile.points.back().place;
        const uint32_t low = addCap(bottom.x, bottom.y, -1), high = addCap(top.x, top.y, 1);
        const auto middle = uint32_t(mesh.positions.size());
        for (size_t p = 1; p + 1 < profile.points.size(); ++p)
            for (int k = 0; k < around; ++k) {
                const glm::ivec2 at = rimPoint(k, n);
                add(onCircle(at.x, at.y), profile.points[p].place, profile.points[p].normal);
            }
        const auto id = [&](size_t p, int k) {
            k %= around;
            if (p > 0 && p + 1 < profile.points.size()) return middle + uint32_t(int(p - 1) * around + k);
            const glm::ivec2 at = rimPoint(k, n);
            return (p == 0 ? low : high) + uint32_t((at.y + n) * row + at.x + n);
        };
        for (size_t p = 0; p + 1 < profile.points.size(); ++p)
            for (int k = 0; k < around; ++k) addQuad(mesh, id(p, k), id(p, k + 1), id(p + 1, k + 1), id(p + 1, k));
    }
};

bool isLeftOut(const Solid& s, float spacing) {
    const float largest =
        s.kind == Solid::Kind::box ? std::max({s.half.x, s.half.y, s.half.z}) : std::max({s.bottom, s.top, s.length});
    return s.detail && largest < 0.8f * spacing;
}

}  // namespace

uint32_t countVertices(const Solid& solid, float spacing) {
    if (isLeftOut(solid, spacing)) return 0;
    if (solid.kind == Solid::Kind::lathe) {
        const Profile profile = makeProfile(solid, spacing);
        const auto rings = uint32_t(profile.rings);
        return 2 * (2 * rings + 1) * (2 * rings + 1) + 8 * rings * uint32_t(profile.points.size() - 2);
    }
    const auto lines = boxGrid(solid, spacing);
    const auto x = uint32_t(lines[0].size()), y = uint32_t(lines[1].size()), z = uint32_t(lines[2].size());
    return x * y * z - (x - 2) * (y - 2) * (z - 2);
}

void addSolid(const Solid& solid, float spacing, Mesh& mesh) {
    if (isLeftOut(solid, spacing)) return;
    if (solid.kind == Solid::Kind::box) return addBox(solid, spacing, mesh);
    const Profile profile = makeProfile(solid, spacing);
    Lathe{solid, profile, mesh}.build();
}

}  // namespace skinbench::builtin
