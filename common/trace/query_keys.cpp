#include "common/trace/query_keys.h"

namespace mdk {

KeyPoses::KeyPoses(const ModelView& model) : model_(&model) {
  if (model.poses.kind != PoseKind::kKeyPositions)
    slots_ = std::make_unique<Slot[]>(model.key_count());
}

const Vec3f* KeyPoses::key(std::uint32_t key) const {
  if (slots_ == nullptr)
    return model_->poses.key_positions.data() + std::size_t{key} * model_->vertex_count;
  Slot& slot = slots_[key];
  // In one thread: a parallel loop in here might pick up a ray that waits for this very key.
  std::call_once(slot.once, [&] {
    slot.positions.resize(model_->vertex_count);
    decode_pose(*model_, key, {0, model_->vertex_count}, slot.positions);
    decoded_.fetch_add(slot.positions.size() * sizeof(Vec3f), std::memory_order_relaxed);
  });
  return slot.positions.data();
}

VertexSource KeyPoses::at(const KeyInterval& at) const {
  return {key(at.key0), key(at.key1), at.key0 == at.key1 ? 0.0f : at.s};
}

BoxColumns::BoxColumns(const ModelView& model)
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
