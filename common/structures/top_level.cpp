// A node halves its largest part at the median until it has eight; each part of more than one box
// is a node again.
#include "common/structures/top_level.h"

#include <algorithm>
#include <array>
#include <utility>

namespace mdk {
namespace {

Vec3f centroid(const Aabb& box) { return box.lo * 0.5f + box.hi * 0.5f; }

class TopLevelBuilder {
 public:
  TopLevelBuilder(std::span<const Aabb> boxes, TopLevel& top) : boxes_(boxes), top_(top) {}

  void run() {
    top_.nodes.clear();
    top_.box_of_leaf.clear();
    for (std::uint32_t i = 0; i < boxes_.size(); ++i)
      if (!boxes_[i].empty()) top_.box_of_leaf.push_back(i);
    const auto count = static_cast<std::uint32_t>(top_.box_of_leaf.size());
    if (count > 0) build({0, count});
  }

 private:
  /// A run of top_.box_of_leaf.
  struct Part {
    std::uint32_t begin, end;
    std::uint32_t count() const { return end - begin; }
  };

  std::uint32_t build(const Part& whole) {
    const auto index = static_cast<std::uint32_t>(top_.nodes.size());
    top_.nodes.emplace_back();
    std::array<Part, kBvhWidth> parts{whole};
    std::uint32_t count = 1;
    while (count < kBvhWidth) {
      const auto end = parts.begin() + count;
      const auto largest = std::max_element(
          parts.begin(), end, [](const Part& a, const Part& b) { return a.count() < b.count(); });
      if (largest->count() <= 1) break;
      const std::uint32_t middle = halve(*largest);
      parts[count++] = {middle, largest->end};
      largest->end = middle;
    }
    for (std::uint32_t c = 0; c < count; ++c) {
      const WideBvhChild child = parts[c].count() == 1 ? WideBvhChild::leaf(parts[c].begin)
                                                       : WideBvhChild::inner(build(parts[c]));
      top_.nodes[index].child[c] = child;
      top_.nodes[index].set_box(c, box_of(parts[c]));
    }
    top_.nodes[index].count = count;
    top_.nodes[index].pad();
    return index;
  }

  Aabb box_of(const Part& part) const {
    Aabb box;
    for (std::uint32_t i = part.begin; i < part.end; ++i) box.extend(boxes_[top_.box_of_leaf[i]]);
    return box;
  }

  /// Median along the widest axis of the centroids; equal ones are told apart by number.
  std::uint32_t halve(const Part& part) {
    Aabb centroids;
    for (std::uint32_t i = part.begin; i < part.end; ++i)
      centroids.extend(centroid(boxes_[top_.box_of_leaf[i]]));
    const Vec3f extent = centroids.extent();
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (extent[a] > extent[axis]) axis = a;
    const std::uint32_t middle = part.begin + part.count() / 2;
    const auto begin = top_.box_of_leaf.begin();
    std::nth_element(begin + part.begin, begin + middle, begin + part.end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(centroid(boxes_[a])[axis], a) <
                              std::pair(centroid(boxes_[b])[axis], b);
                     });
    return middle;
  }

  std::span<const Aabb> boxes_;
  TopLevel& top_;
};

}  // namespace

void build_top_level(std::span<const Aabb> boxes, TopLevel& top) {
  TopLevelBuilder(boxes, top).run();
}

}  // namespace mdk
