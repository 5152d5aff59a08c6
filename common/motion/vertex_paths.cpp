// Positions lie key by key, so both passes walk key by key over a run of vertices: a vertex's own
// path would touch one cache line per key.
#include "common/motion/vertex_paths.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "common/base/parallel.h"

namespace mdk {
namespace {

/// Few enough that all threads have some, many enough that what is read of each key is a good
/// stretch: keys may stand in a file that does not fit into memory.
std::size_t vertices_per_chunk(std::size_t vertices) {
  constexpr std::size_t kChunks = 16, kFewest = 1024, kMost = std::size_t{1} << 16;
  return std::clamp(vertices / kChunks, kFewest, kMost);
}

std::uint64_t mixed(std::uint64_t hash, float value) {
  // Adding 0 turns -0 into 0 and changes nothing else.
  hash = (hash ^ std::bit_cast<std::uint32_t>(value + 0.0f)) * 0x9fb21c651e98df25u;
  return hash ^ (hash >> 32);
}

/// Per undecided vertex the lowest undecided vertex with its hash.
std::vector<std::uint32_t> lowest_with_hash(std::span<const std::uint32_t> undecided,
                                            std::span<const std::uint64_t> hashes) {
  std::vector<std::uint32_t> order(undecided.begin(), undecided.end());
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return hashes[a] != hashes[b] ? hashes[a] < hashes[b] : a < b;
  });
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t v : undecided) {
    const auto first =
        std::ranges::lower_bound(order, hashes[v], {}, [&](std::uint32_t u) { return hashes[u]; });
    candidates.push_back(*first);
  }
  return candidates;
}

/// Per undecided vertex whether its group or path differs from its candidate's.
std::vector<char> differing(const PoseSequence& sequence, std::span<const std::uint64_t> groups,
                            std::span<const std::uint32_t> undecided,
                            std::span<const std::uint32_t> candidates) {
  std::vector<char> differs(undecided.size(), 0);
  if (!groups.empty())
    for (std::size_t i = 0; i < undecided.size(); ++i)
      differs[i] = groups[candidates[i]] != groups[undecided[i]];
  parallel_chunks(
      undecided.size(), vertices_per_chunk(undecided.size()),
      [&](std::size_t begin, std::size_t end) {
        for (std::uint32_t key = 0; key < sequence.key_count(); ++key) {
          const std::span<const Vec3f> pose = sequence.pose(key);
          for (std::size_t i = begin; i < end; ++i)
            if (candidates[i] != undecided[i] && !(pose[candidates[i]] == pose[undecided[i]]))
              differs[i] = 1;
        }
      });
  return differs;
}

}  // namespace

std::vector<std::uint64_t> hash_paths(const PoseSequence& sequence) {
  std::vector<std::uint64_t> hashes(sequence.vertex_count, 0x2545f4914f6cdd1du);
  parallel_chunks(hashes.size(), vertices_per_chunk(hashes.size()),
                  [&](std::size_t begin, std::size_t end) {
                    for (std::uint32_t key = 0; key < sequence.key_count(); ++key) {
                      const std::span<const Vec3f> pose = sequence.pose(key);
                      for (std::size_t i = begin; i < end; ++i)
                        hashes[i] = mixed(mixed(mixed(hashes[i], pose[i].x), pose[i].y), pose[i].z);
                    }
                  });
  return hashes;
}

std::vector<std::uint32_t> lowest_equal_paths(const PoseSequence& sequence,
                                              std::span<const std::uint64_t> groups,
                                              std::span<const std::uint64_t> hashes) {
  std::vector<std::uint32_t> result(sequence.vertex_count);
  std::vector<std::uint32_t> undecided(sequence.vertex_count);
  std::iota(undecided.begin(), undecided.end(), 0u);
  // A round settles the lowest vertex of every hash and all that move like it; vertices whose hash
  // collided with another path's go on among themselves.
  while (!undecided.empty()) {
    const std::vector<std::uint32_t> candidates = lowest_with_hash(undecided, hashes);
    const std::vector<char> differs = differing(sequence, groups, undecided, candidates);
    std::vector<std::uint32_t> rest;
    for (std::size_t i = 0; i < undecided.size(); ++i) {
      if (differs[i])
        rest.push_back(undecided[i]);
      else
        result[undecided[i]] = candidates[i];
    }
    undecided = std::move(rest);
  }
  return result;
}

}  // namespace mdk
