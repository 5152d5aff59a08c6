#include "preprocess/pose/pose_quantizer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr double kMaxSteps = (1u << kMaxCoordinateBits) - 1;

/// What one round of quantisation tries.
struct Target {
  double distance = 0;  ///< world length that no vertex may be off
  double share = 1;     ///< of it, left to quantisation; float rounding takes the rest
};

/// A map and its inverse.
struct Basis {
  Affine3d local_from_world, world_from_local;
};

/// The identity where the map has no inverse that is of use.
Basis usable_basis(const Affine3d& a) {
  const double size = length(a.column(0)) * length(a.column(1)) * length(a.column(2));
  if (!(std::abs(a.determinant()) > 1e-6 * size)) return {};
  return {a, inverse(a)};
}

/// One run of vertices: those that no earlier cluster has.
struct Run {
  std::uint32_t cluster = 0;
  VertexRange vertices;
};

std::vector<Run> owned_runs(const ClusterMembers& members, std::uint32_t vertex_count) {
  std::vector<char> owned(vertex_count, 0);
  std::vector<Run> runs;
  std::uint32_t next = 0;
  for (std::uint32_t c = 0; c < members.cluster_count(); ++c) {
    const std::uint32_t first = next;
    for (const std::uint32_t v : members.vertices_of(c)) {
      next += owned[v] ? 0 : 1;
      owned[v] = 1;
    }
    if (next > first) runs.push_back({c, {first, next}});
  }
  return runs;
}

/// A run at a key, before its coordinates are packed.
struct BlockPlan {
  QuantizedBlock block;
  Affine3d local_from_world;
  Vec3d lowest;
  bool fits = true;
};

/// Vertices of a run at a key, and where they rest in the cluster's basis.
struct RunPose {
  std::span<const Vec3f> pose, rest;  ///< of all vertices
  VertexRange vertices;
};

BlockPlan plan_in_basis(const RunPose& run, const Basis& basis, const Target& target) {
  BlockPlan plan;
  const Affine3d& world_from_local = basis.world_from_local;
  plan.local_from_world = basis.local_from_world;
  Vec3d highest{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  plan.lowest = -highest;
  for (std::uint32_t v = run.vertices.begin; v < run.vertices.end; ++v) {
    const Vec3d d = plan.local_from_world.point(to_double(run.pose[v])) - to_double(run.rest[v]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      plan.lowest[axis] = std::min(plan.lowest[axis], d[axis]);
      highest[axis] = std::max(highest[axis], d[axis]);
    }
  }
  Affine3d shifted = world_from_local;
  const Vec3d shift = world_from_local.point(plan.lowest);
  for (std::size_t i = 0; i < 3; ++i) shifted.m[i][3] = shift[i];
  plan.block.world_from_local = to_float(shifted);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = length(world_from_local.column(static_cast<int>(axis)));
    const double widest = 2 * target.share * target.distance / (std::sqrt(3.0) * reach);
    const double steps = std::ceil((highest[axis] - plan.lowest[axis]) / widest);
    plan.fits = plan.fits && steps <= kMaxSteps;
    plan.block.step[axis] = static_cast<float>(widest);
    if (plan.fits)
      plan.block.bits[axis] =
          static_cast<std::uint8_t>(std::bit_width(static_cast<std::uint32_t>(steps)));
  }
  return plan;
}

/// In the cluster's basis, or, where that is so near singular that steps would have to be finer, in
/// the world's.
BlockPlan plan_block(const RunPose& run, const Affine3d& local_from_world, const Target& target) {
  const BlockPlan in_cluster = plan_in_basis(run, usable_basis(local_from_world), target);
  const BlockPlan in_world = plan_in_basis(run, {}, target);
  const auto cost = [](const BlockPlan& plan) {
    return plan.fits ? plan.block.bits_per_vertex() : ~0u;
  };
  return cost(in_world) < cost(in_cluster) ? in_world : in_cluster;
}

void write_bits(std::span<std::uint32_t> words, std::uint64_t at, std::uint32_t value) {
  const std::uint64_t two = std::uint64_t{value} << (at % 32);
  words[at / 32] |= static_cast<std::uint32_t>(two);
  if (two >> 32 != 0) words[at / 32 + 1] |= static_cast<std::uint32_t>(two >> 32);
}

void pack_block(const RunPose& run, const BlockPlan& plan, std::span<std::uint32_t> words) {
  std::uint64_t at = plan.block.first_bit;
  for (std::uint32_t v = run.vertices.begin; v < run.vertices.end; ++v) {
    const Vec3d d =
        plan.local_from_world.point(to_double(run.pose[v])) - to_double(run.rest[v]) - plan.lowest;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t bits = plan.block.bits[axis];
      const double largest = static_cast<double>((1u << bits) - 1);
      const double q = std::round(d[axis] / static_cast<double>(plan.block.step[axis]));
      write_bits(words, at, static_cast<std::uint32_t>(std::clamp(q, 0.0, largest)));
      at += bits;
    }
  }
}

double largest_distance(std::span<const Vec3f> a, std::span<const Vec3f> b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, length(to_double(a[i]) - to_double(b[i])));
  return largest;
}

/// Quantises one sequence.
class Quantizer {
 public:
  Quantizer(const PoseSequence& sequence, const ClusterMembers& members,
            std::span<const Affine3f> local_from_world, std::uint32_t rest_key)
      : sequence_(sequence),
        runs_(owned_runs(members, sequence.vertex_count)),
        maps_(local_from_world),
        clusters_(members.cluster_count()) {
    poses_.words = ScratchList<std::uint32_t>(sequence.positions.get_allocator().space());
    poses_.first_vertex = {0};
    poses_.rest_positions.resize(sequence.vertex_count);
    for (const Run& run : runs_) {
      poses_.first_vertex.push_back(run.vertices.end);
      const Affine3d map = usable_basis(map_of(run, rest_key)).local_from_world;
      for (std::uint32_t v = run.vertices.begin; v < run.vertices.end; ++v)
        poses_.rest_positions[v] = to_float(map.point(to_double(sequence.pose(rest_key)[v])));
    }
  }

  /// Whether 16 bits are enough everywhere.
  bool quantize(const Target& target) {
    std::vector<BlockPlan> plans(runs_.size() * sequence_.key_count());
    for_each_block([&](std::size_t i, std::uint32_t key, const Run& run) {
      plans[i] = plan_block(pose_of(run, key), map_of(run, key), target);
    });
    poses_.blocks.clear();
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < plans.size(); ++i) {
      if (!plans[i].fits) return false;
      plans[i].block.first_bit = bits;
      bits +=
          std::uint64_t{runs_[i % runs_.size()].vertices.size()} * plans[i].block.bits_per_vertex();
      bits = (bits + 31) / 32 * 32;  // blocks are packed at the same time and must not share words
      poses_.blocks.push_back(plans[i].block);
    }
    poses_.words.assign(bits / 32 + 1, 0);
    for_each_block([&](std::size_t i, std::uint32_t key, const Run& run) {
      pack_block(pose_of(run, key), plans[i], poses_.words);
    });
    return true;
  }

  /// Distance of the decoded poses from the sequence's.
  double largest_error() const {
    std::vector<double> errors(sequence_.key_count());
    parallel_chunks(errors.size(), 1, [&](std::size_t key, std::size_t) {
      const std::vector<Vec3f> pose = decoded(static_cast<std::uint32_t>(key));
      errors[key] = largest_distance(pose, sequence_.pose(static_cast<std::uint32_t>(key)));
    });
    return *std::ranges::max_element(errors);
  }

  std::vector<Vec3f> decoded(std::uint32_t key) const {
    std::vector<Vec3f> pose(sequence_.vertex_count);
    decode_vertices(poses_.view(), key, {0, sequence_.vertex_count}, pose);
    return pose;
  }

  QuantizedPoses take() { return std::move(poses_); }

 private:
  Affine3d map_of(const Run& run, std::uint32_t key) const {
    return to_double(maps_[static_cast<std::size_t>(key) * clusters_ + run.cluster]);
  }

  RunPose pose_of(const Run& run, std::uint32_t key) const {
    return {sequence_.pose(key), poses_.rest_positions, run.vertices};
  }

  template <class Body>
  void for_each_block(const Body& body) const {
    parallel_chunks(sequence_.key_count(), 1, [&](std::size_t key, std::size_t) {
      for (std::size_t r = 0; r < runs_.size(); ++r)
        body(key * runs_.size() + r, static_cast<std::uint32_t>(key), runs_[r]);
    });
  }

  const PoseSequence& sequence_;
  std::vector<Run> runs_;
  std::span<const Affine3f> maps_;
  std::size_t clusters_;
  QuantizedPoses poses_;
};

[[noreturn]] void refuse(double error) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", error);
  throw Error(ErrorCode::kUsage,
              std::string("--quantize ") + text +
                  " is less than 16 bits per coordinate and float positions can keep for this "
                  "animation; give a larger error, or leave --quantize out");
}

}  // namespace

QuantizedPoses quantize_poses(PoseSequence& sequence, const ClusterMembers& members,
                              std::span<const Affine3f> local_from_world,
                              const QuantizeOptions& options) {
  Quantizer quantizer(sequence, members, local_from_world, options.rest_key);
  // The rest pose's diagonal, too, may change by what vertices are off.
  const double distance = options.error * options.unit / (1 + 4 * options.error);
  // Skewed maps and float rounding may need finer steps than the plain ones.
  for (const double share : {0.9, 0.5, 0.25}) {
    if (!quantizer.quantize({distance, share})) break;
    const double error = quantizer.largest_error();
    if (!(error <= distance)) continue;
    for (std::uint32_t key = 0; key < sequence.key_count(); ++key)
      std::ranges::copy(quantizer.decoded(key), sequence.pose(key).begin());
    QuantizedPoses poses = quantizer.take();
    poses.error = {{options.error, error / options.unit}};
    return poses;
  }
  refuse(options.error);
}

}  // namespace mdk
