#include "preprocess/options.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr float kMaxCoordinate = 1e15f;  // areas and volumes must stay far inside float

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::kUsage, sentence); }

[[noreturn]] void reject(const std::string& sentence) {
  throw Error(ErrorCode::kBadInput, sentence);
}

void check_positions(const PoseSequence& sequence) {
  constexpr std::size_t kChunk = 1 << 16;
  parallel_chunks(sequence.positions.size(), kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3f& v = sequence.positions[i];
      if (!(std::abs(v.x) <= kMaxCoordinate && std::abs(v.y) <= kMaxCoordinate &&
            std::abs(v.z) <= kMaxCoordinate))
        reject(
            "a vertex position is not a number between -1e15 and 1e15: repair or rescale the "
            "animation");
    }
  });
}

void check_clusters(const DecomposeOptions& options, const PoseSequence& sequence) {
  if (options.rest_key && *options.rest_key >= sequence.key_count())
    refuse("rest pose " + std::to_string(*options.rest_key) +
           " does not exist: choose a key from 0 to " + std::to_string(sequence.key_count() - 1));
  const std::size_t max_clusters = std::min<std::size_t>(sequence.triangles.size(), kMaxClusters);
  if (options.clusters > max_clusters)
    refuse(std::to_string(options.clusters) +
           " clusters are too many: this mesh can have at most " + std::to_string(max_clusters));
  if (options.stop_percent && !(*options.stop_percent >= 0 && *options.stop_percent < 100))
    refuse("the stop threshold must be a percentage from 0 to below 100");
}

void check_bones(const DecomposeOptions& options, const PoseSequence& sequence) {
  if (options.mode == DecomposeMode::kBones && !sequence.rig)
    reject("the animation has no bones, only positions: bake it with --decompose motion");
  if (options.sampling == PoseSampling::kCycle) return;
  if (options.mode != DecomposeMode::kBones)
    refuse("--sampling pose-space needs --decompose bones");
  if (!sequence.skeleton)
    reject("the animation has no skeleton to pose: bake it with --sampling cycle");
  if (!(options.joint_limit_degrees >= 0 && options.joint_limit_degrees <= 180))
    refuse("the joints' limit must be from 0 to 180 degrees");
  if (options.between == BetweenKeys::kIgnore)
    refuse("a pose space holds between keys, too: leave --between-keys off out");
  if (options.segments > 1)
    refuse("a pose space has no time to be cut into segments: leave --segments out");
}

}  // namespace

void validate(const DecomposeOptions& options, const PoseSequence& sequence) {
  if (sequence.triangles.empty()) reject("the mesh has no triangles: nothing can be decomposed");
  if (sequence.key_count() == 0) reject("the mesh has no poses: nothing can be decomposed");
  check_clusters(options, sequence);
  check_bones(options, sequence);
  check_consistency(sequence);
  check_positions(sequence);
}

}  // namespace mdk
