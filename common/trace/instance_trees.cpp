#include "common/trace/instance_trees.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kInstancesPerChunk = 1024;
constexpr double kStretchSeconds = 1;      // a walker's box doubles in that time
constexpr std::size_t kMaxStretches = 64;  // and no more boxes than
constexpr std::size_t kMaxMovingBoxes = std::size_t{1} << 20;

/// One instance a leaf, whose link is the instance's number. Instances with empty boxes are left
/// out.
std::vector<WideBvhNode> build_tree(std::span<const Aabb> all,
                                    std::span<const std::uint32_t> numbers) {
  std::vector<Aabb> boxes;
  std::vector<std::uint32_t> instances;
  boxes.reserve(all.size());
  instances.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].empty()) continue;
    boxes.push_back(all[i]);
    instances.push_back(numbers[i]);
  }
  if (boxes.empty()) return {};
  WideBvh tree = collapse(build_bvh(boxes, {.bins = 16, .max_leaf = 1}));
  parallel_chunks(tree.nodes.size(), kInstancesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      for (WideBvhChild& child : tree.nodes[n].child)
        if (child.is_leaf())
          child =
              WideBvhChild::leaf(instances[tree.items[std::size_t{kLeafItems} * child.index()]]);
  });
  tree.nodes.shrink_to_fit();
  return std::move(tree.nodes);
}

}  // namespace

InstanceTrees::InstanceTrees(const Stage& stage) {
  const SceneView& scene = stage.scene();
  std::vector<std::uint32_t> standing, moving;
  for (std::uint32_t i = 0; i < stage.instance_count(); ++i)
    (stage.is_moving(i) ? moving : standing).push_back(i);

  std::vector<Aabb> boxes(std::max(standing.size(), moving.size()));
  const auto find_boxes = [&](std::span<const std::uint32_t> numbers, const auto& box_of) {
    parallel_chunks(numbers.size(), kInstancesPerChunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) boxes[i] = box_of(numbers[i]);
    });
    return std::span<const Aabb>(boxes).first(numbers.size());
  };
  standing_ = build_tree(find_boxes(standing, [&](std::uint32_t i) { return stage.box_always(i); }),
                         standing);

  if (!moving.empty()) {
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for (const ScenePath& path : scene.paths) {
      const auto keys = scene.keys_of(path);
      first = std::min(first, keys.front().time);
      last = std::max(last, keys.back().time);
    }
    const double wanted = std::ceil((last - first) / kStretchSeconds);
    const std::size_t most =
        std::clamp(kMaxMovingBoxes / moving.size(), std::size_t{1}, kMaxStretches);
    const std::size_t stretches = wanted < static_cast<double>(most)
                                      ? std::max(std::size_t{1}, static_cast<std::size_t>(wanted))
                                      : most;
    first_time_ = first;
    stretch_seconds_ = last > first ? (last - first) / static_cast<double>(stretches) : 1;
    const double forever = std::numeric_limits<double>::infinity();
    // Stretches overlap a little: which one a time is in is computed with rounding.
    const double margin =
        stretch_seconds_ * 1e-6 + std::max(std::abs(first), std::abs(last)) * 1e-14;
    for (std::size_t s = 0; s < stretches + 2; ++s) {
      const double begin =
          s == 0 ? -forever : first + static_cast<double>(s - 1) * stretch_seconds_ - margin;
      const double end =
          s == stretches + 1 ? forever : first + static_cast<double>(s) * stretch_seconds_ + margin;
      moving_.push_back(build_tree(
          find_boxes(moving, [&](std::uint32_t i) { return stage.box_over(i, begin, end); }),
          moving));
    }
  }
  for (const WideBvhNode& node :
       standing_.empty() ? std::span<const WideBvhNode>() : std::span(standing_).first(1))
    bounds_.extend(node.box());
  for (const auto& tree : moving_)
    if (!tree.empty()) bounds_.extend(tree.front().box());

  std::vector<double> most(stage.instance_count() / kInstancesPerChunk + 1, 1);
  parallel_chunks(stage.instance_count(), kInstancesPerChunk,
                  [&](std::size_t begin, std::size_t end) {
                    double& mine = most[begin / kInstancesPerChunk];
                    for (std::size_t i = begin; i < end; ++i)
                      mine = std::max(mine, stage.unevenness(static_cast<std::uint32_t>(i)));
                  });
  unevenness_ = std::ranges::max(most);
}

std::size_t InstanceTrees::stretch_of(double time) const {
  const double place = (time - first_time_) / stretch_seconds_;
  if (!(place >= 0)) return 0;
  const auto last = static_cast<double>(moving_.size() - 1);
  return static_cast<std::size_t>(std::min(place + 1, last));
}

std::size_t InstanceTrees::bytes() const {
  std::size_t sum = standing_.capacity() * sizeof(WideBvhNode);
  for (const auto& tree : moving_) sum += tree.capacity() * sizeof(WideBvhNode);
  return sum;
}

}  // namespace mdk
