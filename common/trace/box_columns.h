// BoxColumns: the clusters' world boxes at every key, side by side per axis, so that one ray meets
// many of them at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

class BoxColumns {
 public:
  /// Cost: O(F K), and 24 bytes for each, K rounded up to a vector.
  explicit BoxColumns(const Model& model);

  /// Boxes that hold the clusters at that time but for rounding, for which a BoxRay gives way.
  /// Valid while this lives.
  MovingBoxes at(const KeyInterval& at) const;
  std::size_t bytes() const { return columns_.capacity() * sizeof(float); }

 private:
  std::size_t clusters_, stride_;
  std::vector<float> columns_;  ///< F times low x, high x, low y, high y, low z, high z
};

}  // namespace mdk
