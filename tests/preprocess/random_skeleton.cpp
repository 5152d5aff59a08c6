#include "tests/preprocess/random_skeleton.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

constexpr std::uint32_t kJoints = 9, kTriangles = 60, kTargets = 2;

double any(std::mt19937& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

Vec3d random_turn(std::mt19937& random, double angle) {
  Vec3d axis;
  do {
    axis = random_point(random, 1);
  } while (length(axis) < 0.1);
  return axis * (angle / length(axis));
}

Skeleton random_skeleton(std::mt19937& random, double limit) {
  Skeleton skeleton;
  for (std::uint32_t j = 0; j < kJoints; ++j) {
    Joint joint;
    if (j > 0) joint.parent = static_cast<std::uint32_t>(any(random, 0, j));
    if (j == kJoints - 1) joint.parent = kNoParent;  // a second root
    joint.limit = static_cast<float>(limit);
    Affine3d rest = rotation(random_turn(random, any(random, 0, 2)));
    for (int i = 0; i < 3; ++i) rest.m[i][3] = any(random, -1, 1);
    joint.parent_from_joint = to_float(rest);
    if (j % 4 == 2) joint.scale = {1.3f, 1.3f, 1.3f};
    if (j % 4 == 3) joint.scale = {0.8f, 1.1f, 0.9f};
    const std::string name = "joint " + std::to_string(j);
    joint.name_offset = static_cast<std::uint32_t>(skeleton.names.size());
    joint.name_bytes = static_cast<std::uint32_t>(name.size());
    skeleton.names.insert(skeleton.names.end(), name.begin(), name.end());
    skeleton.joints.push_back(joint);
  }
  const SkeletonPose rest{std::vector<Vec3d>(kJoints), {}};
  const std::vector<Affine3d> world = world_from_joints(skeleton.view(), rest);
  for (std::uint32_t j = 0; j < kJoints; ++j)
    skeleton.bones.push_back({j, to_float(inverse(world[j]))});
  return skeleton;
}

/// Weights of one to three bones that add up to 1 as floats do.
void add_weights(Rig& rig, std::uint32_t near, std::mt19937& random) {
  const std::uint32_t count = 1 + static_cast<std::uint32_t>(any(random, 0, 3));
  std::vector<BoneWeight> weights;
  for (std::uint32_t i = 0; i < count; ++i)
    weights.push_back({(near + 2 * i) % kJoints, static_cast<float>(any(random, 0.1, 1))});
  std::sort(weights.begin(), weights.end(),
            [](const BoneWeight& a, const BoneWeight& b) { return a.bone < b.bone; });
  float sum = 0;
  for (const BoneWeight& w : weights) sum += w.weight;
  for (BoneWeight& w : weights) w.weight /= sum;
  rig.bone_weights.insert(rig.bone_weights.end(), weights.begin(), weights.end());
  rig.first_weight.push_back(static_cast<std::uint32_t>(rig.bone_weights.size()));
}

void add_offsets(Rig& rig, std::mt19937& random) {
  for (std::uint32_t target = 0; target < kTargets; ++target)
    if (any(random, 0, 1) < 0.3)
      rig.morph_offsets.push_back({target, to_float(random_point(random, 0.2))});
  rig.first_offset.push_back(static_cast<std::uint32_t>(rig.morph_offsets.size()));
}

Rig random_rig(const Skeleton& skeleton, std::mt19937& random) {
  const SkeletonPose rest{std::vector<Vec3d>(kJoints), {}};
  const std::vector<Affine3d> world = world_from_joints(skeleton.view(), rest);
  Rig rig;
  rig.first_weight = rig.first_offset = {0};
  for (std::uint32_t t = 0; t < kTriangles; ++t) {
    const std::uint32_t near = t % kJoints;
    const Vec3d center = world[near].point(random_point(random, 0.3));
    for (int corner = 0; corner < 3; ++corner) {
      rig.base_positions.push_back(to_float(center + random_point(random, 0.2)));
      add_weights(rig, near, random);
      add_offsets(rig, random);
    }
  }
  return rig;
}

}  // namespace

SkinnedMesh random_skinned_mesh(std::uint32_t seed, std::uint32_t keys, double limit) {
  std::mt19937 random(seed);
  SkinnedMesh mesh;
  mesh.skeleton = random_skeleton(random, limit);
  PoseSequence& s = mesh.sequence;
  s.rig = random_rig(mesh.skeleton, random);
  s.vertex_count = static_cast<std::uint32_t>(s.rig->base_positions.size());
  for (std::uint32_t t = 0; t < kTriangles; ++t)
    s.triangles.push_back({{3 * t, 3 * t + 1, 3 * t + 2}});
  s.clips = {{"poses", 0, keys}};
  for (std::uint32_t key = 0; key < keys; ++key) {
    s.key_times.push_back(key / 30.0);
    SkeletonPose pose;
    for (std::uint32_t j = 0; j < kJoints; ++j)
      pose.turns.push_back(random_turn(random, any(random, 0, 0.3 * limit)));
    for (std::uint32_t i = 0; i < kTargets; ++i)
      pose.target_weights.push_back(static_cast<float>(any(random, -0.2, 1)));
    const std::vector<Affine3f> maps = bone_maps(mesh.skeleton.view(), pose);
    s.rig->bone_maps.insert(s.rig->bone_maps.end(), maps.begin(), maps.end());
    s.rig->target_weights.insert(s.rig->target_weights.end(), pose.target_weights.begin(),
                                 pose.target_weights.end());
    mesh.key_poses.push_back(std::move(pose));
  }
  decode_positions(s);
  s.appearance.materials.resize(1);
  s.appearance.triangle_materials.assign(kTriangles, 0);
  s.skeleton = mesh.skeleton;
  return mesh;
}

SkeletonPose random_pose(const SkinnedMesh& mesh, double share, std::mt19937& random) {
  const Skeleton& skeleton = mesh.skeleton;
  SkeletonPose pose;
  for (const Joint& joint : skeleton.joints) {
    const double most = share * joint.limit * (1 - 1e-7);
    const Vec3d turn = random_turn(random, random() % 2 == 0 ? most : any(random, 0, most));
    pose.turns.push_back(random() % 8 == 0 ? Vec3d{} : turn);
  }
  const auto key = [&] { return random() % mesh.key_poses.size(); };
  const auto &a = mesh.key_poses[key()].target_weights, &b = mesh.key_poses[key()].target_weights;
  const auto s = static_cast<float>(any(random, 0, 1));
  for (std::size_t i = 0; i < a.size(); ++i)
    pose.target_weights.push_back(random() % 3 == 0 ? a[i] : a[i] + s * (b[i] - a[i]));
  return pose;
}

}  // namespace mdk
