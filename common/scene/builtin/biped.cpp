#include <array>

#include "common/scene/builtin/characters.h"
#include "common/scene/builtin/rig.h"
#include "common/scene/builtin/surface.h"

namespace skinbench::builtin {

namespace {

struct Proportions {
    float bulk = 1;  // radii
    float shoulders = 1;
    float legs = 1;
    float arms = 1;
    float head = 1;
    double phase = 0;
};

Proportions makeProportions(uint32_t seed) {
    Random random{seed};
    Proportions p;
    p.bulk = random.between(0.96f, 1.05f);
    p.shoulders = random.between(0.97f, 1.05f);
    p.legs = random.between(0.98f, 1.02f);
    p.arms = random.between(0.98f, 1.03f);
    p.head = random.between(1.03f, 1.10f);
    p.phase = double(random.between(0, 1));
    return p;
}

constexpr std::array kFingers = {"Thumb", "Index", "Middle", "Ring", "Pinky"};

struct Arm {
    glm::vec3 shoulder{0}, elbow{0}, wrist{0}, along{0}, palmDown{0};
};

// The arms hang at 45 degrees, palms facing the thighs.
Arm makeArm(const Proportions& p, float side, float lift) {
    Arm arm;
    const float s = 0.7071068f;
    arm.along = unit({side * s, -s, 0.02f});
    arm.palmDown = {-side * s, -s, 0};
    arm.shoulder = {side * 0.182f * p.shoulders, 1.412f + lift, -0.012f};
    arm.elbow = arm.shoulder + arm.along * (0.275f * p.arms) + glm::vec3(0, 0, -0.012f);
    arm.wrist = arm.elbow + arm.along * (0.245f * p.arms) + glm::vec3(0, 0, 0.016f);
    return arm;
}

struct Finger {
    glm::vec3 base{0}, direction{0};
    float length = 0, radius = 0;
};

Finger makeFinger(const Arm& arm, int f) {
    if (f == 0)
        return {arm.wrist + arm.along * 0.028f + glm::vec3(0, 0, 0.026f) + arm.palmDown * 0.006f,
                unit(arm.along + kForward * 0.85f + arm.palmDown * 0.35f), 0.086f, 0.0130f};
    const std::array<float, 5> spread = {0, 0.20f, 0.06f, -0.07f, -0.22f}, length = {0, 0.082f, 0.092f, 0.085f, 0.068f};
    const float z = 0.0360f - 0.024f * float(f - 1);
    const float reach = f == 4 ? 0.082f : f == 2 ? 0.094f : 0.090f;
    return {arm.wrist + arm.along * reach + glm::vec3(0, 0, z),
            unit(arm.along + kForward * spread[size_t(f)] + arm.palmDown * 0.10f), length[size_t(f)],
            f == 4 ? 0.0105f : 0.0118f};
}

void addArmJoints(Rig& rig, const Arm& arm, float side) {
    const auto chest = int32_t(rig.find("Spine2"));
    const auto clavicle = int32_t(rig.add(sided(side, "Shoulder"), chest, {side * 0.05f, arm.shoulder.y, 0}));
    const auto upper = int32_t(rig.add(sided(side, "Arm"), clavicle, arm.shoulder));
    const auto lower = int32_t(rig.add(sided(side, "ForeArm"), upper, arm.elbow));
    const auto hand = int32_t(rig.add(sided(side, "Hand"), lower, arm.wrist));
    for (int f = 0; f < 5; ++f) {
        const Finger finger = makeFinger(arm, f);
        int32_t parent = hand;
        for (int j = 0; j < 3; ++j)
            parent = int32_t(rig.add(sided(side, "Hand") + kFingers[size_t(f)] + std::to_string(j + 1), parent,
                                     finger.base + finger.direction * (finger.length * 0.36f * float(j))));
    }
}

struct Leg {
    glm::vec3 hip{0}, knee{0}, ankle{0}, ball{0}, toe{0};
};

Leg makeLeg(const Proportions& p, float side) {
    const float ankle = 0.088f;
    const auto height = [&](float y) { return ankle + (y - ankle) * p.legs; };
    return {{side * 0.094f, height(0.925f), 0},
            {side * 0.106f, height(0.505f), 0.012f},
            {side * 0.116f, ankle, -0.028f},
            {side * 0.130f, 0.034f, 0.105f},
            {side * 0.136f, 0.030f, 0.172f}};
}

Rig makeRig(const Proportions& p, float lift) {
    Rig rig;
    const auto spine = [&](const char* name, int32_t parent, float y, float z) {
        return int32_t(rig.add(name, parent, {0, y + lift, z}));
    };
    const int32_t hips = spine("Hips", -1, 0.970f, 0);
    const int32_t chest =
        spine("Spine2", spine("Spine1", spine("Spine", hips, 1.065f, 0.004f), 1.180f, 0.004f), 1.305f, -0.004f);
    const int32_t head = spine("Head", spine("Neck", chest, 1.480f, -0.016f), 1.570f, -0.004f);
    spine("Jaw", head, 1.600f, 0.030f);
    for (const float side : {1.0f, -1.0f}) rig.add(sided(side, "Eye"), head, {side * 0.034f, 1.668f + lift, 0.078f});
    for (const float side : {1.0f, -1.0f}) addArmJoints(rig, makeArm(p, side, lift), side);
    for (const float side : {1.0f, -1.0f}) {
        const Leg leg = makeLeg(p, side);
        const auto upper = int32_t(rig.add(sided(side, "UpLeg"), hips, leg.hip));
        const auto lower = int32_t(rig.add(sided(side, "Leg"), upper, leg.knee));
        const auto foot = int32_t(rig.add(sided(side, "Foot"), lower, leg.ankle));
        rig.add(sided(side, "ToeBase"), foot, leg.ball);
    }
    return rig;
}

// --- shape -----------------------------------------------------------------------------------------------------

struct BipedMaker {
    const Rig& rig;
    const Proportions& p;
    float lift = 0;
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
    glm::vec3 at(float x, float y, float z) const { return {x, y + lift, z}; }
};

void addTorso(BipedMaker& m) {
    const float b = m.p.bulk;
    Chain& torso = m.add({{m.at(0, 0.915f, -0.004f), 0.080f * b},
                          {m.at(0, 0.965f, -0.006f), 0.104f * b},
                          {m.at(0, 1.030f, 0), 0.096f * b},
                          {m.at(0, 1.110f, 0.006f), 0.087f * b},
                          {m.at(0, 1.200f, 0.006f), 0.096f * b},
                          {m.at(0, 1.310f, 0.002f), 0.112f * b},
                          {m.at(0, 1.385f, -0.006f), 0.100f * b},
                          {m.at(0, 1.435f, -0.012f), 0.066f * b}},
                         0.035f, 0.080f);
    torso.wide = 1.42f;
    m.skin(torso, "Hips", 0);
    m.skin(torso, "Spine", 0.105f);
    m.skin(torso, "Spine1", 0.105f);
    m.skin(torso, "Spine2", 0.116f);
    for (const float side : {1.0f, -1.0f}) {
        const float reach = 0.150f * m.p.shoulders;
        Chain& clavicle = m.add(
            {{m.at(side * 0.020f, 1.452f, -0.024f), 0.046f * b}, {m.at(side * reach, 1.412f, -0.014f), 0.054f * b}},
            0.035f, 0.050f);
        m.skin(clavicle, "Spine2", 0);
        m.skin(clavicle, sided(side, "Shoulder"), 0.063f);
        m.skin(clavicle, sided(side, "Arm"), 0.095f);
        Chain& breast = m.add(
            {{m.at(side * 0.045f, 1.345f, 0.052f), 0.056f * b}, {m.at(side * 0.110f, 1.360f, 0.036f), 0.052f * b}},
            0.035f, 0.040f);
        m.skin(breast, "Spine2", 0);
        Chain& seat = m.add({{m.at(side * 0.068f, 0.930f, -0.056f), 0.070f * b}}, 0.035f, 0.040f);
        m.skin(seat, "Hips", 0);
    }
    Chain& belt = m.add({{m.at(0, 1.016f, 0.001f), 0.101f * b}, {m.at(0, 1.044f, 0.002f), 0.099f * b}}, 0.008f, 0.012f);
    belt.wide = 1.42f;
    m.skin(belt, "Hips", 0);
}

void addHead(BipedMaker& m) {
    const float h = m.p.head;
    const auto face = [&](float x, float y, float z) { return m.at(x * h, 1.570f + (y - 1.570f) * h, z * h); };
    Chain& neck = m.add({{m.at(0, 1.430f, -0.022f), 0.066f},
                         {m.at(0, 1.500f, -0.014f), 0.054f},
                         {face(0, 1.600f, -0.004f), 0.053f * h}},
                        0.030f, 0.040f);
    m.skin(neck, "Spine2", 0);
    m.skin(neck, "Neck", 0.063f);
    m.skin(neck, "Head", 0.063f);
    Chain& skull =
        m.add({{face(0, 1.660f, 0.006f), 0.075f * h}, {face(0, 1.712f, -0.006f), 0.082f * h}}, 0.025f, 0.030f);
    skull.wide = 1.16f;
    skull.wideAxis = kForward;
    m.skin(skull, "Head", 0);
    Chain& cheeks =
        m.add({{face(0, 1.668f, 0.046f), 0.050f * h}, {face(0, 1.622f, 0.050f), 0.043f * h}}, 0.025f, 0.030f);
    cheeks.wide = 1.15f;
    m.skin(cheeks, "Head", 0);
    Chain& jaw = m.add({{face(0, 1.612f, 0.030f), 0.046f * h}, {face(0, 1.588f, 0.068f), 0.025f * h}}, 0.025f, 0.030f);
    jaw.wide = 1.2f;
    m.skin(jaw, "Jaw", 0);
    Chain& nose = m.add({{face(0, 1.680f, 0.093f), 0.0075f * h},
                         {face(0, 1.648f, 0.108f), 0.0100f * h},
                         {face(0, 1.640f, 0.104f), 0.0115f * h}},
                        0.012f, 0.014f);
    m.skin(nose, "Head", 0);
    Chain& lips = m.add({{face(-0.017f, 1.6125f, 0.0850f), 0.0045f * h},
                         {face(0, 1.6140f, 0.0925f), 0.0060f * h},
                         {face(0.017f, 1.6125f, 0.0850f), 0.0045f * h}},
                        0.008f, 0.012f);
    m.skin(lips, "Jaw", 0);
    Chain& hair =
        m.add({{face(0, 1.712f, -0.026f), 0.0895f * h}, {face(0, 1.668f, -0.040f), 0.0700f * h}}, 0.012f, 0.012f);
    hair.wide = 1.04f;
    m.skin(hair, "Head", 0);
    for (const float side : {1.0f, -1.0f}) {
        Chain& brow = m.add({{face(side * 0.012f, 1.690f, 0.0900f), 0.0070f * h},
                             {face(side * 0.030f, 1.693f, 0.0835f), 0.0075f * h},
                             {face(side * 0.048f, 1.688f, 0.0700f), 0.0060f * h}},
                            0.012f, 0.014f);
        m.skin(brow, "Head", 0);
        Chain& eye = m.add({{face(side * 0.031f, 1.672f, 0.0800f), 0.0145f * h}}, 0.006f, 0.006f);
        m.skin(eye, sided(side, "Eye"), 0);
        Chain& ear = m.add(
            {{face(side * 0.080f, 1.645f, 0.002f), 0.0085f * h}, {face(side * 0.086f, 1.674f, -0.006f), 0.0125f * h}},
            0.010f, 0.010f);
        m.skin(ear, "Head", 0);
    }
}

void addArm(BipedMaker& m, float side) {
    const float b = m.p.bulk;
    const Arm arm = makeArm(m.p, side, m.lift);
    const auto between = [&](glm::vec3 from, glm::vec3 to, float t, float radius) {
        return ShapeNode{from + (to - from) * t, radius * b};
    };
    Chain& limb =
        m.add({between(arm.shoulder, arm.elbow, -0.02f, 0.060f), between(arm.shoulder, arm.elbow, 0.22f, 0.061f),
               between(arm.shoulder, arm.elbow, 0.55f, 0.050f), between(arm.shoulder, arm.elbow, 0.95f, 0.039f),
               between(arm.elbow, arm.wrist, 0.25f, 0.045f), between(arm.elbow, arm.wrist, 0.60f, 0.036f),
               between(arm.elbow, arm.wrist, 0.98f, 0.026f)},
              0.030f, 0.045f);
    m.skin(limb, sided(side, "Arm"), 0);
    m.skin(limb, sided(side, "ForeArm"), 0.116f);
    m.skin(limb, sided(side, "Hand"), 0.095f);
    Chain& cuff = m.add({between(arm.elbow, arm.wrist, 0.80f, 0.0375f), between(arm.elbow, arm.wrist, 0.86f, 0.0375f)},
                        0.008f, 0.010f);
    m.skin(cuff, sided(side, "ForeArm"), 0.0f);
    Chain& palm = m.add({{arm.wrist + arm.along * 0.010f, 0.019f},
                         {arm.wrist + arm.along * 0.050f, 0.0195f},
                         {arm.wrist + arm.along * 0.080f, 0.0165f}},
                        0.016f, 0.020f);
    palm.wide = 2.2f;
    palm.wideAxis = kForward;
    m.skin(palm, sided(side, "Hand"), 0);
    for (int f = 0; f < 5; ++f) {
        const Finger finger = makeFinger(arm, f);
        const auto knuckle = [&](float t, float r) {
            return ShapeNode{finger.base + finger.direction * (finger.length * t), finger.radius * r};
        };
        Chain& chain =
            m.add({knuckle(-0.15f, 1.1f), knuckle(0.15f, 1.0f), knuckle(0.55f, 0.97f), knuckle(0.97f, 0.84f)}, 0.010f,
                  0.016f);
        m.skin(chain, sided(side, "Hand"), 0);
        for (int j = 1; j <= 3; ++j)
            m.skin(chain, sided(side, "Hand") + kFingers[size_t(f)] + std::to_string(j), 0.018f);
    }
}

void addLeg(BipedMaker& m, float side) {
    const float b = m.p.bulk;
    const Leg leg = makeLeg(m.p, side);
    const auto between = [&](glm::vec3 from, glm::vec3 to, float t, float z, float radius) {
        return ShapeNode{from + (to - from) * t + glm::vec3(0, 0, z), radius * b};
    };
    Chain& limb = m.add(
        {between(leg.hip, leg.knee, 0.0f, 0, 0.090f), between(leg.hip, leg.knee, 0.25f, 0.004f, 0.088f),
         between(leg.hip, leg.knee, 0.60f, 0.004f, 0.072f), between(leg.hip, leg.knee, 0.98f, 0, 0.054f),
         between(leg.knee, leg.ankle, 0.28f, -0.016f, 0.058f), between(leg.knee, leg.ankle, 0.65f, -0.006f, 0.045f),
         between(leg.knee, leg.ankle, 1.0f, 0.004f, 0.040f)},
        0.030f, 0.055f);
    m.skin(limb, sided(side, "UpLeg"), 0);
    m.skin(limb, sided(side, "Leg"), 0.137f);
    m.skin(limb, sided(side, "Foot"), 0.105f);
    Chain& shaft = m.add(
        {between(leg.knee, leg.ankle, 0.38f, -0.012f, 0.064f), between(leg.knee, leg.ankle, 0.55f, -0.010f, 0.060f),
         between(leg.knee, leg.ankle, 0.80f, 0.000f, 0.051f), between(leg.knee, leg.ankle, 1.05f, 0.004f, 0.048f)},
        0.010f, 0.020f);
    m.skin(shaft, sided(side, "Leg"), 0);
    m.skin(shaft, sided(side, "Foot"), 0.105f);
    Chain& boot = m.add({{leg.ankle + glm::vec3(0, -0.044f, -0.030f), 0.044f},
                         {leg.ankle + glm::vec3(0.002f * side, -0.036f, 0.030f), 0.049f},
                         {leg.ball + glm::vec3(0, 0.004f, -0.010f), 0.037f},
                         {leg.toe, 0.030f}},
                        0.026f, 0.030f);
    boot.wide = 1.22f;
    m.skin(boot, sided(side, "Foot"), 0);
    m.skin(boot, sided(side, "ToeBase"), 0.063f);
}

// --- clips -----------------------------------------------------------------------------------------------------

void walkLeg(ClipMaker& walk, float side, double phase) {
    // The leg swings forward while sin falls; a negative turn about x brings it forward.
    walk.rotate(sided(side, "UpLeg"), [=](double t) { return rotation(kLeft, -4 - 26 * double(sinTurns(t + phase))); });
    walk.rotate(sided(side, "Leg"), [=](double t) {
        const double swing = double(sinTurns(t + phase + 0.20));
        const double lifted = double(cosTurns(t + phase));
        return rotation(kLeft, 10 + 6 * swing + (lifted > 0 ? 44 * lifted * lifted : 0));
    });
    walk.rotate(sided(side, "Foot"),
                [=](double t) { return rotation(kLeft, -2 - 9 * double(sinTurns(t + phase + 0.05))); });
    walk.rotate(sided(side, "ToeBase"), [=](double t) {
        const double push = double(sinTurns(t + phase + 0.42));
        return rotation(kLeft, push > 0 ? -22 * push * push : 0);
    });
}

void walkArm(ClipMaker& walk, float side, double phase) {
    // From 45 degrees down to the side, then the swing against the leg of that side.
    walk.rotate(sided(side, "Arm"), [=](double t) {
        return rotation(kLeft, 3 + 24 * double(sinTurns(t + phase))) * rotation(kForward, double(side) * -34);
    });
    walk.rotate(sided(side, "ForeArm"), [=](double t) {
        return rotation(unit({1, double(side) > 0 ? 0.9f : -0.9f, 0}), -20 + 12 * double(sinTurns(t + phase)));
    });
    const glm::vec3 curl = unit({side * -0.1f, 0.1f, side * -1.0f});
    for (size_t f = 1; f < kFingers.size(); ++f)
        for (int j = 1; j <= 3; ++j)
            walk.rotate(sided(side, "Hand") + kFingers[f] + std::to_string(j),
                        [=](double t) { return rotation(curl, 16 + 3 * double(sinTurns(t + phase))); });
}

Clip makeBipedWalk(const Rig& rig, double phase) {
    ClipMaker walk(rig, "walk", 1.1f);
    walk.move("Hips", [=](double t) {
        return glm::vec3(0.012f * cosTurns(t + phase), -0.022f - 0.016f * cosTurns(2 * (t + phase) + 0.5), 0);
    });
    walk.rotate("Hips", [=](double t) {
        return rotation(kUp, 6 * double(sinTurns(t + phase))) * rotation(kForward, 2.5 * double(cosTurns(t + phase)));
    });
    for (const char* joint : {"Spine", "Spine1", "Spine2"})
        walk.rotate(joint,
                    [=](double t) { return rotation(kUp, -5 * double(sinTurns(t + phase))) * rotation(kLeft, 1.5); });
    walk.rotate("Neck", [=](double t) { return rotation(kUp, 4 * double(sinTurns(t + phase))); });
    walk.rotate("Head", [=](double t) {
        return rotation(kUp, 5 * double(sinTurns(t + phase))) * rotation(kLeft, -3 + double(cosTurns(2 * t)));
    });
    for (const float side : {1.0f, -1.0f}) {
        walkLeg(walk, side, side > 0 ? phase : phase + 0.5);
        walkArm(walk, side, side > 0 ? phase : phase + 0.5);
    }
    return walk.clip;
}

Clip makeIdle(const Rig& rig, double phase) {
    ClipMaker idle(rig, "idle", 3.0f);
    idle.keys = 8;
    const auto breath = [=](double t) { return double(sinTurns(t + phase)); };
    idle.move(
        "Hips", [=](double t) { return glm::vec3(0.006f * sinTurns(t + phase), 0, 0); }, Interpolation::cubicSpline);
    idle.rotate(
        "Spine1", [=](double t) { return rotation(kLeft, 1.2 * breath(t)); }, Interpolation::cubicSpline);
    idle.rotate(
        "Spine2", [=](double t) { return rotation(kLeft, -1.8 * breath(t)); }, Interpolation::cubicSpline);
    idle.scale(
        "Spine2", [=](double t) { return glm::vec3(1 + 0.008f * float(breath(t))); }, Interpolation::cubicSpline);
    idle.rotate("Head", [=](double t) { return rotation(kUp, 14 * breath(t + 0.3)) * rotation(kLeft, 2 * breath(t)); });
    for (const float side : {1.0f, -1.0f}) {
        idle.rotate(sided(side, "Arm"), [=](double t) { return rotation(kForward, side * (-33 + breath(t))); });
        idle.rotate(sided(side, "ForeArm"), [=](double t) { return rotation(kLeft, -14 + 2 * breath(t)); });
        idle.rotate(
            sided(side, "Eye"), [=](double t) { return rotation(kUp, t < 0.5 ? 8 : -8); }, Interpolation::step);
    }
    return idle.clip;
}

}  // namespace

Scene makeBiped(uint32_t vertices, uint32_t seed) {
    const Proportions p = makeProportions(seed);
    const float lift = (p.legs - 1) * 0.83f;  // longer legs carry the rest higher
    const Rig rig = makeRig(p, lift);
    BipedMaker maker{rig, p, lift};
    maker.body.jointPositions = rig.positions;
    maker.body.smallestWeight = 0.01f;
    addTorso(maker);
    addHead(maker);
    for (const float side : {1.0f, -1.0f}) {
        addArm(maker, side);
        addLeg(maker, side);
    }
    Scene scene;
    scene.mesh = meshBody(maker.body, vertices);
    scene.skeleton = rig.skeleton;
    scene.clips = {makeBipedWalk(rig, p.phase), makeIdle(rig, p.phase)};
    return scene;
}

}  // namespace skinbench::builtin
