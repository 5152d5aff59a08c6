// Which vertices take the same path through all keys.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk {

/// One number per vertex: equal for equal paths, almost surely different for others. -0 counts as
/// 0. Runs in parallel. Cost: O(vertices * keys).
std::vector<std::uint64_t> hash_paths(const PoseSequence& sequence);

/// Per vertex the lowest vertex of the same group and with exactly the same path (-0 equals 0).
/// `groups`: one per vertex, or empty for "all alike". `hashes`: one per vertex, equal for what is
/// the same; they only save comparisons. Runs in parallel. Cost: O(vertices * keys), once more for
/// each round of hash collisions.
std::vector<std::uint32_t> lowest_equal_paths(const PoseSequence& sequence,
                                              std::span<const std::uint64_t> groups,
                                              std::span<const std::uint64_t> hashes);

}  // namespace mdk
