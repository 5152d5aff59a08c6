#include "common/trace/box_columns.h"

namespace mdk {

BoxColumns::BoxColumns(const Model& model)
    : clusters_(model.cluster_count()),
      stride_((clusters_ + kMovingBoxLanes - 1) / kMovingBoxLanes * kMovingBoxLanes),
      columns_(6 * stride_ * model.key_count()) {
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    float* const columns = &columns_[6 * stride_ * key];
    for (std::size_t c = 0; c < clusters_; ++c) {
      const Aabb box = model.world_box(key, c);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        columns[2 * axis * stride_ + c] = box.lo[axis];
        columns[(2 * axis + 1) * stride_ + c] = box.hi[axis];
      }
    }
  }
}

MovingBoxes BoxColumns::at(const KeyInterval& at) const {
  const auto key = [&](std::uint32_t k) { return columns_.data() + 6 * stride_ * k; };
  return {key(at.key0), key(at.key1), at.key0 == at.key1 ? 0.0f : at.s, clusters_, stride_};
}

}  // namespace mdk
