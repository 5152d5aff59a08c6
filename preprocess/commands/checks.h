// What 'mdprep verify' checks: does a model keep what tracing relies on, judged from the data
// alone; does every technique see what brute force sees; does a .mdk still say what its source
// says?
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

/// One line of the report.
struct CheckResult {
  std::string name;         ///< what is true if it passes, as a short phrase
  std::uint64_t count = 0;  ///< how many things were looked at
  std::uint64_t failures = 0;
  std::string detail;  ///< where the first failure is, or a figure worth knowing

  bool passed() const { return failures == 0; }
};

/// `count` moments between keys, spread over all the intervals there are: the i-th lies in the i-th
/// of `count` equal parts of them, at a place drawn from `seed`. None where no clip has two keys.
/// The same on every machine.
std::vector<KeyInterval> random_moments(const ModelView& model, std::uint32_t count,
                                        std::uint64_t seed);

/// How many intervals between neighbouring keys the clips have.
std::uint64_t interval_count(const ModelView& model);

/// At every key and at each of `between`: each fuzzy box holds its triangle, each cluster's world
/// box and the model's bounds hold the vertices (docs/method.md, time between keys). No tolerance:
/// maps and positions are computed as the run time does. Cost: O((keys + between) * triangles).
std::vector<CheckResult> check_boxes(const ModelView& model, std::span<const KeyInterval> between,
                                     ProgressSink& progress);

/// Every leaf of a fuzzy kd-tree lists each triangle whose fuzzy box reaches into it, so no ray can
/// miss one.
CheckResult check_trees(const ModelView& model, ProgressSink& progress);

/// One result per technique of ours but brute force (peers judge nothing); failures are pixels
/// whose hit is another triangle or distance. Looks from three cameras (all in the picture; close,
/// from behind and below; from inside the bounds) at a few keys and at each of `between`.
std::vector<CheckResult> check_hits(const ModelView& model, std::span<const KeyInterval> between,
                                    ProgressSink& progress);

/// Compares clips, key times and triangles with the source read again, and the position of every
/// triangle's corner at every key: positions are stored as they were read, so each difference is a
/// failure. `detail` gives the largest one, relative to the rest pose's diagonal. Where the shapes
/// do not fit together, positions are left out.
std::vector<CheckResult> check_source(const ModelView& model, const PoseSequence& source);

}  // namespace mdk
