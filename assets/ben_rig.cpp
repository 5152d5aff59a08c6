#include "assets/ben_rig.h"

#include "assets/wave.h"

namespace mdk {
namespace {

constexpr int kKeys = 30;
constexpr double kKeysPerSecond = 30;
constexpr Vec3d kFront{1, 0, 0};

class RigBuilder {
 public:
  int add(const char* name, int parent, const Vec3d& from, const Vec3d& to) {
    const Vec3d along = to - from;
    // Feet lie along the front: their own front is down.
    const bool lies = along.x > 0.8 * length(along);
    const Basis rest = basis_along(from, along, lies ? Vec3d{0, 1, 0} : kFront);
    rig.joints.push_back({name, parent, rest, length(along)});
    return static_cast<int>(rig.joints.size()) - 1;
  }

  BenRig rig;
};

/// sin and cos of 40 degrees: how far arms hang from the vertical at rest.
constexpr double kArmOut = 0.6427876, kArmDown = 0.7660444;
constexpr double kArmAngle = 40;

BenLimbs add_limbs(RigBuilder& b, int side) {
  const double z = side == 0 ? 1 : -1;
  const std::string prefix = side == 0 ? "right_" : "left_";
  const Vec3d arm{0, -kArmDown, z * kArmOut};
  const Vec3d shoulder{0, 1.435, z * 0.185};
  const Vec3d elbow = shoulder + arm * 0.285, wrist = elbow + arm * 0.25;
  const Vec3d hip{0, 0.93, z * 0.092}, knee{0.012, 0.50, z * 0.098}, ankle{-0.02, 0.085, z * 0.10};
  const Vec3d ball{0.115, 0.035, z * 0.108};
  const auto name = [&](const char* part) { return prefix + part; };
  BenLimbs limbs;
  limbs.upper_arm = b.add(name("upper_arm").c_str(), b.rig.chest, shoulder, elbow);
  limbs.forearm = b.add(name("forearm").c_str(), limbs.upper_arm, elbow, wrist);
  limbs.hand = b.add(name("hand").c_str(), limbs.forearm, wrist, wrist + arm * 0.16);
  limbs.thigh = b.add(name("thigh").c_str(), b.rig.hips, hip, knee);
  limbs.shin = b.add(name("shin").c_str(), limbs.thigh, knee, ankle);
  limbs.foot = b.add(name("foot").c_str(), limbs.shin, ankle, ball);
  limbs.toes = b.add(name("toes").c_str(), limbs.foot, ball, ball + Vec3d{0.075, -0.004, 0});
  return limbs;
}

/// One leg and the opposite arm; `turns` counts strides.
void stride(const BenRig& rig, int side, double turns, std::vector<JointAngles>& pose) {
  const BenLimbs& limbs = rig.sides[static_cast<std::size_t>(side)];
  const auto at = [&](int joint) -> JointAngles& { return pose[static_cast<std::size_t>(joint)]; };
  const double outward = side == 0 ? 1 : -1;
  const double recovery = 0.5 + 0.5 * sine(turns - 0.47);  // the heel comes up behind
  at(limbs.thigh).x = 14 + 40 * cosine(turns) + 4 * sine(2 * turns);
  at(limbs.shin).x = -(14 + 92 * recovery * recovery);
  at(limbs.foot).x = -4 + 22 * sine(turns + 0.62);
  at(limbs.toes).x = 24 * smooth_step(0.3, 1, sine(turns - 0.2));
  at(limbs.upper_arm) = {-6 - 40 * cosine(turns), 0, outward * (kArmAngle - 13)};
  at(limbs.forearm).x = 82 - 20 * cosine(turns);
  at(limbs.hand).x = 8;
}

}  // namespace

BenRig make_ben_rig() {
  RigBuilder b;
  b.rig.hips = b.add("hips", -1, {0, 0.97, 0}, {0, 1.09, 0});
  b.rig.spine = b.add("spine", b.rig.hips, {0, 1.09, 0}, {0, 1.24, 0});
  b.rig.chest = b.add("chest", b.rig.spine, {0, 1.24, 0}, {0, 1.47, 0});
  b.rig.neck = b.add("neck", b.rig.chest, {-0.005, 1.47, 0}, {0.015, 1.57, 0});
  b.rig.head = b.add("head", b.rig.neck, {0.015, 1.57, 0}, {0.02, 1.80, 0});
  for (int side = 0; side < 2; ++side)
    b.rig.sides[static_cast<std::size_t>(side)] = add_limbs(b, side);
  return b.rig;
}

RigClip make_ben_run(const BenRig& rig) {
  RigClip clip{"run", {}, {}, {}};
  for (int key = 0; key < kKeys; ++key) {
    const double turns = 1.0 * key / kKeys;
    clip.times.push_back(key / kKeysPerSecond);
    auto& pose = clip.poses.emplace_back(rig.joints.size());
    const auto at = [&](int joint) -> JointAngles& {
      return pose[static_cast<std::size_t>(joint)];
    };
    stride(rig, 0, turns, pose);
    stride(rig, 1, turns + 0.5, pose);
    const double twist = cosine(turns);
    at(rig.hips) = {5, 7 * twist, 3 * sine(turns)};
    at(rig.spine) = {6, -6 * twist, -2 * sine(turns)};
    at(rig.chest) = {4, -9 * twist, -2 * sine(turns)};
    at(rig.neck) = {-4, 4 * twist, 0};
    at(rig.head) = {-7 + 2 * sine(2 * turns), 4 * twist, 0.5 * sine(turns)};
    clip.root_offsets.push_back({0, 0.035 * cosine(2 * turns + 0.1), 0.01 * sine(turns)});
  }
  return clip;
}

}  // namespace mdk
