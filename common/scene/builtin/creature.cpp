#include <algorithm>
#include <array>

#include "common/scene/builtin/characters.h"
#include "common/scene/builtin/rig.h"
#include "common/scene/builtin/surface.h"

namespace skinbench::builtin {

namespace {

constexpr int kArms = 8;
constexpr int kArmJoints = 14;

std::string armJoint(int arm, int joint) { return "Arm" + std::to_string(arm + 1) + "_" + std::to_string(joint + 1); }

struct Tentacle {
    glm::vec3 outward{0}, sideways{0};
    float length = 1, curl = 1, swing = 1;
    double phase = 0;
    std::vector<glm::vec3> points;  // kArmSteps + 1 at equal steps, from the body to the tip

    static float radius(float s) { return 0.090f * (1 - s) * (1 - 0.30f * s) + 0.0125f; }
    glm::vec3 at(int step) const { return points[size_t(step)]; }
};

constexpr int kArmSteps = 140;

// Down to the floor, along it in a wave, the tip rolled up; s runs from 0 to 1.
void layOut(Tentacle& t) {
    const float step = t.length / kArmSteps;
    glm::vec3 p = t.outward * 0.09f;
    float lowest = 1e9f;
    for (int i = 0; i <= kArmSteps; ++i) {
        const float s = float(i) / kArmSteps;
        t.points.push_back(p);
        lowest = std::min(lowest, p.y - Tentacle::radius(s));
        const float roll = std::max(0.0f, (s - 0.60f) / 0.40f);
        const float lie = smoothStep(s / 0.50f);
        const double pitch = -0.135 * double(1 - lie) + 0.012 * double(lie) + 0.72 * double(t.curl * roll * roll);
        const double yaw = double(t.swing) * 0.085 * double(sinTurns(1.15 * double(s) + t.phase)) * double(lie);
        const SinCos up = sinCosTurns(pitch), aside = sinCosTurns(yaw);
        p += step * (float(up.cos * aside.cos) * t.outward + float(aside.sin) * t.sideways + glm::vec3(0, up.sin, 0));
    }
    for (glm::vec3& point : t.points) point.y -= lowest;
}

std::array<Tentacle, kArms> makeTentacles(Random& random) {
    std::array<Tentacle, kArms> tentacles;
    for (int i = 0; i < kArms; ++i) {
        Tentacle& t = tentacles[size_t(i)];
        const double turn = (i + 0.5) / kArms + double(random.between(-0.012f, 0.012f));
        t.outward = {sinTurns(turn), 0, cosTurns(turn)};
        t.sideways = {t.outward.z, 0, -t.outward.x};
        t.length = random.between(1.18f, 1.36f);
        t.curl = random.between(0.75f, 1.15f);
        t.swing = random.between(0.7f, 1.2f) * (i % 2 ? 1.0f : -1.0f);
        t.phase = double(random.between(-0.06f, 0.06f));
        layOut(t);
    }
    return tentacles;
}

glm::vec3 finAt(float side, float s) { return {side * (0.17f + 0.17f * s), 0.80f + 0.10f * s, -0.20f - 0.05f * s}; }

Rig makeRig(const std::array<Tentacle, kArms>& tentacles) {
    Rig rig;
    const auto add = [&](const std::string& name, int32_t parent, glm::vec3 p) {
        return int32_t(rig.add(name, parent, p));
    };
    const int32_t body = add("Body", add("Root", -1, {0, 0, 0}), {0, 0.34f, 0});
    const int32_t head = add("Head", body, {0, 0.42f, 0.02f});
    const int32_t mantle1 = add("Mantle1", head, {0, 0.56f, -0.06f});
    const int32_t mantle2 = add("Mantle2", mantle1, {0, 0.74f, -0.17f});
    add("Mantle3", mantle2, {0, 0.92f, -0.28f});
    for (const float side : {1.0f, -1.0f}) {
        add(sided(side, "Eye"), head, {side * 0.125f, 0.50f, 0.10f});
        int32_t parent = mantle2;
        for (int j = 0; j < 3; ++j)
            parent = add(sided(side, "Fin") + std::to_string(j + 1), parent, finAt(side, 0.33f * float(j)));
    }
    add("Siphon2", add("Siphon1", head, {0, 0.40f, -0.14f}), {0, 0.37f, -0.23f});
    for (int i = 0; i < kArms; ++i) {
        int32_t parent = body;
        for (int j = 0; j < kArmJoints; ++j) parent = add(armJoint(i, j), parent, tentacles[size_t(i)].at(10 * j + 3));
    }
    return rig;
}

// --- shape -----------------------------------------------------------------------------------------------------

struct CreatureMaker {
    const Rig& rig;
    Body body{};

    Chain& add(std::vector<ShapeNode> nodes, float blend, float skinBlend) {
        Chain chain;
        chain.nodes = std::move(nodes);
        chain.blend = blend;
        chain.skinBlend = skinBlend;
        return body.chains.emplace_back(std::move(chain));
    }
    void skin(Chain& chain, const std::string& joint, float softness) const {
        chain.joints.push_back({rig.find(joint), softness});
    }
};

void addBody(CreatureMaker& m, float mantle) {
    Chain& head = m.add({{{0, 0.27f, 0.000f}, 0.120f}, {{0, 0.36f, 0.000f}, 0.145f}, {{0, 0.50f, 0.000f}, 0.128f}},
                        0.060f, 0.090f);
    head.wide = 1.06f;
    m.skin(head, "Body", 0);
    m.skin(head, "Head", 0.060f);
    const auto sack = [](float s) { return glm::vec3(0, 0.50f + 0.54f * s, -0.035f - 0.315f * s); };
    Chain& mantleChain = m.add({{sack(0.00f), 0.120f},
                                {sack(0.18f), 0.160f * mantle},
                                {sack(0.38f), 0.215f * mantle},
                                {sack(0.56f), 0.236f * mantle},
                                {sack(0.74f), 0.226f * mantle},
                                {sack(0.84f), 0.216f * mantle}},
                               0.060f, 0.090f);
    mantleChain.wide = 1.08f;
    m.skin(mantleChain, "Head", 0);
    m.skin(mantleChain, "Mantle1", 0.080f);
    m.skin(mantleChain, "Mantle2", 0.110f);
    m.skin(mantleChain, "Mantle3", 0.110f);
    for (const float side : {1.0f, -1.0f}) {
        Chain& socket = m.add({{{side * 0.085f, 0.480f, 0.050f}, 0.060f}, {{side * 0.118f, 0.500f, 0.090f}, 0.066f}},
                              0.040f, 0.045f);
        m.skin(socket, "Head", 0);
        Chain& eye = m.add({{{side * 0.132f, 0.508f, 0.112f}, 0.050f}}, 0.008f, 0.010f);
        m.skin(eye, sided(side, "Eye"), 0);
        Chain& fin = m.add({{finAt(side, -0.3f), 0.050f}, {finAt(side, 0.35f), 0.034f}, {finAt(side, 1.0f), 0.018f}},
                           0.040f, 0.050f);
        fin.wide = 2.2f;
        fin.wideAxis = unit({0, 0.55f, -0.8f});
        m.skin(fin, "Mantle2", 0);
        for (int j = 0; j < 3; ++j) m.skin(fin, sided(side, "Fin") + std::to_string(j + 1), 0.045f);
    }
    Chain& siphon = m.add(
        {{{0, 0.42f, -0.080f}, 0.060f}, {{0, 0.395f, -0.180f}, 0.046f}, {{0, 0.36f, -0.270f}, 0.052f}}, 0.030f, 0.040f);
    m.skin(siphon, "Head", 0);
    m.skin(siphon, "Siphon1", 0.030f);
    m.skin(siphon, "Siphon2", 0.045f);
}

void addTentacle(CreatureMaker& m, const Tentacle& t, int arm) {
    std::vector<ShapeNode> nodes;
    for (int i = 0; i <= kArmSteps; i += 7) nodes.push_back({t.at(i), Tentacle::radius(float(i) / kArmSteps)});
    Chain& chain = m.add(std::move(nodes), 0.050f, 0.070f);
    m.skin(chain, "Body", 0);
    for (int j = 0; j < kArmJoints; ++j) m.skin(chain, armJoint(arm, j), 0.056f);
}

// --- clips -----------------------------------------------------------------------------------------------------

// A wave runs from the body to the tips; neighbouring arms are a fraction of a cycle apart.
void waveArms(ClipMaker& clip, const std::array<Tentacle, kArms>& tentacles, double phase, double swing, double lift,
              Interpolation interpolation) {
    for (int i = 0; i < kArms; ++i) {
        const Tentacle& t = tentacles[size_t(i)];
        const double shift = phase + i * 0.375;
        for (int j = 0; j < kArmJoints; ++j) {
            const double grow = 0.35 + 0.65 * j / kArmJoints, delay = shift - 0.055 * j;
            const glm::vec3 sideways = t.sideways;
            clip.rotate(
                armJoint(i, j),
                [=](double x) {
                    const double up = 0.5 - 0.5 * double(cosTurns(x + delay));
                    return rotation(kUp, swing * grow * double(sinTurns(x + delay))) *
                           rotation(sideways, -lift *
                                                  (j < 2   ? 1.4
                                                   : j < 7 ? 0.25
                                                           : -0.9) *
                                                  up);
                },
                interpolation);
        }
    }
}

Clip makeWalk(const Rig& rig, const std::array<Tentacle, kArms>& tentacles, double phase) {
    ClipMaker walk(rig, "walk", 1.8f);
    walk.move("Body", [=](double t) {
        return glm::vec3(0.02f * sinTurns(t + phase), 0.03f + 0.03f * sinTurns(2 * t + phase), 0);
    });
    walk.rotate("Body", [=](double t) { return rotation(kForward, 2 * double(sinTurns(t + phase))); });
    walk.rotate("Head", [=](double t) { return rotation(kLeft, 4 * double(sinTurns(2 * t + phase + 0.2))); });
    for (const char* joint : {"Mantle1", "Mantle2", "Mantle3"})
        walk.rotate(joint, [=](double t) {
            return rotation(kLeft, -5 * double(sinTurns(2 * t + phase))) *
                   rotation(kForward, 4 * double(sinTurns(t + phase)));
        });
    for (const float side : {1.0f, -1.0f})
        for (const char* joint : {"Fin1", "Fin2", "Fin3"})
            walk.rotate(sided(side, joint), [=](double t) {
                return rotation(kForward, double(side) * 12 * double(sinTurns(2 * t + phase)));
            });
    waveArms(walk, tentacles, phase, 8, 10, Interpolation::linear);
    return walk.clip;
}

Clip makeIdle(const Rig& rig, const std::array<Tentacle, kArms>& tentacles, double phase) {
    ClipMaker idle(rig, "idle", 4.0f);
    idle.keys = 8;
    const auto breath = [=](double t) { return sinTurns(t + phase); };
    idle.scale(
        "Mantle2", [=](double t) { return glm::vec3(1 + 0.05f * breath(t), 1, 1 + 0.05f * breath(t)); },
        Interpolation::cubicSpline);
    idle.scale(
        "Siphon2", [=](double t) { return glm::vec3(1 - 0.1f * breath(t)); }, Interpolation::cubicSpline);
    for (const float side : {1.0f, -1.0f})
        idle.rotate(
            sided(side, "Eye"), [=](double t) { return rotation(kUp, t < 0.5 ? 9 : -9); }, Interpolation::step);
    waveArms(idle, tentacles, phase, 3.5, 2, Interpolation::cubicSpline);
    return idle.clip;
}

}  // namespace

Scene makeCreature(uint32_t vertices, uint32_t seed) {
    Random random{seed};
    const auto tentacles = makeTentacles(random);
    const float mantle = random.between(0.94f, 1.08f);
    const double phase = double(random.between(0, 1));
    const Rig rig = makeRig(tentacles);
    CreatureMaker maker{rig};
    maker.body.jointPositions = rig.positions;
    addBody(maker, mantle);
    for (int i = 0; i < kArms; ++i) addTentacle(maker, tentacles[size_t(i)], i);
    Scene scene;
    scene.mesh = meshBody(maker.body, vertices);
    scene.skeleton = rig.skeleton;
    scene.clips = {makeWalk(rig, tentacles, phase), makeIdle(rig, tentacles, phase)};
    return scene;
}

}  // namespace skinbench::builtin
