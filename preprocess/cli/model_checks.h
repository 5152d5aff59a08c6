// Does a model keep what tracing relies on? Judged from the data alone, without any ray.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/model.h"
#include "preprocess/cli/check_result.h"

namespace mdk {

/// `count` moments between keys, spread over all the intervals there are: the i-th lies in the i-th
/// of `count` equal parts of them, at a place drawn from `seed`. None where no clip has two keys.
/// The same on every machine.
std::vector<KeyInterval> random_moments(const Model& model, std::uint32_t count,
                                        std::uint64_t seed);

/// How many intervals between neighbouring keys the clips have.
std::uint64_t interval_count(const Model& model);

/// At every key and at each of `between`: each fuzzy box holds its triangle, each cluster's world
/// box and the model's bounds hold the vertices (docs/method.md, time between keys). No tolerance:
/// maps and positions are computed as the run time does. Cost: O((keys + between) * triangles).
std::vector<CheckResult> check_boxes(const Model& model, std::span<const KeyInterval> between,
                                     ProgressSink& progress);

/// Every leaf of a fuzzy kd-tree lists each triangle whose fuzzy box reaches into it, so no ray can
/// miss one.
CheckResult check_trees(const Model& model, ProgressSink& progress);

}  // namespace mdk
