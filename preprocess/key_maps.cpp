#include "preprocess/key_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "common/base/parallel.h"
#include "common/motion/model.h"
#include "preprocess/basis_search.h"
#include "preprocess/box_clustering.h"
#include "preprocess/cluster_fit.h"
#include "preprocess/fuzzy_boxes.h"
#include "preprocess/pose_table.h"
#include "preprocess/refinement.h"
#include "preprocess/segments.h"

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

/// In units of `unit`.
std::vector<double> model_areas_of(const PoseSequence& sequence, double unit) {
  std::vector<double> areas = pose_box_areas(sequence);
  for (double& a : areas) a /= unit * unit;
  return areas;
}

/// Maps from table coordinates without a common centre as maps from the world.
Affine3f stored_map(const Affine3d& from_table, double unit) {
  Affine3d map = from_table;
  for (auto& row : map.m) row[3] *= unit;
  return to_float(map);
}

/// Summed world area of each cluster's fuzzy boxes, averaged over keys.
std::vector<double> cluster_areas(const ClusterMembers& members, std::span<const Affine3f> maps,
                                  std::span<const Aabb> boxes,
                                  std::span<const double> model_areas) {
  const std::size_t clusters = members.cluster_count();
  std::vector<double> areas(clusters);
  parallel_chunks(clusters, 1, [&](std::size_t c, std::size_t) {
    std::vector<Affine3d> of_cluster;
    for (std::size_t key = 0; key < model_areas.size(); ++key)
      of_cluster.push_back(to_double(maps[key * clusters + c]));
    FaceSums sums;
    for (std::size_t t = members.triangle_begin[c]; t < members.triangle_begin[c + 1]; ++t)
      sums.add(boxes[t]);
    areas[c] = sums.area(mean_area_weights(of_cluster, model_areas, {}));
  });
  return areas;
}

std::vector<double> areas_at_all_times(const PoseSequence& sequence, const ClusterMembers& members,
                                       std::span<const Affine3f> maps,
                                       std::span<const double> model_areas) {
  const Segment all{0, sequence.key_count() - 1};
  return cluster_areas(members, maps, fuzzy_boxes(sequence, members, maps, all), model_areas);
}

/// Puts the refined maps of those clusters in place that they make cheaper at all times.
void accept_better(const PoseSequence& sequence, const ClusterMembers& members,
                   std::span<const Affine3f> refined, std::span<const double> model_areas,
                   KeyMaps& plain) {
  const std::vector<double> before =
      areas_at_all_times(sequence, members, plain.local_from_world, model_areas);
  const std::vector<double> after = areas_at_all_times(sequence, members, refined, model_areas);
  const std::size_t clusters = members.cluster_count();
  double sum_before = 0, sum_after = 0;
  for (std::size_t c = 0; c < clusters; ++c) {
    sum_before += before[c];
    sum_after += std::min(before[c], after[c]);
    if (!(after[c] < before[c])) continue;
    for (std::size_t key = 0; key < model_areas.size(); ++key)
      plain.local_from_world[key * clusters + c] = refined[key * clusters + c];
  }
  plain.refine_gain = sum_before > 0 ? 1 - sum_after / sum_before : 0;
}

}  // namespace

KeyMaps fit_small_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                        const KeyMapRequest& request, const std::function<void(double)>& report) {
  const std::size_t clusters = members.cluster_count(), keys = sequence.key_count();
  const BoxMeasure measure{request.rest_key, model_areas_of(sequence, request.unit), {}, 1};
  KeyMaps plain;
  std::vector<Affine3f> refined;
  plain.local_from_world.resize(keys * clusters);
  if (request.refine) refined.resize(keys * clusters);
  const auto store = [&](std::size_t c, std::span<const Affine3d> maps, std::vector<Affine3f>& to) {
    for (std::size_t key = 0; key < keys; ++key)
      to[key * clusters + c] = stored_map(maps[key], request.unit);
  };
  // A batch at a time, so that whoever listens hears of progress between them.
  constexpr std::size_t kClustersPerBatch = 8;
  constexpr double kFitted = 0.8;  // share of the work; boxes at all times and residuals come after
  for (std::size_t first = 0; first < clusters; first += kClustersPerBatch) {
    report(kFitted * members.vertex_begin[first] / members.vertex_begin[clusters]);
    parallel_chunks(
        std::min(kClustersPerBatch, clusters - first), 1, [&](std::size_t i, std::size_t) {
          const std::size_t c = first + i;
          const ClusterPoints points =
              gather_points(sequence, members, static_cast<std::uint32_t>(c), request.unit);
          const std::vector<Affine3d> fitted = turned_to_small_boxes(
              points, from_centered(points, fit_box_cluster(measure, points).maps),
              measure.model_areas, measure.cost);
          store(c, from_table(points, fitted), plain.local_from_world);
          if (!request.refine) return;
          const std::vector<Affine3d> better =
              refine_maps(points, fitted, measure.model_areas, measure.cost);
          store(c, from_table(points, better), refined);
        });
  }
  report(kFitted);
  if (request.refine) accept_better(sequence, members, refined, measure.model_areas, plain);
  plain.residual = residual_stats(sequence, members, plain.local_from_world, request.rest_key);
  return plain;
}

KeyMaps fit_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                     const KeyMapRequest& request, std::span<const Affine3d> local_from_rest) {
  const std::uint32_t keys = sequence.key_count(), clusters = members.cluster_count();
  KeyMaps result;
  result.local_from_world.resize(static_cast<std::size_t>(keys) * clusters);
  for (std::uint32_t first = 0; first < keys; first += kKeysPerBlock) {
    const std::uint32_t count = std::min(kKeysPerBlock, keys - first);
    std::vector<std::uint32_t> block(count);
    for (std::uint32_t i = 0; i < count; ++i) block[i] = first + i;
    block.push_back(request.rest_key);
    const PoseTable table = make_pose_table(sequence, block, request.unit);
    const ClusterMaps maps = fit_clusters(table, members, count);
    for (std::uint32_t row = 0; row < count; ++row)
      for (std::uint32_t c = 0; c < clusters; ++c)
        result.local_from_world[static_cast<std::size_t>(first + row) * clusters + c] =
            to_float(world_map(table, row, local_from_rest[c] * maps.of(c)[row]));
  }
  result.residual = residual_stats(sequence, members, result.local_from_world, request.rest_key);
  return result;
}

KeyMaps identity_key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                          std::uint32_t rest_key) {
  KeyMaps result;
  result.local_from_world.resize(static_cast<std::size_t>(sequence.key_count()) *
                                 members.cluster_count());
  result.residual = residual_stats(sequence, members, result.local_from_world, rest_key);
  return result;
}

ResidualStats residual_stats(const PoseSequence& sequence, const ClusterMembers& members,
                             std::span<const Affine3f> local_from_world, std::uint32_t rest_key) {
  const std::size_t clusters = members.cluster_count();
  std::vector<KeyResidual> residuals(sequence.key_count());
  parallel_chunks(residuals.size(), 4, [&](std::size_t begin, std::size_t end) {
    const std::span<const Vec3f> rest = sequence.pose(rest_key);
    for (std::size_t key = begin; key < end; ++key) {
      const std::span<const Vec3f> pose = sequence.pose(static_cast<std::uint32_t>(key));
      for (std::size_t c = 0; c < clusters; ++c) {
        const Affine3d map = inverse(to_double(local_from_world[rest_key * clusters + c])) *
                             to_double(local_from_world[key * clusters + c]);
        for (std::uint32_t s = members.vertex_begin[c]; s < members.vertex_begin[c + 1]; ++s) {
          const std::uint32_t v = members.vertices[s];
          const Vec3d d = map.point(to_double(pose[v])) - to_double(rest[v]);
          residuals[key].add(dot(d, d), members.uses[s]);
        }
      }
    }
  });
  return summarise(residuals, 3 * members.triangles.size());
}

}  // namespace mdk
