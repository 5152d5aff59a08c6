#include "preprocess/bone_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "preprocess/bone_clusters.h"
#include "preprocess/local_frame.h"

namespace mdk {
namespace {

Affine3d scaled(double s) {
  Affine3d a;
  for (int i = 0; i < 3; ++i) a.m[i][i] = s;
  return a;
}

Affine3d moved(const Vec3d& by) {
  Affine3d a;
  for (int i = 0; i < 3; ++i) a.m[i][3] = by[static_cast<std::size_t>(i)];
  return a;
}

std::vector<std::uint32_t> all_keys(const PoseSequence& sequence) {
  std::vector<std::uint32_t> keys(sequence.key_count());
  std::iota(keys.begin(), keys.end(), 0u);
  return keys;
}

}  // namespace

std::vector<ClusterBone> choose_bone_bases(const PoseSequence& sequence, const PoseTable& table,
                                           const ClusterMembers& members,
                                           std::span<const std::uint32_t> bones) {
  std::vector<Affine3d> maps;  // cluster-major, in table units on both sides
  for (const std::uint32_t bone : bones) {
    const std::vector<Affine3d> from_world =
        base_from_world(*sequence.rig, bone, table.keys, sequence.key_count());
    for (std::size_t row = 0; row < from_world.size(); ++row)
      maps.push_back(scaled(1 / table.unit) * from_world[row] * moved(table.centers[row]) *
                     scaled(table.unit));
  }
  const LocalFrames frames = choose_local_frames(table, members, maps, {});
  std::vector<ClusterBone> result;
  for (std::size_t c = 0; c < bones.size(); ++c)
    result.push_back({bones[c], to_float(scaled(table.unit) * frames.local_from_rest[c] *
                                         scaled(1 / table.unit))});
  return result;
}

KeyMaps bone_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                      std::span<const ClusterBone> bones, std::uint32_t rest_key) {
  const std::vector<std::uint32_t> keys = all_keys(sequence);
  const std::size_t clusters = bones.size();
  KeyMaps result;
  result.local_from_world.resize(keys.size() * clusters);
  std::vector<ResidualStats> residuals(clusters);  // rms: still the sum of squares
  parallel_chunks(clusters, 1, [&](std::size_t c, std::size_t) {
    const std::vector<Affine3d> from_world =
        base_from_world(*sequence.rig, bones[c].bone, keys, sequence.key_count());
    for (std::size_t key = 0; key < keys.size(); ++key)
      result.local_from_world[key * clusters + c] =
          to_float(to_double(bones[c].local_from_base) * from_world[key]);
    const auto local = [&](std::uint32_t key, std::uint32_t vertex) {
      return from_world[key].point(to_double(sequence.pose(key)[vertex]));
    };
    for (std::uint32_t s = members.vertex_begin[c]; s < members.vertex_begin[c + 1]; ++s) {
      const Vec3d rest = local(rest_key, members.vertices[s]);
      for (const std::uint32_t key : keys) {
        const Vec3d d = local(key, members.vertices[s]) - rest;
        residuals[c].rms += members.uses[s] * dot(d, d);
        residuals[c].max = std::max(residuals[c].max, dot(d, d));
      }
    }
  });
  for (const ResidualStats& r : residuals) {
    result.residual.rms += r.rms;
    result.residual.max = std::max(result.residual.max, r.max);
  }
  const double terms =
      3.0 * static_cast<double>(members.triangles.size()) * static_cast<double>(keys.size());
  result.residual = {std::sqrt(result.residual.rms / terms), std::sqrt(result.residual.max)};
  return result;
}

std::vector<Aabb> pose_space_boxes(const PoseSpace& space, const ClusterMembers& members,
                                   std::span<const ClusterBone> bones) {
  std::vector<Aabb> boxes(members.triangles.size());
  parallel_chunks(bones.size(), 1, [&](std::size_t c, std::size_t) {
    BoneSpace seen(space, bones[c].bone);
    if (!seen.is_usable())
      throw Error(ErrorCode::kBadInput,
                  "bone " + std::to_string(bones[c].bone) +
                      " is flat or a point at rest, so nothing can be bounded in its basis: "
                      "repair its scale, or bake with --sampling cycle");
    const std::uint32_t first = members.vertex_begin[c];
    std::vector<Aabbd> vertices;
    for (std::uint32_t s = first; s < members.vertex_begin[c + 1]; ++s)
      vertices.push_back(seen.vertex_box(members.vertices[s], to_double(bones[c].local_from_base)));
    for (std::uint32_t t = members.triangle_begin[c]; t < members.triangle_begin[c + 1]; ++t) {
      Aabbd box;
      for (std::size_t corner = 0; corner < 3; ++corner)
        box.extend(vertices[members.corner_slots[std::size_t{3} * t + corner] - first]);
      boxes[t] = round_outward(box);
    }
  });
  return boxes;
}

}  // namespace mdk
