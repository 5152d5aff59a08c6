//        c
//       / \          Neighbours ask for the same middles, so the
//     ca - bc        finer mesh is as closed as the one it is made of.
//     / \ / \.
//    a - ab - b
#include "assets/triangle_split.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace mdk {
namespace {

constexpr int kWeightSum = 65535;

template <class Color>
Color mean_color(const Color& a, const Color& b) {
  Color out;
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint8_t>((a[i] + b[i] + 1) / 2);
  return out;
}

/// Joints and weights half way between two vertices.
void add_mean_influence(GlbMesh& mesh, const std::array<std::uint32_t, 2>& parents) {
  std::map<std::uint8_t, int> shares;
  for (const std::uint32_t v : parents)
    for (std::size_t i = 0; i < 4; ++i)
      if (mesh.weights[v][i] > 0) shares[mesh.joints[v][i]] += mesh.weights[v][i];
  std::vector<std::pair<std::uint8_t, int>> sorted(shares.begin(), shares.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  if (sorted.size() > 4) sorted.resize(4);
  int sum = 0;
  for (const auto& [joint, share] : sorted) sum += share;
  std::array<std::uint8_t, 4> joints{};
  std::array<std::uint16_t, 4> weights{};
  int left = kWeightSum;
  for (std::size_t i = sorted.size(); i-- > 0;) {
    joints[i] = sorted[i].first;
    const auto part = std::int64_t{sorted[i].second} * kWeightSum / sum;
    weights[i] = static_cast<std::uint16_t>(i == 0 ? left : part);
    left -= weights[i];
  }
  mesh.joints.push_back(joints);
  mesh.weights.push_back(weights);
}

}  // namespace

TriangleSplit split_triangles(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                              std::size_t vertex_count) {
  TriangleSplit split;
  std::unordered_map<std::uint64_t, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const auto next = static_cast<std::uint32_t>(vertex_count + split.parents.size());
    const auto [it, is_new] = middles.try_emplace(std::uint64_t{low} << 32 | high, next);
    if (is_new) split.parents.push_back({low, high});
    return it->second;
  };
  for (const auto& [a, b, c] : triangles) {
    const std::uint32_t ab = middle(a, b);
    const std::uint32_t bc = middle(b, c);
    const std::uint32_t ca = middle(c, a);
    split.triangles.push_back({a, ab, ca});
    split.triangles.push_back({ab, b, bc});
    split.triangles.push_back({ca, bc, c});
    split.triangles.push_back({ab, bc, ca});
  }
  return split;
}

void split_mesh(GlbMesh& mesh) {
  TriangleSplit split = split_triangles(mesh.triangles, mesh.positions.size());
  mesh.triangles = std::move(split.triangles);
  for (const auto& parents : split.parents) {
    const auto [a, b] = parents;
    mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
    mesh.normals.push_back(normalized(mesh.normals[a] + mesh.normals[b], mesh.normals[a]));
    mesh.colors.push_back(mean_color(mesh.colors[a], mesh.colors[b]));
    if (!mesh.joints.empty()) add_mean_influence(mesh, parents);
  }
}

void split_sequence(SampleSequence& sequence) {
  TriangleSplit split = split_triangles(sequence.triangles, sequence.colors.size());
  sequence.triangles = std::move(split.triangles);
  for (const auto& [a, b] : split.parents)
    sequence.colors.push_back(mean_color(sequence.colors[a], sequence.colors[b]));
  for (std::vector<Vec3d>& pose : sequence.poses)
    for (const auto& [a, b] : split.parents) pose.push_back((pose[a] + pose[b]) * 0.5);
}

}  // namespace mdk
