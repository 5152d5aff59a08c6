#include "common/trace/instance_tree.h"

#include <algorithm>

#include "common/base/parallel.h"
#include "common/structures/bvh.h"

namespace mdk {
namespace {

constexpr std::size_t kPerChunk = 4096, kNodesPerChunk = 512;

/// Of an instance that is not there: a point, since structures are built over boxes.
constexpr Aabb kNowhere{{0, 0, 0}, {0, 0, 0}};

}  // namespace

Aabb InstanceTree::box(std::uint32_t instance, double time) const {
  const Aabb box =
      stage_->is_moving(instance) ? stage_->box_at(instance, time) : stage_->box_always(instance);
  return box.empty() ? kNowhere : box;
}

InstanceTree::InstanceTree(const Stage& stage, double time) : stage_(&stage), time_(time) {
  const std::uint32_t count = stage.instance_count();
  std::vector<Aabb> boxes(count);
  std::vector<double> most((count + kPerChunk - 1) / kPerChunk, 1);
  parallel_chunks(count, kPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto instance = static_cast<std::uint32_t>(i);
      boxes[i] = box(instance, time);
      double& largest = most[begin / kPerChunk];
      largest = std::max(largest, stage.unevenness(instance));
    }
  });
  for (const double m : most) unevenness_ = std::max(unevenness_, m);

  WideBvh tree = collapse(build_bvh(boxes, {.bins = 16, .max_leaf = 1}));
  nodes_ = std::move(tree.nodes);
  instance_of_leaf_.reserve(count);
  for (std::size_t leaf = 0; leaf < tree.items.size(); leaf += kLeafItems)
    instance_of_leaf_.push_back(tree.items[leaf]);

  std::vector<std::uint8_t> moves(nodes_.size(), 0);
  for (std::size_t n = nodes_.size(); n-- > 0;)
    for (std::uint32_t c = 0; c < nodes_[n].count; ++c) {
      const WideBvhChild child = nodes_[n].child[c];
      const bool moving = child.is_leaf() ? stage.is_moving(instance_of_leaf_[child.index()])
                                          : moves[child.index()] != 0;
      if (moving) moves[n] = 1;
    }
  for (std::uint32_t n = 0; n < moves.size(); ++n)
    if (moves[n] != 0) moving_nodes_.push_back(n);
}

void InstanceTree::update(double time) {
  if (moving_nodes_.empty() || time == time_) return;
  time_ = time;
  parallel_chunks(moving_nodes_.size(), kNodesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      WideBvhNode& node = nodes_[moving_nodes_[i]];
      for (std::uint32_t c = 0; c < node.count; ++c) {
        if (!node.child[c].is_leaf()) continue;
        const std::uint32_t instance = instance_of_leaf_[node.child[c].index()];
        if (stage_->is_moving(instance)) node.set_box(c, box(instance, time));
      }
    }
  });
  for (std::size_t i = moving_nodes_.size(); i-- > 0;) {
    WideBvhNode& node = nodes_[moving_nodes_[i]];
    for (std::uint32_t c = 0; c < node.count; ++c)
      if (!node.child[c].is_leaf()) node.set_box(c, nodes_[node.child[c].index()].box());
    node.pad();
  }
}

}  // namespace mdk
