#include "preprocess/pose/pose_space.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace mdk {
namespace {

/// Bones whose chains stretch one way so much more than another lose too many digits.
constexpr double kMaxCondition = 1e4;
/// Of a handful of float roundings per number on the way to a posed vertex; generous.
constexpr double kRounding = 0x1p-19;

struct Stretch {
  double min = 1, max = 1;
};

/// How much shorter or longer the linear part makes a vector.
Stretch stretch_of(const Affine3d& a) {
  Eigen::Matrix3d linear;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) linear(i, j) = a.m[i][j];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squared(linear.transpose() * linear,
                                                               Eigen::EigenvaluesOnly);
  constexpr double kSlack = 1e-9;
  return {std::sqrt(std::max(0.0, squared.eigenvalues()(0))) * (1 - kSlack),
          std::sqrt(std::max(0.0, squared.eigenvalues()(2))) * (1 + kSlack)};
}

/// A cap about `center` as seen from the origin, turned to by at most `limit`, all of it `radius`
/// thicker.
struct Cap {
  Vec3d center;
  double radius = 0, limit = 0;

  PoseSpace::Ball ball() const {
    const double far = length(center);
    if (limit >= std::numbers::pi / 2) return {{}, far + radius};
    return {center * std::cos(limit), far * std::sin(limit) + radius};
  }
  /// Largest value of dot(direction, p) over the cap.
  double support(const Vec3d& direction) const {
    const double far = length(center), size = length(direction);
    if (!(far > 0) || !(size > 0)) return size * radius;
    const double cosine = std::clamp(dot(direction, center) / (far * size), -1.0, 1.0);
    const double angle = std::max(0.0, std::acos(cosine) - limit);
    return size * (far * std::cos(angle) + radius);
  }
};

Aabbd cap_box(const Cap& cap, const Affine3d& map) {
  Aabbd box;
  for (int i = 0; i < 3; ++i) {
    const Vec3d row{map.m[i][0], map.m[i][1], map.m[i][2]};
    const auto axis = static_cast<std::size_t>(i);
    box.lo[axis] = map.m[i][3] - cap.support(row * -1.0);
    box.hi[axis] = map.m[i][3] + cap.support(row);
  }
  return box;
}

void add_scaled(Aabbd& sum, const Aabbd& box, double weight) {
  const Vec3d a = box.lo * weight, b = box.hi * weight;
  sum.lo = sum.lo + Vec3d{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
  sum.hi = sum.hi + Vec3d{std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// The joint and its ancestors, itself first.
std::vector<std::uint32_t> ancestors(const SkeletonView& skeleton, std::uint32_t joint) {
  std::vector<std::uint32_t> chain;
  for (; joint != kNoParent; joint = skeleton.joints[joint].parent) chain.push_back(joint);
  return chain;
}

/// Size of the numbers that a bone's map to the world has, when its joints turn as they may.
struct ChainSize {
  Stretch linear;
  double translation = 0;
};

ChainSize chain_size(const SkeletonView& skeleton, const BoneBinding& bone) {
  ChainSize size;
  const auto follow = [&](const Affine3d& map) {
    const Stretch stretch = stretch_of(map);
    size.linear.min *= stretch.min;
    size.linear.max *= stretch.max;
    size.translation = stretch.max * size.translation + length(map.column(3));
  };
  follow(to_double(bone.joint_from_base));
  for (const std::uint32_t j : ancestors(skeleton, bone.joint)) {
    follow(scaling(skeleton.joints[j].scale));
    follow(to_double(skeleton.joints[j].parent_from_joint));
  }
  return size;
}

}  // namespace

PoseSpace::PoseSpace(const SkeletonView& skeleton, const RigView& rig, std::uint32_t key_count)
    : skeleton_(skeleton), rig_(rig) {
  const std::size_t targets = rig.target_weights.size() / key_count;
  min_weights_.assign(rig.target_weights.begin(),
                      rig.target_weights.begin() + static_cast<std::ptrdiff_t>(targets));
  max_weights_ = min_weights_;
  for (std::size_t i = 0; i < rig.target_weights.size(); ++i) {
    float &least = min_weights_[i % targets], &largest = max_weights_[i % targets];
    least = std::min(least, rig.target_weights[i]);
    largest = std::max(largest, rig.target_weights[i]);
  }
  std::vector<ChainSize> chains;
  for (const BoneBinding& bone : skeleton.bones) chains.push_back(chain_size(skeleton, bone));
  for (std::uint32_t v = 0; v < rig.base_positions.size(); ++v) {
    const Ball ball = base_ball(v);
    double sum = 0;
    for (std::uint32_t i = rig.first_weight[v]; i < rig.first_weight[v + 1]; ++i) {
      const ChainSize& chain = chains[rig.bone_weights[i].bone];
      sum += std::abs(double{rig.bone_weights[i].weight}) *
             (chain.linear.max * (length(ball.center) + ball.radius) + chain.translation);
    }
    reach_ = std::max(reach_, sum);
  }
}

PoseSpace::Ball PoseSpace::base_ball(std::uint32_t vertex) const {
  Ball ball{to_double(rig_.base_positions[vertex])};
  if (rig_.first_offset.empty()) return ball;
  for (std::uint32_t i = rig_.first_offset[vertex]; i < rig_.first_offset[vertex + 1]; ++i) {
    const MorphOffset& morph = rig_.morph_offsets[i];
    const double least = min_weights_[morph.target], largest = max_weights_[morph.target];
    const Vec3d offset = to_double(morph.offset);
    ball.center = ball.center + offset * (0.5 * (least + largest));
    ball.radius += 0.5 * (largest - least) * length(offset);
  }
  return ball;
}

BoneSpace::BoneSpace(const PoseSpace& space, std::uint32_t bone) : space_(space), bone_(bone) {
  const ChainSize chain = chain_size(space.skeleton(), space.skeleton().bones[bone]);
  const double condition = chain.linear.max / chain.linear.min;
  usable_ = condition <= kMaxCondition;
  if (!usable_) return;
  origin_distance_ = chain.translation / chain.linear.min;
  rounding_ = kRounding * condition * (space.reach() / chain.linear.min + origin_distance_);
}

BoneSpace::Path BoneSpace::make_path(std::uint32_t from) const {
  const SkeletonView& skeleton = space_.skeleton();
  const BoneBinding &source = skeleton.bones[from], &target = skeleton.bones[bone_];
  std::vector<std::uint32_t> up = ancestors(skeleton, source.joint);
  std::vector<std::uint32_t> down = ancestors(skeleton, target.joint);
  while (!up.empty() && !down.empty() && up.back() == down.back()) {
    up.pop_back();
    down.pop_back();
  }
  Path path;
  Affine3d map = to_double(source.joint_from_base);
  const auto turn = [&](float limit) {
    path.maps.push_back(map);
    path.limits.push_back(limit);
  };
  for (const std::uint32_t j : up) {
    const Joint& joint = skeleton.joints[j];
    map = scaling(joint.scale) * map;
    turn(joint.limit);
    map = to_double(joint.parent_from_joint);
  }
  for (auto j = down.rbegin(); j != down.rend(); ++j) {
    const Joint& joint = skeleton.joints[*j];
    map = inverse(to_double(joint.parent_from_joint)) * map;
    turn(joint.limit);
    map = inverse(scaling(joint.scale));
  }
  path.maps.push_back(inverse(to_double(target.joint_from_base)) * map);
  for (const Affine3d& m : path.maps) path.stretch.push_back(stretch_of(m).max);
  return path;
}

const BoneSpace::Path& BoneSpace::path_from(std::uint32_t bone) {
  const auto [place, is_new] = paths_.try_emplace(bone);
  if (is_new) place->second = make_path(bone);
  return place->second;
}

Aabbd BoneSpace::vertex_box(std::uint32_t vertex, const Affine3d& local_from_base) {
  const RigView& rig = space_.rig();
  const PoseSpace::Ball base = space_.base_ball(vertex);
  Aabbd sum{{0, 0, 0}, {0, 0, 0}};
  double weights = 0;
  for (std::uint32_t i = rig.first_weight[vertex]; i < rig.first_weight[vertex + 1]; ++i) {
    const BoneWeight& influence = rig.bone_weights[i];
    const Path& path = path_from(influence.bone);
    Cap cap{base.center, base.radius, 0};
    for (std::size_t turn = 0; turn < path.limits.size(); ++turn) {
      const PoseSpace::Ball ball = cap.ball();
      cap = {path.maps[turn].point(ball.center), path.stretch[turn] * ball.radius,
             path.limits[turn]};
    }
    add_scaled(sum, cap_box(cap, local_from_base * path.maps.back()), influence.weight);
    weights += influence.weight;
  }
  // The run time sums in the world and maps the sum. Where the weights do not add up to 1, that
  // puts the world's origin, as seen from here, into the sum once more.
  const double missing = 1 - weights;
  const double pad_in_base = rounding_ + std::abs(missing) * origin_distance_;
  for (int i = 0; i < 3; ++i) {
    const auto axis = static_cast<std::size_t>(i);
    const Vec3d row{local_from_base.m[i][0], local_from_base.m[i][1], local_from_base.m[i][2]};
    const double shift = missing * local_from_base.m[i][3], pad = pad_in_base * length(row);
    sum.lo[axis] += shift - pad;
    sum.hi[axis] += shift + pad;
  }
  return sum;
}

}  // namespace mdk
