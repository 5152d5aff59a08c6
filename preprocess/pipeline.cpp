#include "preprocess/pipeline.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <utility>

#include "common/base/stopwatch.h"
#include "preprocess/boxes/fuzzy_boxes.h"
#include "preprocess/boxes/model_assembly.h"
#include "preprocess/boxes/segments.h"
#include "preprocess/cluster/clusters.h"
#include "preprocess/maps/key_maps.h"
#include "preprocess/pose/pose_quantizer.h"
#include "preprocess/pose/pose_space.h"
#include "preprocess/pose/pose_table.h"
#include "preprocess/pose/rest_pose.h"

namespace mdk {
namespace {

constexpr std::size_t kBoneEntries = 2'000'000;  // keys (times vertices) that bones are chosen on
constexpr std::size_t kMinBoneKeys = 10, kMaxBoneKeys = 200;
constexpr double kRestSearch = 3e8;  // multiply-adds for the rest pose of bones

SequenceSize size_of(const PoseSequence& sequence) {
  return {static_cast<double>(sequence.positions.size()),
          static_cast<double>(sequence.triangles.size())};
}

/// Residuals are reported relative to the rest pose's diagonal; a rest pose that is a point has
/// none, and the model's largest extent stands in.
double residual_unit(double rest_diagonal, double unit) {
  return rest_diagonal > 0 ? rest_diagonal : unit;
}

ClusterMembers members_of(const PoseSequence& sequence, const Assignment& assignment) {
  return make_cluster_members(sequence.triangles, assignment, sequence.vertex_count);
}

/// The skeleton stays with the sequence where a pose space is to be bounded, with its limits.
void settle_skeleton(const DecomposeOptions& options, PoseSequence& sequence) {
  if (options.sampling != PoseSampling::kPoseSpace) {
    sequence.skeleton.reset();
    return;
  }
  for (Joint& joint : sequence.skeleton->joints)
    joint.limit =
        std::min(std::numbers::pi_v<float>,
                 static_cast<float>(options.joint_limit_degrees * std::numbers::pi / 180));
}

PoseSpace pose_space_of(const PoseSequence& sequence) {
  return {sequence.skeleton->view(), sequence.rig->view(), sequence.key_count()};
}

Decomposition with_motion_clusters(const PoseSequence& sequence, const DecomposeOptions& options,
                                   double unit, ProgressSink& progress) {
  const StageEnds ends = predict_stage_ends(size_of(sequence), options);
  ProgressPart clustering(progress, 0, ends.clustered),
      mapping(progress, ends.clustered, ends.mapped);
  PaperClusters paper;
  Decomposition result;
  if (options.stop_percent) {
    paper = cluster_by_residuals(sequence, options, unit, clustering);
    result.growth = paper;
  } else {
    result.growth = cluster_by_boxes(sequence, options, unit, clustering);
  }
  result.members = members_of(sequence, result.growth);
  const KeyMapRequest request{result.growth.rest_key, unit, options.refine, options.between};
  result.maps = options.stop_percent && !options.refine
                    ? fit_key_maps(sequence, result.members, request, paper.local_from_rest)
                    : fit_small_boxes(sequence, result.members, request,
                                      [&](double share) { mapping.report("decompose", share); });
  return result;
}

Decomposition with_bone_clusters(const PoseSequence& sequence, const DecomposeOptions& options,
                                 double unit) {
  Decomposition result;
  result.growth.stop_reason = StopReason::kBones;
  const std::size_t keys =
      std::clamp(kBoneEntries / std::max(1u, sequence.vertex_count), kMinBoneKeys, kMaxBoneKeys);
  const PoseTable table = sample_poses(sequence, keys, requested_rest_keys(options), unit);
  std::optional<PoseSpace> space;
  if (sequence.skeleton) space = pose_space_of(sequence);
  BoneClusters clusters = assign_to_bones(sequence, table, space ? &*space : nullptr);
  static_cast<Assignment&>(result.growth) = clusters;
  result.members = members_of(sequence, result.growth);
  result.growth.rest_key = options.rest_key ? *options.rest_key
                                            : best_rest_keys(sequence, result.members, unit,
                                                             {.max_multiply_adds = kRestSearch})[0];
  result.bones = choose_bone_bases(sequence, table, result.members, clusters.bones);
  result.maps = bone_key_maps(sequence, result.members, result.bones, result.growth.rest_key);
  return result;
}

/// A cluster per mesh; past the limit the last one takes all.
Decomposition with_mesh_clusters(const PoseSequence& sequence, const DecomposeOptions& options) {
  Decomposition result;
  result.growth.rest_key = options.rest_key.value_or(0);
  std::vector<std::uint32_t> meshes = sequence.triangle_meshes;
  meshes.resize(sequence.triangles.size(), 0);
  for (std::uint32_t& mesh : meshes) mesh = std::min(mesh, kMaxClusters - 1);
  static_cast<Assignment&>(result.growth) = make_assignment(std::move(meshes));
  result.members = members_of(sequence, result.growth);
  result.maps = identity_key_maps(sequence, result.members, result.growth.rest_key);
  return result;
}

/// Clusters, their members and maps.
Decomposition with_clusters(const PoseSequence& sequence, const DecomposeOptions& options,
                            double unit, ProgressSink& progress) {
  switch (options.mode) {
    case DecomposeMode::kMotion:
      return with_motion_clusters(sequence, options, unit, progress);
    case DecomposeMode::kBones:
      return with_bone_clusters(sequence, options, unit);
    case DecomposeMode::kNone:
      break;
  }
  return with_mesh_clusters(sequence, options);
}

/// Quantises the sequence's poses: nothing where its rig is kept, which is exact and takes less
/// room.
std::optional<QuantizedPoses> quantized(PoseSequence& sequence, const Decomposition& decomposition,
                                        double error, double unit) {
  if (sequence.skeleton || rig_is_smallest(sequence)) return std::nullopt;
  sequence.rig.reset();
  const std::uint32_t rest_key = decomposition.growth.rest_key;
  const double length = residual_unit(diagonal(pose_box(sequence.pose(rest_key))), unit);
  return quantize_poses(sequence, decomposition.members, decomposition.maps.local_from_world,
                        {error, length, rest_key});
}

DecomposeStats make_stats(const Decomposition& decomposition, double rest_diagonal, double unit) {
  const Growth& growth = decomposition.growth;
  const double length = residual_unit(rest_diagonal, unit);
  DecomposeStats stats;
  stats.rest_key = growth.rest_key;
  stats.stop_reason = stop_reason_id(growth.stop_reason);
  stats.residual_rms = decomposition.maps.residual.rms / length;
  stats.residual_max = decomposition.maps.residual.max / length;
  stats.refine_gain = decomposition.maps.refine_gain;
  stats.steps = growth.steps;
  for (GrowthStep& step : stats.steps) step.residual_rms = step.residual_rms * unit / length;
  return stats;
}

std::vector<std::string> make_notes(const DecomposeOptions& options, const ModelStorage& model) {
  std::vector<std::string> notes;
  if (options.segments > model.segments.size())
    notes.push_back(std::to_string(options.segments) +
                    " segments are more than the animation has intervals between keys: it got " +
                    std::to_string(model.segments.size()));
  if (options.quantize && model.poses.kind != PoseKind::kQuantized)
    notes.emplace_back("poses stay exact: bones and morph targets take less room than quantised keys");
  return notes;
}

// Seconds as they were measured on models of 2 to 450 million positions (keys times vertices).
// Clusters grow on a sample of bounded size; what comes after looks at every position.
constexpr double kGrow = 1.5, kGrowPerTriangle = 15e-6;
constexpr double kMapPerPosition = 0.5e-6, kPlainMapPerPosition = 0.1e-6;
constexpr double kNoMapPerPosition = 0.01e-6;  // its residuals alone
constexpr double kOrderPerPosition = 0.015e-6;
constexpr double kCutPerPosition = 0.1e-6;
constexpr double kBoxPerPosition = 0.1e-6;
constexpr double kTreePerTriangle = 6e-6;

double map_seconds_per_position(const DecomposeOptions& options) {
  if (options.mode == DecomposeMode::kNone) return kNoMapPerPosition;
  return options.mode == DecomposeMode::kMotion && options.refine ? kMapPerPosition
                                                                  : kPlainMapPerPosition;
}

/// When each stage ends, in seconds; after the last field come the trees.
StageEnds stage_end_seconds(const SequenceSize& size, const DecomposeOptions& options) {
  StageEnds ends;
  if (options.mode == DecomposeMode::kMotion)
    ends.clustered = kGrow + kGrowPerTriangle * size.triangles;
  ends.mapped = ends.clustered + map_seconds_per_position(options) * size.positions;
  ends.ordered = ends.mapped + kOrderPerPosition * size.positions;
  ends.segmented = ends.ordered + (options.segments == 1 ? 0 : kCutPerPosition) * size.positions;
  ends.boxed = ends.segmented + kBoxPerPosition * size.positions;
  return ends;
}

}  // namespace

DecomposeResult decompose(PoseSequence sequence, const DecomposeOptions& options,
                          ProgressSink& progress) {
  validate(options, sequence);
  Stopwatch watch;
  const StageEnds ends = predict_stage_ends(size_of(sequence), options);
  progress.report("decompose", 0);
  const double unit = pose_unit(sequence);
  settle_skeleton(options, sequence);

  Decomposition parts = with_clusters(sequence, options, unit, progress);
  progress.report("decompose", ends.mapped);

  // From here on the vertices of a cluster lie together.
  select_vertices(sequence, cluster_order(parts.members, sequence.vertex_count));
  parts.members = members_of(sequence, parts.growth);
  if (options.quantize) parts.quantized = quantized(sequence, parts, *options.quantize, unit);
  progress.report("decompose", ends.ordered);

  if (sequence.skeleton) {
    parts.segments = {{0, sequence.key_count() - 1}};  // a pose space has no time
    parts.pose_space_boxes = pose_space_boxes(pose_space_of(sequence), parts.members, parts.bones);
  } else {
    parts.segments = choose_segments(sequence, parts.members, parts.maps.local_from_world,
                                     options.segments, options.between);
  }
  parts.between = options.between;
#ifndef NDEBUG
  validate(parts, sequence);
#endif
  progress.report("decompose", ends.segmented);
  const double decompose_seconds = watch.lap();

  DecomposeResult result;
  result.stats = make_stats(parts, diagonal(pose_box(sequence.pose(parts.growth.rest_key))), unit);
  ProgressPart building(progress, ends.segmented, 1);
  AssembledModel assembled =
      assemble_model(std::move(sequence), std::move(parts),
                     (ends.boxed - ends.segmented) / (1 - ends.segmented), building);
  result.stats.sah_cost = assembled.expected_work;
  if (const auto& error = assembled.model.poses.quantized.error; !error.empty())
    result.stats.quantization = error.front();
  result.stats.notes = make_notes(options, assembled.model);
  result.stats.decompose_seconds = decompose_seconds;
  result.stats.build_seconds = watch.seconds();
  result.model = std::move(assembled.model);
  return result;
}

double predict_decompose_seconds(const SequenceSize& size, const DecomposeOptions& options) {
  return stage_end_seconds(size, options).boxed + kTreePerTriangle * size.triangles;
}

StageEnds predict_stage_ends(const SequenceSize& size, const DecomposeOptions& options) {
  const StageEnds ends = stage_end_seconds(size, options);
  const double all = predict_decompose_seconds(size, options);
  return {ends.clustered / all, ends.mapped / all, ends.ordered / all, ends.segmented / all,
          ends.boxed / all};
}

}  // namespace mdk
