#include "assets/hand_skeleton.h"

namespace mdk {
namespace {

struct DigitPlan {
  const char* name;
  Vec3d origin;                              ///< first joint
  std::array<Vec3d, kPhalanges> directions;  ///< of the bones, any length
  std::array<double, kPhalanges> lengths;
  Vec3d pad;  ///< the way the finger's soft side looks
};

constexpr Vec3d kFront{0, 0, 1};

// Proportions of a grown hand, 19 cm from wrist to middle fingertip.
const std::array<DigitPlan, kDigits> kPlans = {{
    {"thumb",
     {1.75, 1.3, 0.75},
     {{{2.55, 3.1, 1.0}, {1.5, 2.9, 0.55}, {1.05, 2.9, 0.25}}},
     {4.3, 3.05, 2.25},
     {-0.62, 0.12, 0.78}},
    {"index",
     {2.55, 8.75, -0.05},
     {{{0.15, 1, 0.04}, {0.13, 1, 0.13}, {0.10, 1, 0.24}}},
     {4.25, 2.45, 1.75},
     kFront},
    {"middle",
     {0.72, 9.1, -0.22},
     {{{0.02, 1, 0.02}, {0.015, 1, 0.11}, {0.01, 1, 0.22}}},
     {4.65, 2.85, 1.85},
     kFront},
    {"ring",
     {-1.08, 8.7, -0.12},
     {{{-0.115, 1, 0.05}, {-0.10, 1, 0.15}, {-0.09, 1, 0.26}}},
     {4.3, 2.65, 1.85},
     kFront},
    {"little",
     {-2.72, 7.9, 0.12},
     {{{-0.27, 1, 0.09}, {-0.24, 1, 0.19}, {-0.20, 1, 0.30}}},
     {3.4, 1.95, 1.6},
     kFront},
}};

int add_joint(HandSkeleton& skeleton, RigJoint joint) {
  skeleton.joints.push_back(std::move(joint));
  return static_cast<int>(skeleton.joints.size()) - 1;
}

void add_digit(HandSkeleton& skeleton, int digit, int parent) {
  const DigitPlan& plan = kPlans[static_cast<std::size_t>(digit)];
  Vec3d origin = plan.origin;
  for (std::size_t i = 0; i < kPhalanges; ++i) {
    const Basis rest = basis_along(origin, plan.directions[i], plan.pad);
    parent = add_joint(skeleton, {std::string(plan.name) + "_" + std::to_string(i + 1), parent,
                                  rest, plan.lengths[i]});
    skeleton.digits[static_cast<std::size_t>(digit)][i] = parent;
    origin = rest.to_world({0, plan.lengths[i], 0});
  }
}

/// A joint whose bone points from `from` to the first joint of `digit`.
RigJoint metacarpal(const char* name, int parent, const Vec3d& from, int digit) {
  const Vec3d bone = kPlans[static_cast<std::size_t>(digit)].origin - from;
  return {name, parent, basis_along(from, bone, kFront), length(bone)};
}

}  // namespace

HandSkeleton make_hand_skeleton() {
  HandSkeleton s;
  const Vec3d up{0, 1, 0};
  s.forearm = add_joint(s, {"forearm", -1, basis_along({0, -8, 0}, up, kFront), 4});
  s.forearm_twist =
      add_joint(s, {"forearm_twist", s.forearm, basis_along({0, -4, 0}, up, kFront), 4});
  s.hand = add_joint(s, {"hand", s.forearm_twist, basis_along({0, 0, 0}, up, kFront), 9});
  s.ring_metacarpal = add_joint(s, metacarpal("ring_metacarpal", s.hand, {-0.55, 1.6, -0.1}, 3));
  s.little_metacarpal = add_joint(s, metacarpal("little_metacarpal", s.hand, {-1.2, 1.5, 0.1}, 4));
  add_digit(s, 0, s.hand);
  add_digit(s, 1, s.hand);
  add_digit(s, 2, s.hand);
  add_digit(s, 3, s.ring_metacarpal);
  add_digit(s, 4, s.little_metacarpal);
  return s;
}

}  // namespace mdk
