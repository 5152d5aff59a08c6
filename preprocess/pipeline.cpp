#include "preprocess/pipeline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/stopwatch.h"
#include "preprocess/bone_clusters.h"
#include "preprocess/bone_maps.h"
#include "preprocess/cluster_growth.h"
#include "preprocess/key_maps.h"
#include "preprocess/key_sampling.h"
#include "preprocess/local_frame.h"
#include "preprocess/model_assembly.h"
#include "preprocess/pose_space.h"
#include "preprocess/segments.h"

namespace mdk {
namespace {

constexpr std::uint32_t kMaxClusters = 1024;
constexpr float kLargestCoordinate = 1e15f;  // areas and volumes must stay far inside float

// Clusters are grown on few keys and polished on many: entries (keys times vertices) of the tables.
constexpr std::size_t kGrowthEntries = 250'000;
constexpr std::uint32_t kMinGrowthKeys = 10, kMaxGrowthKeys = 48;
constexpr std::size_t kPolishEntries = 8'000'000;
constexpr std::size_t kBoneEntries = 2'000'000;  // keys that bones are chosen on
constexpr std::uint32_t kMaxBoneKeys = 200;
constexpr LloydOptions kPolish = {.min_gain = 0.002, .max_rounds = 8};

void check_positions(const PoseSequence& sequence) {
  constexpr std::size_t kChunk = 1 << 16;
  parallel_chunks(sequence.positions.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f& v = sequence.positions[i];
      const bool usable = std::abs(v.x) <= kLargestCoordinate &&
                          std::abs(v.y) <= kLargestCoordinate &&
                          std::abs(v.z) <= kLargestCoordinate;
      if (!usable)
        throw Error(ErrorCode::kBadInput,
                    "a vertex position is not a number between -1e15 and 1e15: repair or rescale "
                    "the animation");
    }
  });
}

void check_bone_options(const PoseSequence& sequence, const DecomposeOptions& options) {
  if (options.mode == DecomposeMode::kBones && !sequence.rig)
    throw Error(ErrorCode::kBadInput,
                "the animation has no bones, only positions: bake it with --decompose motion");
  if (options.sampling == PoseSampling::kCycle) return;
  if (options.mode != DecomposeMode::kBones)
    throw Error(ErrorCode::kUsage, "--sampling pose-space needs --decompose bones");
  if (!sequence.skeleton)
    throw Error(ErrorCode::kBadInput,
                "the animation has no skeleton to pose: bake it with --sampling cycle");
  if (!(options.joint_limit_degrees >= 0 && options.joint_limit_degrees <= 180))
    throw Error(ErrorCode::kUsage, "the joints' limit must be from 0 to 180 degrees");
  if (options.segments > 1)
    throw Error(ErrorCode::kUsage,
                "a pose space has no time to be cut into segments: leave --segments out");
}

void check_input(const PoseSequence& sequence, const DecomposeOptions& options) {
  if (sequence.triangles.empty())
    throw Error(ErrorCode::kBadInput, "the mesh has no triangles: nothing can be decomposed");
  if (sequence.key_count() == 0)
    throw Error(ErrorCode::kBadInput, "the mesh has no poses: nothing can be decomposed");
  if (options.rest_key && *options.rest_key >= sequence.key_count())
    throw Error(ErrorCode::kUsage,
                std::string("rest pose ").append(std::to_string(*options.rest_key)) +
                    " does not exist: choose a key from 0 to " +
                    std::to_string(sequence.key_count() - 1));
  const std::size_t most = std::min<std::size_t>(sequence.triangles.size(), kMaxClusters);
  if (options.clusters > most)
    throw Error(ErrorCode::kUsage, std::to_string(options.clusters) +
                                       " clusters are too many: this mesh can have at most " +
                                       std::to_string(most));
  if (options.stop_percent && !(*options.stop_percent >= 0 && *options.stop_percent < 100))
    throw Error(ErrorCode::kUsage, "the stop threshold must be a percentage from 0 to below 100");
  check_bone_options(sequence, options);
  check_consistency(sequence);
  check_positions(sequence);
}

PoseTable sampled_table(const PoseSequence& sequence, std::uint32_t count,
                        std::optional<std::uint32_t> also, double unit) {
  KeySamplingOptions sampling;
  sampling.count = count;
  std::vector<std::uint32_t> keys = sample_keys(sequence, sampling);
  if (also && !std::binary_search(keys.begin(), keys.end(), *also))
    keys.insert(std::lower_bound(keys.begin(), keys.end(), *also), *also);
  return make_pose_table(sequence, keys, unit);
}

std::uint32_t growth_keys(const PoseSequence& sequence) {
  const std::size_t affordable = kGrowthEntries / std::max(1u, sequence.vertex_count);
  return static_cast<std::uint32_t>(
      std::clamp<std::size_t>(affordable, kMinGrowthKeys, kMaxGrowthKeys));
}

/// Some Lloyd rounds and a last look at the rest pose, on as many keys as memory and time allow.
Clustering polish(const MovingMesh& mesh, Clustering start, const GrowthOptions& options) {
  const auto improve = [&](Clustering candidate) {
    if (candidate.cluster_count == start.cluster_count &&
        clustering_cost(mesh, candidate, options.cost) < clustering_cost(mesh, start, options.cost))
      start = std::move(candidate);
  };
  improve(relax(mesh, start, kPolish));
  if (!options.fixed_rest) start = with_better_rest_pose(mesh, start, options.cost);
  improve(relax(mesh, start, kPolish));
  return start;
}

/// What clustering decides.
struct Decision {
  std::uint32_t rest_key = 0;
  std::vector<std::uint32_t> cluster_of_triangle;
  std::uint32_t cluster_count = 1;
  std::vector<Affine3d> local_from_rest;   ///< K, of motion's clusters
  std::vector<ClusterBone> cluster_bones;  ///< K, of bones' clusters
  std::vector<GrowthStep> steps;
  std::string stop_reason;
};

Decision cluster_motion(const PoseSequence& sequence, const DecomposeOptions& options, double unit,
                        ProgressSink& progress) {
  GrowthOptions growth_options;
  growth_options.clusters = options.clusters;
  growth_options.stop_percent = options.stop_percent;
  growth_options.fixed_rest = options.rest_key.has_value();

  const VertexTriangles neighbors =
      make_vertex_triangles(sequence.triangles, sequence.vertex_count);
  const PoseTable few = sampled_table(sequence, growth_keys(sequence), options.rest_key, unit);
  progress.report("decompose", 0.05);
  Growth growth = grow_clusters(
      {few, sequence.triangles, neighbors},
      options.rest_key ? row_of_key(few, *options.rest_key) : 0, growth_options,
      [&](const GrowthStep& step) {
        progress.report("decompose", 0.05 + 0.7 * step.clusters / (step.clusters + 12.0));
      });

  const std::uint32_t rest_key = few.keys[growth.clustering.rest_row];
  const std::size_t affordable = kPolishEntries / std::max(1u, sequence.vertex_count);
  const auto many_keys = static_cast<std::uint32_t>(
      std::clamp<std::size_t>(affordable, few.row_count(), sequence.key_count()));
  const PoseTable many = sampled_table(sequence, many_keys, rest_key, unit);
  const MovingMesh mesh{many, sequence.triangles, neighbors};
  progress.report("decompose", 0.8);
  const Clustering polished =
      polish(mesh,
             fit_assignment(mesh, row_of_key(many, rest_key),
                            std::move(growth.clustering.cluster_of_triangle)),
             growth_options);

  const ClusterMembers members =
      make_cluster_members(sequence.triangles, polished.cluster_of_triangle, polished.cluster_count,
                           sequence.vertex_count);
  const LocalFrames frames =
      choose_local_frames(many, members, polished.maps.maps, growth_options.cost);
  return {many.keys[polished.rest_row], polished.cluster_of_triangle,
          polished.cluster_count,       frames.local_from_rest,
          {},                           std::move(growth.steps),
          growth.stop_reason};
}

void set_limits(Skeleton& skeleton, double degrees) {
  constexpr float kMost = std::numbers::pi_v<float>;
  for (Joint& joint : skeleton.joints)
    joint.limit = std::min(kMost, static_cast<float>(degrees * std::numbers::pi / 180));
}

PoseSpace pose_space_of(const PoseSequence& sequence) {
  return {sequence.skeleton->view(), sequence.rig->view(), sequence.key_count()};
}

Decision cluster_bones(const PoseSequence& sequence, const DecomposeOptions& options, double unit) {
  Decision decision;
  decision.rest_key = options.rest_key.value_or(0);
  decision.stop_reason = "bones";
  const std::size_t affordable = kBoneEntries / std::max(1u, sequence.vertex_count);
  const auto keys =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(affordable, kMinGrowthKeys, kMaxBoneKeys));
  const PoseTable table = sampled_table(sequence, keys, decision.rest_key, unit);
  std::optional<PoseSpace> space;
  if (sequence.skeleton) space = pose_space_of(sequence);
  BoneClusters clusters = assign_to_bones(sequence, table.keys, space ? &*space : nullptr);
  decision.cluster_count = static_cast<std::uint32_t>(clusters.bones.size());
  decision.cluster_of_triangle = std::move(clusters.cluster_of_triangle);
  const ClusterMembers members =
      make_cluster_members(sequence.triangles, decision.cluster_of_triangle, decision.cluster_count,
                           sequence.vertex_count);
  decision.cluster_bones = choose_bone_bases(sequence, table, members, clusters.bones);
  return decision;
}

Decision decide(const PoseSequence& sequence, const DecomposeOptions& options, double unit,
                ProgressSink& progress) {
  switch (options.mode) {
    case DecomposeMode::kMotion:
      return cluster_motion(sequence, options, unit, progress);
    case DecomposeMode::kBones:
      return cluster_bones(sequence, options, unit);
    case DecomposeMode::kNone:
      break;
  }
  Decision decision;
  decision.rest_key = options.rest_key.value_or(0);
  decision.cluster_of_triangle.assign(sequence.triangles.size(), 0);
  decision.stop_reason = "none";
  return decision;
}

KeyMaps key_maps(const PoseSequence& sequence, const ClusterMembers& members,
                 const Decision& decision, DecomposeMode mode, double unit) {
  switch (mode) {
    case DecomposeMode::kMotion:
      return fit_key_maps(sequence, members, decision.rest_key, decision.local_from_rest, unit);
    case DecomposeMode::kBones:
      return bone_key_maps(sequence, members, decision.cluster_bones, decision.rest_key);
    case DecomposeMode::kNone:
      break;
  }
  return identity_key_maps(sequence, members, decision.rest_key);
}

std::vector<std::string> segment_notes(const DecomposeOptions& options, std::size_t segments) {
  if (options.segments <= segments) return {};
  return {std::to_string(options.segments) +
          " segments are more than the animation has intervals "
          "between keys: it got " +
          std::to_string(segments)};
}

/// Residuals are reported relative to the rest pose's diagonal; a rest pose that is a point has
/// none, and the model's largest extent stands in.
double residual_unit(double rest_diagonal, double unit) {
  return rest_diagonal > 0 ? rest_diagonal : unit;
}

DecomposeStats make_stats(const Decision& decision, const AssembledModel& assembled,
                          const ResidualStats& residual, double unit) {
  const double length = residual_unit(assembled.model.rest_diagonal, unit);
  DecomposeStats stats;
  stats.rest_key = decision.rest_key;
  stats.stop_reason = decision.stop_reason;
  stats.residual_rms = residual.rms / length;
  stats.residual_max = residual.max / length;
  stats.sah_cost = assembled.expected_work;
  for (const GrowthStep& s : decision.steps)
    stats.steps.push_back({s.clusters, s.residual_rms * unit / length, s.cost});
  return stats;
}

}  // namespace

DecomposeResult decompose(PoseSequence sequence, const DecomposeOptions& options,
                          ProgressSink& progress) {
  check_input(sequence, options);
  Stopwatch watch;
  progress.report("decompose", 0);
  const double unit = pose_unit(sequence);
  if (options.sampling == PoseSampling::kPoseSpace) {
    set_limits(*sequence.skeleton, options.joint_limit_degrees);
  } else {
    sequence.skeleton.reset();
  }
  const Decision decision = decide(sequence, options, unit, progress);
  const ClusterMembers members =
      make_cluster_members(sequence.triangles, decision.cluster_of_triangle, decision.cluster_count,
                           sequence.vertex_count);
  KeyMaps maps = key_maps(sequence, members, decision, options.mode, unit);
  ModelParts parts;
  parts.local_from_world = std::move(maps.local_from_world);
  parts.rest_key = decision.rest_key;
  progress.report("decompose", 0.95);
  if (sequence.skeleton) {
    parts.segments = {{0, sequence.key_count() - 1}};  // a pose space has no time
    parts.cluster_bones = decision.cluster_bones;
    parts.pose_space_boxes =
        pose_space_boxes(pose_space_of(sequence), members, decision.cluster_bones);
  } else {
    parts.segments =
        choose_segments(sequence, members, parts.local_from_world, {.count = options.segments});
  }
  progress.report("decompose", 1);
  const double decompose_seconds = watch.lap();

  AssembledModel assembled =
      assemble_model(std::move(sequence), members, std::move(parts), progress);
  DecomposeResult result;
  result.stats = make_stats(decision, assembled, maps.residual, unit);
  result.stats.notes = segment_notes(options, assembled.model.segments.size());
  result.stats.decompose_seconds = decompose_seconds;
  result.stats.build_seconds = watch.seconds();
  result.model = std::move(assembled.model);
  return result;
}

}  // namespace mdk
