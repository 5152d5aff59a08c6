#include "assets/ben_weights.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mdk {
namespace {

constexpr int kWeightSum = 65535;
constexpr int kRounds = 36;

struct Capsule {
  int joint = 0;
  Vec3d a, b;
  double radius = 0;
};

std::vector<Capsule> capsules(const BenRig& rig) {
  std::vector<Capsule> all;
  const auto add = [&](int joint, double radius) {
    all.push_back({joint, rig.rest(joint).origin, rig.on_bone(joint, 1), radius});
  };
  all.push_back({rig.hips, {-0.01, 0.98, -0.07}, {-0.01, 0.98, 0.07}, 0.115});
  add(rig.spine, 0.12);
  all.push_back({rig.chest, {0, 1.33, -0.06}, {0, 1.33, 0.06}, 0.14});
  all.push_back({rig.chest, {-0.01, 1.445, -0.13}, {-0.01, 1.445, 0.13}, 0.062});
  add(rig.neck, 0.058);
  all.push_back({rig.head, {0.01, 1.66, 0}, {0.01, 1.74, 0}, 0.10});
  for (const BenLimbs& limbs : rig.sides) {
    add(limbs.upper_arm, 0.055);
    add(limbs.forearm, 0.038);
    add(limbs.hand, 0.040);
    all.push_back(
        {limbs.thigh, rig.on_bone(limbs.thigh, 0.12), rig.on_bone(limbs.thigh, 1), 0.075});
    add(limbs.shin, 0.045);
    add(limbs.foot, 0.045);
    add(limbs.toes, 0.040);
  }
  return all;
}

double distance(const Capsule& c, const Vec3d& p) {
  const Vec3d axis = c.b - c.a;
  const double t = std::clamp(dot(p - c.a, axis) / dot(axis, axis), 0.0, 1.0);
  return length(p - c.a - axis * t) - c.radius;
}

int owner(const std::vector<Capsule>& bones, const Vec3d& p) {
  double nearest = 1e9;
  int joint = 0;
  for (const Capsule& bone : bones) {
    const double d = distance(bone, p);
    if (d >= nearest) continue;
    nearest = d;
    joint = bone.joint;
  }
  return joint;
}

std::vector<std::vector<std::uint32_t>> neighbours(const TriangleMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> around(mesh.positions.size());
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) around[t[i]].push_back(t[(i + 1) % 3]);
  return around;  // closed meshes: each neighbour once
}

/// The four largest shares, which sum to 65535.
void keep_four(const std::vector<float>& shares, BenWeights& out) {
  std::vector<std::pair<float, std::uint8_t>> sorted;
  for (std::size_t j = 0; j < shares.size(); ++j)
    if (shares[j] > 0.004f) sorted.push_back({shares[j], static_cast<std::uint8_t>(j)});
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (sorted.size() > 4) sorted.resize(4);
  double sum = 0;
  for (const auto& [share, joint] : sorted) sum += static_cast<double>(share);
  auto& joints = out.joints.emplace_back();
  auto& weights = out.weights.emplace_back();
  int left = kWeightSum;
  for (std::size_t i = sorted.size(); i-- > 0;) {
    joints[i] = sorted[i].second;
    const auto part =
        static_cast<int>(std::floor(static_cast<double>(sorted[i].first) / sum * kWeightSum + 0.5));
    weights[i] = static_cast<std::uint16_t>(i == 0 ? left : std::min(part, left));
    left -= weights[i];
  }
}

}  // namespace

BenWeights ben_weights(const TriangleMesh& mesh, const BenRig& rig) {
  const std::vector<Capsule> bones = capsules(rig);
  const auto around = neighbours(mesh);
  std::vector<std::vector<float>> shares;
  for (const Vec3d& p : mesh.positions) {
    shares.emplace_back(rig.joints.size(), 0.f);
    shares.back()[static_cast<std::size_t>(owner(bones, p))] = 1;
  }
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::vector<float>> next = shares;
    for (std::size_t v = 0; v < shares.size(); ++v) {
      const float part = 0.6f / static_cast<float>(around[v].size());
      for (std::size_t j = 0; j < rig.joints.size(); ++j) {
        float sum = 0;
        for (const std::uint32_t n : around[v]) sum += shares[n][j];
        next[v][j] = 0.4f * shares[v][j] + part * sum;
      }
    }
    shares.swap(next);
  }
  BenWeights out;
  for (const std::vector<float>& share : shares) keep_four(share, out);
  return out;
}

}  // namespace mdk
