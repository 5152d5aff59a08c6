#include "preprocess/maps/key_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>

#include "common/base/parallel.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/boxes/fuzzy_boxes.h"
#include "preprocess/maps/affine_fit.h"
#include "preprocess/maps/cluster_maps.h"

namespace mdk {
namespace {

constexpr std::uint32_t kKeysPerBlock = 32;

/// Squared distances of a part of the work, summed over corners.
struct ResidualSum {
  double sum = 0, max = 0;

  void add(double squared, double weight) {
    sum += weight * squared;
    max = std::max(max, squared);
  }
};

ResidualStats summarise(std::span<const ResidualSum> parts, const ClusterMembers& members,
                        std::size_t keys) {
  ResidualSum all;
  for (const ResidualSum& part : parts) {
    all.sum += part.sum;
    all.max = std::max(all.max, part.max);
  }
  const double terms =
      3.0 * static_cast<double>(members.triangles.size()) * static_cast<double>(keys);
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
    areas[c] = sums.area(mean_area_weights(of_cluster, model_areas));
  });
  return areas;
}

std::vector<double> areas_at_all_times(const PoseSequence& sequence, const ClusterMembers& members,
                                       std::span<const Affine3f> maps,
                                       std::span<const double> model_areas, BetweenKeys between) {
  const Segment all{0, sequence.key_count() - 1};
  return cluster_areas(members, maps, fuzzy_boxes(sequence, members, maps, all, between),
                       model_areas);
}

/// Puts the refined maps of those clusters in place that they make cheaper at all times.
void accept_better(const PoseSequence& sequence, const ClusterMembers& members,
                   std::span<const Affine3f> refined, std::span<const double> model_areas,
                   BetweenKeys between, KeyMaps& plain) {
  const std::vector<double> before =
      areas_at_all_times(sequence, members, plain.local_from_world, model_areas, between);
  const std::vector<double> after =
      areas_at_all_times(sequence, members, refined, model_areas, between);
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

/// The inverse of the linear part, where it loses few digits.
std::optional<Affine3d> linear_inverse(const Affine3d& a) {
  constexpr double kMaxCondition = 1e4;
  Affine3d linear = a;
  for (auto& row : linear.m) row[3] = 0;
  if (linear.determinant() == 0) return std::nullopt;
  const Affine3d undo = inverse(linear);
  const auto squared_norm = [](const Affine3d& m) {
    return dot(m.column(0), m.column(0)) + dot(m.column(1), m.column(1)) +
           dot(m.column(2), m.column(2));
  };
  if (!(squared_norm(linear) * squared_norm(undo) <= kMaxCondition * kMaxCondition))
    return std::nullopt;
  return undo;
}

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

KeyMaps fit_small_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                        const KeyMapRequest& request, const std::function<void(double)>& report) {
  const std::size_t clusters = members.cluster_count(), keys = sequence.key_count();
  const BoxMeasure measure{request.rest_key, model_areas_of(sequence, request.unit), 1};
  KeyMaps plain;
  std::vector<Affine3f> refined;
  plain.local_from_world.resize(keys * clusters);
  if (request.refine) refined.resize(keys * clusters);
  const auto store = [&](std::size_t c, std::span<const Affine3d> maps, std::vector<Affine3f>& to) {
    for (std::size_t key = 0; key < keys; ++key)
      to[key * clusters + c] = stored_map(maps[key], request.unit);
  };
  // A batch at a time, so that progress can be reported between them.
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
              measure.model_areas);
          store(c, from_table(points, fitted), plain.local_from_world);
          if (!request.refine) return;
          const std::vector<Affine3d> better = refine_maps(points, fitted, measure.model_areas);
          store(c, from_table(points, better), refined);
        });
  }
  report(kFitted);
  if (request.refine)
    accept_better(sequence, members, refined, measure.model_areas, request.between, plain);
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
    const std::vector<Affine3d> maps = fit_clusters(table, members, count);
    for (std::uint32_t row = 0; row < count; ++row)
      for (std::uint32_t c = 0; c < clusters; ++c)
        result.local_from_world[static_cast<std::size_t>(first + row) * clusters + c] =
            to_float(world_map(table, row, local_from_rest[c] * maps[c * table.row_count() + row]));
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

std::vector<Affine3d> base_from_world(const Rig& rig, std::uint32_t bone,
                                      std::span<const std::uint32_t> keys,
                                      std::uint32_t key_count) {
  const std::size_t bones = rig.bone_maps.size() / key_count;
  const auto map_at = [&](std::uint32_t key) {
    return to_double(rig.bone_maps[key * bones + bone]);
  };
  std::optional<Affine3d> linear;
  for (std::size_t i = 0; i < keys.size() && !linear; ++i) linear = linear_inverse(map_at(keys[i]));
  if (!linear) linear = Affine3d{};
  std::vector<Affine3d> maps;
  for (const std::uint32_t key : keys) {
    const Affine3d world = map_at(key);
    if (const auto own = linear_inverse(world)) linear = own;
    Affine3d map = *linear;
    const Vec3d shift = map.vector(world.column(3));
    for (int i = 0; i < 3; ++i) map.m[i][3] = -shift[static_cast<std::size_t>(i)];
    maps.push_back(map);
  }
  return maps;
}

std::vector<Affine3d> base_from_table(const Rig& rig, std::uint32_t bone, const PoseTable& table,
                                      std::uint32_t key_count) {
  std::vector<Affine3d> maps = base_from_world(rig, bone, table.keys, key_count);
  for (std::size_t row = 0; row < maps.size(); ++row)
    maps[row] = scaled(1 / table.unit) * maps[row] * moved(table.centers[row]) * scaled(table.unit);
  return maps;
}

std::vector<ClusterBone> choose_bone_bases(const PoseSequence& sequence, const PoseTable& table,
                                           const ClusterMembers& members,
                                           std::span<const std::uint32_t> bones) {
  std::vector<Affine3d> maps;  // cluster-major, in table units on both sides
  for (const std::uint32_t bone : bones) {
    const std::vector<Affine3d> from_table =
        base_from_table(*sequence.rig, bone, table, sequence.key_count());
    maps.insert(maps.end(), from_table.begin(), from_table.end());
  }
  const LocalFrames frames = choose_local_frames(table, members, maps);
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
  std::vector<ResidualSum> residuals(clusters);
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
        residuals[c].add(dot(d, d), members.uses[s]);
      }
    }
  });
  result.residual = summarise(residuals, members, keys.size());
  return result;
}

ResidualStats residual_stats(const PoseSequence& sequence, const ClusterMembers& members,
                             std::span<const Affine3f> local_from_world, std::uint32_t rest_key) {
  const std::size_t clusters = members.cluster_count();
  std::vector<ResidualSum> residuals(sequence.key_count());
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
  return summarise(residuals, members, residuals.size());
}

}  // namespace mdk
