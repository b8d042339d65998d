#include <array>
#include <cmath>

#include "common/scene/builtin/characters.h"
#include "common/scene/builtin/rig.h"
#include "common/scene/builtin/solids.h"

namespace skinbench::builtin {

namespace {

struct Machine {
    Rig rig{};
    std::vector<Solid> solids{};
    float bulk = 1;

    uint32_t joint(const std::string& name, const std::string& parent, glm::vec3 position) {
        return rig.add(name, parent.empty() ? -1 : int32_t(rig.find(parent)), position);
    }
    void add(Solid s) {
        for (const Solid& other : solids) s.detail = s.detail || other.joint == s.joint;
        solids.push_back(s);
    }
    void box(uint32_t joint, glm::vec3 centre, glm::vec3 half, float bevel) {
        Solid s;
        s.joint = joint;
        s.centre = centre;
        s.half = half;
        s.bevel = bevel;
        add(s);
    }
    void ball(uint32_t joint, glm::vec3 centre, float radius) { box(joint, centre, glm::vec3(radius), radius); }
    void lathe(uint32_t joint, glm::vec3 centre, Axis axis, float bottom, float top, float length, float bevel) {
        Solid s;
        s.kind = Solid::Kind::lathe;
        s.joint = joint;
        s.centre = centre;
        s.axis = axis;
        s.bottom = bottom;
        s.top = top;
        s.length = length;
        s.bevel = bevel;
        add(s);
    }
};

void addTrunk(Machine& m) {
    const float b = m.bulk;
    const uint32_t pelvis = m.joint("Pelvis", "", {0, 0.90f, 0});
    m.box(pelvis, {0, 0.905f, 0}, {0.135f * b, 0.055f, 0.090f}, 0.022f);
    m.box(pelvis, {0, 0.860f, 0}, {0.045f, 0.060f, 0.070f}, 0.020f);
    const uint32_t waist = m.joint("Waist", "Pelvis", {0, 0.97f, 0});
    for (int i = 0; i < 3; ++i)
        m.lathe(waist, {0, 0.980f + 0.040f * float(i), 0}, Axis::y, 0.082f, 0.082f, 0.0185f, 0.008f);
    const uint32_t torso = m.joint("Torso", "Waist", {0, 1.09f, 0});
    m.box(torso, {0, 1.130f, 0}, {0.130f * b, 0.055f, 0.100f}, 0.025f);
    m.box(torso, {0, 1.300f, 0}, {0.205f * b, 0.130f, 0.130f}, 0.040f);
    for (const float side : {1.0f, -1.0f})
        m.box(torso, {side * 0.098f * b, 1.330f, 0.125f}, {0.078f * b, 0.066f, 0.024f}, 0.014f);
    m.lathe(torso, {0, 1.205f, 0.128f}, Axis::z, 0.050f, 0.042f, 0.016f, 0.007f);
    const uint32_t pack = m.joint("Backpack", "Torso", {0, 1.30f, -0.13f});
    m.box(pack, {0, 1.310f, -0.170f}, {0.140f * b, 0.110f, 0.050f}, 0.025f);
    for (const float side : {1.0f, -1.0f})
        m.lathe(pack, {side * 0.075f * b, 1.185f, -0.175f}, Axis::y, 0.048f, 0.030f, 0.038f, 0.008f);
    const uint32_t neck = m.joint("Neck", "Torso", {0, 1.43f, 0});
    m.lathe(neck, {0, 1.455f, 0}, Axis::y, 0.058f, 0.048f, 0.040f, 0.010f);
}

void addHead(Machine& m, float size) {
    const auto at = [&](float x, float y, float z) {
        return glm::vec3(x * size, 1.50f + (y - 1.50f) * size, z * size);
    };
    const uint32_t head = m.joint("Head", "Neck", {0, 1.49f, 0});
    m.box(head, at(0, 1.605f, 0), glm::vec3(0.115f, 0.100f, 0.110f) * size, 0.036f * size);
    m.box(head, at(0, 1.700f, -0.010f), glm::vec3(0.026f, 0.022f, 0.090f) * size, 0.012f * size);
    m.box(head, at(0, 1.625f, 0.103f), glm::vec3(0.094f, 0.034f, 0.020f) * size, 0.016f * size);
    for (const float side : {1.0f, -1.0f}) {
        m.lathe(head, at(side * 0.042f, 1.625f, 0.122f), Axis::z, 0.023f * size, 0.020f * size, 0.012f * size, 0.005f);
        m.lathe(head, at(side * 0.118f, 1.605f, 0), Axis::x, 0.044f * size, 0.044f * size, 0.016f * size, 0.007f);
        const uint32_t antenna = m.joint(sided(side, "Antenna"), "Head", at(side * 0.125f, 1.64f, -0.01f));
        m.lathe(antenna, at(side * 0.128f, 1.690f, -0.010f), Axis::y, 0.010f * size, 0.007f * size, 0.075f * size,
                0.003f);
        m.ball(antenna, at(side * 0.128f, 1.775f, -0.010f), 0.016f * size);
    }
    const uint32_t jaw = m.joint("Jaw", "Head", at(0, 1.56f, 0.04f));
    m.box(jaw, at(0, 1.545f, 0.088f), glm::vec3(0.058f, 0.026f, 0.034f) * size, 0.014f * size);
}

void addArm(Machine& m, float side, float length) {
    const float x = side * 0.305f * m.bulk;
    const auto at = [&](float dx, float y, float z) {
        return glm::vec3(x + side * dx, 1.375f + (y - 1.375f) * length, z);
    };
    const uint32_t shoulder = m.joint(sided(side, "Shoulder"), "Torso", {side * 0.21f * m.bulk, 1.375f, 0});
    m.lathe(shoulder, at(-0.085f, 1.375f, 0), Axis::x, 0.050f, 0.050f, 0.030f, 0.010f);
    const uint32_t upper = m.joint(sided(side, "UpperArm"), sided(side, "Shoulder"), at(0, 1.375f, 0));
    m.ball(upper, at(0, 1.375f, 0), 0.078f);
    m.box(upper, at(0.022f, 1.425f, 0), {0.080f, 0.040f, 0.095f}, 0.026f);
    m.lathe(upper, at(0, 1.235f, 0), Axis::y, 0.046f, 0.050f, 0.085f, 0.010f);
    const uint32_t lower = m.joint(sided(side, "ForeArm"), sided(side, "UpperArm"), at(0, 1.115f, 0));
    m.lathe(lower, at(0, 1.115f, 0), Axis::x, 0.056f, 0.056f, 0.050f, 0.012f);
    m.lathe(lower, at(0, 0.965f, 0), Axis::y, 0.070f, 0.050f, 0.100f, 0.014f);
    m.box(lower, at(0.060f, 0.960f, 0), {0.018f, 0.080f, 0.036f}, 0.010f);
    const uint32_t hand = m.joint(sided(side, "Hand"), sided(side, "ForeArm"), at(0, 0.865f, 0));
    m.lathe(hand, at(0, 0.850f, 0), Axis::y, 0.034f, 0.034f, 0.025f, 0.008f);
    m.box(hand, at(0, 0.795f, 0), {0.032f, 0.042f, 0.055f}, 0.016f);
    const std::array<glm::vec3, 3> fingers = {at(0.006f, 0.745f, 0.033f), at(0.006f, 0.745f, -0.033f),
                                              at(-0.034f, 0.775f, 0.030f)};
    for (size_t f = 0; f < fingers.size(); ++f) {
        const uint32_t finger = m.joint(sided(side, "Finger") + std::to_string(f + 1), sided(side, "Hand"), fingers[f]);
        const glm::vec3 half = f == 2 ? glm::vec3(0.013f, 0.034f, 0.015f) : glm::vec3(0.016f, 0.044f, 0.021f);
        m.box(finger, fingers[f] - glm::vec3(0, half.y * 0.8f, 0), half, 0.011f);
    }
}

void addLeg(Machine& m, float side) {
    const float x = side * 0.118f * m.bulk;
    const auto at = [&](float dx, float y, float z) { return glm::vec3(x + side * dx, y, z); };
    const uint32_t hip = m.joint(sided(side, "Hip"), "Pelvis", at(0, 0.855f, 0));
    m.ball(hip, at(0, 0.850f, 0), 0.070f);
    m.box(hip, at(0.066f, 0.850f, 0), {0.018f, 0.055f, 0.060f}, 0.012f);
    const uint32_t thigh = m.joint(sided(side, "Thigh"), sided(side, "Hip"), at(0, 0.850f, 0));
    m.box(thigh, at(0, 0.695f, 0), {0.066f, 0.125f, 0.078f}, 0.030f);
    const uint32_t shin = m.joint(sided(side, "Shin"), sided(side, "Thigh"), at(0, 0.515f, 0));
    m.lathe(shin, at(0, 0.515f, 0), Axis::x, 0.062f, 0.062f, 0.064f, 0.014f);
    m.box(shin, at(0, 0.515f, 0.060f), {0.042f, 0.054f, 0.022f}, 0.014f);
    m.lathe(shin, at(0, 0.400f, 0), Axis::y, 0.058f, 0.045f, 0.065f, 0.012f);
    m.box(shin, at(0, 0.250f, -0.008f), {0.078f, 0.125f, 0.088f}, 0.034f);
    const uint32_t foot = m.joint(sided(side, "Foot"), sided(side, "Shin"), at(0, 0.105f, -0.010f));
    m.lathe(foot, at(0, 0.105f, -0.010f), Axis::x, 0.045f, 0.045f, 0.055f, 0.010f);
    m.box(foot, at(0, 0.048f, -0.005f), {0.080f, 0.048f, 0.105f}, 0.024f);
    const uint32_t toe = m.joint(sided(side, "Toe"), sided(side, "Foot"), at(0, 0.035f, 0.100f));
    m.box(toe, at(0, 0.034f, 0.150f), {0.078f, 0.034f, 0.058f}, 0.022f);
}

void walkSide(ClipMaker& walk, float side, double phase) {
    const auto wave = [=](double t, double shift) { return double(sinTurns(t + phase + shift)); };
    walk.rotate(sided(side, "Thigh"), [=](double t) { return rotation(kLeft, -5 - 22 * wave(t, 0)); });
    walk.rotate(sided(side, "Shin"), [=](double t) {
        const double lifted = wave(t, 0.25);
        return rotation(kLeft, 9 + 4 * wave(t, 0.2) + (lifted > 0 ? 36 * lifted * lifted : 0));
    });
    walk.rotate(sided(side, "Foot"), [=](double t) { return rotation(kLeft, -3 - 9 * wave(t, 0.05)); });
    walk.rotate(sided(side, "UpperArm"),
                [=](double t) { return rotation(kLeft, 4 + 24 * wave(t, 0)) * rotation(kForward, double(side) * 5); });
    walk.rotate(sided(side, "ForeArm"), [=](double t) { return rotation(kLeft, -26 + 12 * wave(t, 0.02)); });
    for (const char* finger : {"Finger1", "Finger2", "Finger3"})
        walk.rotate(sided(side, finger),
                    [=](double t) { return rotation(kForward, double(side) * (-8 + 6 * wave(t, 0))); });
    walk.rotate(sided(side, "Antenna"), [=](double t) { return rotation(kLeft, 5 * wave(2 * t, 0)); });
}

Clip makeRobotWalk(const Rig& rig, double phase) {
    ClipMaker walk(rig, "walk", 1.3f);
    walk.move("Pelvis", [=](double t) { return glm::vec3(0, -0.018f - 0.014f * cosTurns(2 * (t + phase)), 0); });
    walk.rotate("Pelvis", [=](double t) { return rotation(kUp, 5 * double(sinTurns(t + phase))); });
    walk.rotate("Torso", [=](double t) { return rotation(kUp, -9 * double(sinTurns(t + phase))); });
    walk.rotate("Head", [=](double t) { return rotation(kUp, 4 * double(sinTurns(t + phase))); });
    walkSide(walk, 1, phase);
    walkSide(walk, -1, phase + 0.5);
    return walk.clip;
}

// Machines look around in jerks: the head's channel steps.
Clip makeWave(const Rig& rig, double phase) {
    ClipMaker wave(rig, "wave", 2.4f);
    wave.keys = 12;
    wave.rotate(
        "Head",
        [=](double t) {
            return rotation(kUp, t < 0.25 ? 0 : t < 0.5 ? 24 : t < 0.75 ? 8 : -18);
        },
        Interpolation::step);
    wave.rotate(
        "RightUpperArm", [=](double t) { return rotation(kForward, -112 + 4 * double(sinTurns(t + phase))); },
        Interpolation::cubicSpline);
    wave.rotate(
        "RightForeArm", [=](double t) { return rotation(kForward, -48 + 24 * double(sinTurns(2 * t + phase))); },
        Interpolation::cubicSpline);
    wave.rotate("LeftForeArm", [=](double t) { return rotation(kLeft, -12 + 3 * double(sinTurns(t + phase))); });
    wave.rotate("Jaw", [=](double t) { return rotation(kLeft, 5 + 5 * double(sinTurns(4 * t + phase))); });
    return wave.clip;
}

// The counts fall as the spacing grows: halve the interval.
float fitSpacing(const std::vector<Solid>& solids, uint32_t vertices) {
    float fine = 0.0002f, coarse = 0.5f;
    for (int i = 0; i < 40; ++i) {
        const float middle = 0.5f * (fine + coarse);
        uint32_t count = 0;
        for (const Solid& s : solids) count += countVertices(s, middle);
        (count > vertices ? fine : coarse) = middle;
    }
    return coarse;
}

}  // namespace

Scene makeRobot(uint32_t vertices, uint32_t seed) {
    Random random{seed};
    Machine m;
    m.bulk = random.between(0.95f, 1.08f);
    const float head = random.between(0.95f, 1.08f), arms = random.between(0.96f, 1.05f);
    const double phase = double(random.between(0, 1));
    addTrunk(m);
    addHead(m, head);
    for (const float side : {1.0f, -1.0f}) {
        addArm(m, side, arms);
        addLeg(m, side);
    }
    Scene scene;
    const float spacing = fitSpacing(m.solids, vertices);
    for (const Solid& s : m.solids) addSolid(s, spacing, scene.mesh);
    scene.skeleton = m.rig.skeleton;
    scene.clips = {makeRobotWalk(m.rig, phase), makeWave(m.rig, phase)};
    return scene;
}

}  // namespace skinbench::builtin
