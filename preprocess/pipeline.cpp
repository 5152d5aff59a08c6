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
#include "preprocess/clustering.h"
#include "preprocess/key_maps.h"
#include "preprocess/model_assembly.h"
#include "preprocess/motion_clusters.h"
#include "preprocess/pose_quantizer.h"
#include "preprocess/pose_space.h"
#include "preprocess/pose_table.h"
#include "preprocess/segments.h"
#include "preprocess/stage_shares.h"

namespace mdk {
namespace {

constexpr std::uint32_t kMaxClusters = 1024;
constexpr std::size_t kBoneEntries = 2'000'000;  // keys (times vertices) that bones are chosen on
constexpr std::size_t kMinBoneKeys = 10, kMaxBoneKeys = 200;
constexpr float kLargestCoordinate = 1e15f;  // areas and volumes must stay far inside float

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

std::vector<std::string> make_notes(const DecomposeOptions& options, const ModelStorage& model) {
  std::vector<std::string> notes;
  if (options.segments > model.segments.size())
    notes.push_back(std::to_string(options.segments) +
                    " segments are more than the animation has intervals between keys: it got " +
                    std::to_string(model.segments.size()));
  if (options.quantize && model.poses.kind != PoseKind::kQuantized)
    notes.push_back("poses stay exact: bones and morph targets take less room than quantised keys");
  return notes;
}

SequenceSize size_of(const PoseSequence& sequence) {
  return {static_cast<double>(sequence.positions.size()),
          static_cast<double>(sequence.triangles.size())};
}

/// Residuals are reported relative to the rest pose's diagonal; a rest pose that is a point has
/// none, and the model's largest extent stands in.
double residual_unit(double rest_diagonal, double unit) {
  return rest_diagonal > 0 ? rest_diagonal : unit;
}

DecomposeStats make_stats(const MotionClusters& decision, const AssembledModel& assembled,
                          const ResidualStats& residual, double unit) {
  const double length = residual_unit(assembled.model.rest_diagonal, unit);
  DecomposeStats stats;
  stats.rest_key = decision.rest_key;
  stats.stop_reason = decision.stop_reason;
  stats.residual_rms = residual.rms / length;
  stats.residual_max = residual.max / length;
  stats.sah_cost = assembled.expected_work;
  for (const ClusteringStep& s : decision.steps)
    stats.steps.push_back({s.clusters, s.residual_rms * unit / length, s.sah_cost, s.fuzzy_area});
  return stats;
}

/// A sequence taken apart.
struct Decomposition {
  MotionClusters clusters;
  ClusterMembers members;
  KeyMaps maps;
  std::vector<ClusterBone> cluster_bones;  ///< K with bones, else none
};

ClusterMembers members_of(const PoseSequence& sequence, const MotionClusters& clusters) {
  return make_cluster_members(sequence.triangles, clusters.cluster_of_triangle,
                              clusters.cluster_count, sequence.vertex_count);
}

void set_limits(Skeleton& skeleton, double degrees) {
  constexpr float kMost = std::numbers::pi_v<float>;
  for (Joint& joint : skeleton.joints)
    joint.limit = std::min(kMost, static_cast<float>(degrees * std::numbers::pi / 180));
}

PoseSpace pose_space_of(const PoseSequence& sequence) {
  return {sequence.skeleton->view(), sequence.rig->view(), sequence.key_count()};
}

Decomposition decide_bones(const PoseSequence& sequence, const DecomposeOptions& options,
                           double unit) {
  Decomposition result;
  result.clusters.rest_key = options.rest_key.value_or(0);
  result.clusters.stop_reason = "bones";
  const std::size_t keys =
      std::clamp(kBoneEntries / std::max(1u, sequence.vertex_count), kMinBoneKeys, kMaxBoneKeys);
  const PoseTable table = sampled_table(sequence, keys, result.clusters.rest_key, unit);
  std::optional<PoseSpace> space;
  if (sequence.skeleton) space = pose_space_of(sequence);
  BoneClusters bones = assign_to_bones(sequence, table.keys, space ? &*space : nullptr);
  result.clusters.cluster_count = static_cast<std::uint32_t>(bones.bones.size());
  result.clusters.cluster_of_triangle = std::move(bones.cluster_of_triangle);
  result.members = members_of(sequence, result.clusters);
  result.cluster_bones = choose_bone_bases(sequence, table, result.members, bones.bones);
  result.maps =
      bone_key_maps(sequence, result.members, result.cluster_bones, result.clusters.rest_key);
  return result;
}

/// A cluster per mesh; past the limit the last one takes all.
std::vector<std::uint32_t> clusters_of_meshes(const PoseSequence& sequence) {
  std::vector<std::uint32_t> clusters = sequence.triangle_meshes;
  clusters.resize(sequence.triangles.size(), 0);
  for (std::uint32_t& c : clusters) c = std::min(c, kMaxClusters - 1);
  return clusters;
}

Decomposition decide_nothing(const PoseSequence& sequence, const DecomposeOptions& options) {
  Decomposition result;
  result.clusters.rest_key = options.rest_key.value_or(0);
  result.clusters.cluster_of_triangle = clusters_of_meshes(sequence);
  result.clusters.cluster_count = drop_empty_clusters(result.clusters.cluster_of_triangle);
  result.members = members_of(sequence, result.clusters);
  result.maps = identity_key_maps(sequence, result.members, result.clusters.rest_key);
  return result;
}

Decomposition with_maps(const PoseSequence& sequence, MotionClusters clusters,
                        const DecomposeOptions& options, ProgressSink& progress) {
  Decomposition result;
  result.clusters = std::move(clusters);
  result.members = members_of(sequence, result.clusters);
  const KeyMapRequest request{result.clusters.rest_key, pose_unit(sequence), options.refine};
  result.maps =
      options.stop_percent && !options.refine
          ? fit_key_maps(sequence, result.members, request, result.clusters.local_from_rest)
          : fit_small_boxes(sequence, result.members, request,
                            [&](double share) { progress.report("decompose", share); });
  return result;
}

Decomposition decide_motion(const PoseSequence& sequence, const DecomposeOptions& options,
                            double unit, ProgressSink& progress) {
  const StageEnds ends = predict_stage_ends(size_of(sequence), options);
  ProgressPart clustering(progress, 0, ends.clustered),
      mapping(progress, ends.clustered, ends.mapped);
  MotionClusters clusters = options.stop_percent
                                ? cluster_by_residuals(sequence, options, unit, clustering)
                                : cluster_by_boxes(sequence, options, unit, clustering);
  return with_maps(sequence, std::move(clusters), options, mapping);
}

Decomposition decide(const PoseSequence& sequence, const DecomposeOptions& options, double unit,
                     ProgressSink& progress) {
  switch (options.mode) {
    case DecomposeMode::kMotion:
      return decide_motion(sequence, options, unit, progress);
    case DecomposeMode::kBones:
      return decide_bones(sequence, options, unit);
    case DecomposeMode::kNone:
      break;
  }
  return decide_nothing(sequence, options);
}

double pose_diagonal(std::span<const Vec3f> pose) {
  Aabbd box;
  for (const Vec3f& v : pose) box.extend(to_double(v));
  return box.diagonal();
}

/// Quantises the sequence's poses: nothing where its rig is kept, which is exact and takes less
/// room.
std::optional<QuantizedPoses> quantized(PoseSequence& sequence, const Decomposition& decided,
                                        double error, double unit) {
  if (sequence.skeleton || rig_is_smallest(sequence)) return std::nullopt;
  sequence.rig.reset();
  const std::uint32_t rest_key = decided.clusters.rest_key;
  const double length = residual_unit(pose_diagonal(sequence.pose(rest_key)), unit);
  return quantize_poses(sequence, decided.members, decided.maps.local_from_world,
                        {error, length, rest_key});
}

}  // namespace

DecomposeResult decompose(PoseSequence sequence, const DecomposeOptions& options,
                          ProgressSink& progress) {
  check_input(sequence, options);
  Stopwatch watch;
  const StageEnds ends = predict_stage_ends(size_of(sequence), options);
  progress.report("decompose", 0);
  const double unit = pose_unit(sequence);
  if (options.sampling == PoseSampling::kPoseSpace) {
    set_limits(*sequence.skeleton, options.joint_limit_degrees);
  } else {
    sequence.skeleton.reset();
  }
  Decomposition decided = decide(sequence, options, unit, progress);
  progress.report("decompose", ends.mapped);
  select_vertices(sequence, cluster_order(decided.members, sequence.vertex_count));
  decided.members = members_of(sequence, decided.clusters);
  ModelParts parts;
  if (options.quantize) parts.quantized = quantized(sequence, decided, *options.quantize, unit);
  parts.local_from_world = std::move(decided.maps.local_from_world);
  parts.rest_key = decided.clusters.rest_key;
  progress.report("decompose", ends.ordered);
  if (sequence.skeleton) {
    parts.segments = {{0, sequence.key_count() - 1}};  // a pose space has no time
    parts.cluster_bones = decided.cluster_bones;
    parts.pose_space_boxes =
        pose_space_boxes(pose_space_of(sequence), decided.members, decided.cluster_bones);
  } else {
    parts.segments = choose_segments(sequence, decided.members, parts.local_from_world,
                                     {.count = options.segments});
  }
  progress.report("decompose", ends.segmented);
  const double decompose_seconds = watch.lap();

  ProgressPart building(progress, ends.segmented, 1);
  parts.boxes_until = (ends.boxed - ends.segmented) / (1 - ends.segmented);
  AssembledModel assembled =
      assemble_model(std::move(sequence), decided.members, std::move(parts), building);
  DecomposeResult result;
  result.stats = make_stats(decided.clusters, assembled, decided.maps.residual, unit);
  result.stats.refine_gain = decided.maps.refine_gain;
  if (const auto& error = assembled.model.poses.quantized.error; !error.empty())
    result.stats.quantization = error.front();
  result.stats.notes = make_notes(options, assembled.model);
  result.stats.decompose_seconds = decompose_seconds;
  result.stats.build_seconds = watch.seconds();
  result.model = std::move(assembled.model);
  return result;
}

}  // namespace mdk
