#include "preprocess/key_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/base/parallel.h"
#include "preprocess/cluster_fit.h"
#include "preprocess/pose_table.h"

namespace mdk {
namespace {

constexpr std::uint32_t kKeysPerBlock = 32;

/// Squared distances of one key, summed over corners.
struct KeyResidual {
  double sum = 0, max = 0;

  void add(double squared, double weight) {
    sum += weight * squared;
    max = std::max(max, squared);
  }
};

ResidualStats summarise(std::span<const KeyResidual> keys, std::size_t corners) {
  KeyResidual all;
  for (const KeyResidual& k : keys) {
    all.sum += k.sum;
    all.max = std::max(all.max, k.max);
  }
  const double terms = static_cast<double>(corners) * static_cast<double>(keys.size());
  return {std::sqrt(all.sum / terms), std::sqrt(all.max)};
}

KeyResidual row_residual(const PoseTable& table, const ClusterMembers& members,
                         const ClusterMaps& maps, std::uint32_t row, std::uint32_t rest_row) {
  KeyResidual result;
  for (std::uint32_t c = 0; c < members.cluster_count(); ++c)
    for (std::uint32_t s = members.vertex_begin[c]; s < members.vertex_begin[c + 1]; ++s) {
      const std::uint32_t v = members.vertices[s];
      const Vec3d d = maps.of(c)[row].point(table.position(row, v)) - table.position(rest_row, v);
      result.add(dot(d, d) * table.unit * table.unit, members.uses[s]);
    }
  return result;
}

}  // namespace

KeyMaps fit_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                     std::uint32_t rest_key, std::span<const Affine3d> local_from_rest,
                     double unit) {
  const std::uint32_t keys = sequence.key_count(), clusters = members.cluster_count();
  KeyMaps result;
  result.local_from_world.resize(static_cast<std::size_t>(keys) * clusters);
  std::vector<KeyResidual> residuals(keys);
  for (std::uint32_t first = 0; first < keys; first += kKeysPerBlock) {
    const std::uint32_t count = std::min(kKeysPerBlock, keys - first);
    std::vector<std::uint32_t> block(count);
    for (std::uint32_t i = 0; i < count; ++i) block[i] = first + i;
    block.push_back(rest_key);
    const PoseTable table = make_pose_table(sequence, block, unit);
    const ClusterMaps maps = fit_clusters(table, members, count);
    parallel_chunks(count, 1, [&](std::size_t i, std::size_t) {
      const auto row = static_cast<std::uint32_t>(i);
      for (std::uint32_t c = 0; c < clusters; ++c)
        result.local_from_world[static_cast<std::size_t>(first + row) * clusters + c] =
            to_float(world_map(table, row, local_from_rest[c] * maps.of(c)[row]));
      residuals[first + row] = row_residual(table, members, maps, row, count);
    });
  }
  result.residual = summarise(residuals, 3 * members.triangles.size());
  return result;
}

KeyMaps identity_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                          std::uint32_t rest_key) {
  KeyMaps result;
  result.local_from_world.resize(static_cast<std::size_t>(sequence.key_count()) *
                                 members.cluster_count());
  std::vector<KeyResidual> residuals(sequence.key_count());
  parallel_chunks(residuals.size(), 4, [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3f> rest = sequence.pose(rest_key);
    for (std::size_t key = begin; key < end; ++key) {
      const std::span<const Vec3f> pose = sequence.pose(static_cast<std::uint32_t>(key));
      for (std::size_t s = 0; s < members.vertices.size(); ++s) {
        const std::uint32_t v = members.vertices[s];
        const Vec3d d = to_double(pose[v]) - to_double(rest[v]);
        residuals[key].add(dot(d, d), members.uses[s]);
      }
    }
  });
  result.residual = summarise(residuals, 3 * members.triangles.size());
  return result;
}

}  // namespace mdk
