// PartialModel: a model of which some clusters are left out. Triangles and clusters keep their
// numbers: a triangle that is left out shrinks to its first corner, which no ray hits and every box
// that held it still holds, and its cluster's world boxes shrink to a point, so that no ray enters
// it. So every technique shows the part, unchanged, and a model shown whole costs nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

class PartialModel {
 public:
  /// `left_out`: one per cluster, not 0 where it is. The memory of `whole` must outlive this. Cost:
  /// O(triangles + keys * clusters).
  PartialModel(const Model& whole, std::span<const std::uint8_t> left_out);
  PartialModel(const PartialModel&) = delete;
  PartialModel& operator=(const PartialModel&) = delete;

  const Model& model() const { return model_; }

 private:
  Model model_;
  std::vector<Triangle> triangles_;
  std::vector<QuantizedBox> world_boxes_;
};

}  // namespace mdk
