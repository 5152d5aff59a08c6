// Time segments: extreme keys widen the fuzzy boxes of all others, so the time line is cut into
// stretches with boxes and trees of their own (GFW06 §6, future work). One segment is the paper;
// one per interval between keys is a refit done ahead of time; this is the dial between them.
//
// A moment costs the work of a ray that hits the model then (cost.h); a segment costs memory on
// top, at a price in work. Cuts are chosen by dynamic programming over candidates: some blocks of
// intervals whose boxes are made once; a run of blocks has the unions of their boxes. The cheapest
// way to cover the first j blocks ends with some run [i, j), before which stands the cheapest way
// to cover i blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"

namespace mdk {

/// The smallest segments there can be: the intervals between neighbouring keys of each clip, and
/// the clips of one key. In key order; any run of them is a segment.
std::vector<Segment> smallest_segments(std::span<const Clip> clips);

/// Cuts the time line into exactly `count` segments, or as many as there can be; 0: as many as pay
/// for their memory. `local_from_world`: F * K as stored, key-major. Cost: as fuzzy_boxes() on a
/// few thousand triangles, and a few thousand unions of those.
std::vector<Segment> choose_segments(const PoseSequence& sequence, const ClusterMembers& members,
                                     std::span<const Affine3f> local_from_world,
                                     std::uint32_t count, BetweenKeys between);

/// What each run of up to `longest` consecutive blocks costs.
struct RunCosts {
  std::uint32_t blocks = 0, longest = 0;
  std::vector<double> values;  ///< blocks * longest: run of n + 1 blocks from b at b * longest + n

  RunCosts(std::uint32_t block_count, std::uint32_t longest_run)
      : blocks(block_count),
        longest(longest_run),
        values(static_cast<std::size_t>(block_count) * longest_run) {}
  double& of(std::uint32_t first, std::uint32_t last) {
    return values[static_cast<std::size_t>(first) * longest + (last - first)];
  }
  double of(std::uint32_t first, std::uint32_t last) const {
    return values[static_cast<std::size_t>(first) * longest + (last - first)];
  }
};

/// First block of each run of the cheapest partition, where each run costs `price` on top; of
/// equally cheap ones any, but always the same. `costs.longest` is at least 1. Cost: O(blocks *
/// longest).
std::vector<std::uint32_t> cheapest_runs(const RunCosts& costs, double price);

/// The cheapest partition into exactly `count` runs; ceil(blocks / longest) <= count <= blocks.
/// Cost: O(count * blocks * longest).
std::vector<std::uint32_t> cheapest_runs_of_count(const RunCosts& costs, std::uint32_t count);

}  // namespace mdk
