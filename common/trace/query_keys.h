// What a RayQuery has of a model's keys: key poses, decoded when first asked for, and the clusters'
// world boxes side by side. Both serve any moment between two keys.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

/// Safe to use from many threads at once; the model must outlive it. Memory: 12 bytes a vertex for
/// each key that was asked for; none where the model holds key positions, which are used in place.
class KeyPoses {
 public:
  explicit KeyPoses(const ModelView& model);

  /// Positions of all vertices at that time. Cost: O(1), but decoding the first time.
  VertexSource at(const KeyInterval& at) const;
  /// What was decoded so far.
  std::size_t bytes() const { return decoded_.load(std::memory_order_relaxed); }

 private:
  struct Slot {
    std::once_flag once;
    std::vector<Vec3f> positions;
  };

  const Vec3f* key(std::uint32_t key) const;

  const ModelView* model_;
  mutable std::atomic<std::size_t> decoded_ = 0;
  std::unique_ptr<Slot[]> slots_;  ///< by key; none where nothing is decoded
};

/// The clusters' world boxes at every key, a row of numbers for each of their planes, so that one
/// ray is tested with many of them at a time.
class BoxColumns {
 public:
  /// Cost: O(F K), and 24 bytes for each, K rounded up to a vector.
  explicit BoxColumns(const ModelView& model);

  /// Boxes that hold the clusters at that time but for rounding, for which a BoxRay gives way.
  /// Valid while this lives.
  MovingBoxes at(const KeyInterval& at) const;
  std::size_t bytes() const { return columns_.size() * sizeof(float); }

 private:
  std::size_t clusters_, stride_;
  std::vector<float> columns_;  ///< F times low x, high x, low y, high y, low z, high z
};

}  // namespace mdk
