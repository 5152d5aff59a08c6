#include "common/trace/key_poses.h"

namespace mdk {

KeyPoses::KeyPoses(const Model& model) : model_(&model) {
  if (model.poses.kind != PoseKind::kKeyPositions)
    slots_ = std::make_unique<Slot[]>(model.key_count());
}

const Vec3f* KeyPoses::at(std::uint32_t key) const {
  if (slots_ == nullptr)
    return model_->poses.key_positions.data() + std::size_t{key} * model_->vertex_count;
  Slot& slot = slots_[key];
  // In one thread: a parallel loop in here might pick up a ray that waits for this very key.
  std::call_once(slot.once, [&] {
    slot.positions.resize(model_->vertex_count);
    decode_pose(*model_, key, {0, model_->vertex_count}, slot.positions);
  });
  return slot.positions.data();
}

std::size_t KeyPoses::bytes() const {
  std::size_t vertices = 0;
  if (slots_ != nullptr)
    for (std::uint32_t key = 0; key < model_->key_count(); ++key)
      vertices += slots_[key].positions.size();
  return vertices * sizeof(Vec3f);
}

}  // namespace mdk
