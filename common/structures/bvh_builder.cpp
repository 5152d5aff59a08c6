// Top-down binned SAH. Large nodes are binned and parted by all threads together, in fixed chunks;
// what is left below them are subtrees, each built by one thread. Who builds what depends on the
// input alone, and so does the result. Items go to and fro between two arrays: a node's are read
// from one and written, parted, to the other.
#include <algorithm>
#include <cassert>
#include <utility>

#include "common/base/parallel.h"
#include "common/structures/bvh.h"
#include "common/structures/bvh_bins.h"

namespace mdk {
namespace {

constexpr std::uint32_t kSubtreeItems = 4096;  ///< no more: one thread's work
constexpr std::size_t kChunkItems = 4096;

/// A run of items that becomes a subtree.
struct Run {
  std::uint32_t begin, end, depth;
  std::uint32_t source;  ///< which of the two arrays holds it
  RunBounds bounds;

  std::uint32_t count() const { return end - begin; }
};

/// How a node is divided: by a plane between bins, or in the middle.
struct Division {
  bool is_leaf = false;
  bool halved = false;
  SahSplit split;
};

/// The two arrays, and what decides how a run is divided: shared by all threads.
class Items {
 public:
  Items(std::span<const Aabb> boxes, const BvhBuildConfig& config) : config_(config) {
    for (auto& array : arrays_) array.resize(boxes.size());
    parallel_chunks(boxes.size(), kChunkItems, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        assert(!boxes[i].empty());
        arrays_[0][i] = BuildItem(boxes[i], static_cast<std::uint32_t>(i));
      }
    });
  }

  const BvhBuildConfig& config() const { return config_; }
  std::span<const BuildItem> of(const Run& run) const {
    return std::span(arrays_[run.source]).subspan(run.begin, run.count());
  }
  std::span<BuildItem> of(const Run& run) {
    return std::span(arrays_[run.source]).subspan(run.begin, run.count());
  }
  /// Where the items of `run` go.
  BuildItem* destination(const Run& run) { return arrays_[run.source ^ 1u].data(); }

  /// More bins than twice the items, or than a few per block, would tell nothing new.
  Binning choose_bins(const Run& run) const {
    const std::uint64_t useful = std::max<std::uint64_t>(
        4,
        std::min(2 * std::uint64_t{run.count()}, 8 * std::uint64_t{run.count()} / config_.block));
    return {run.bounds.centroids,
            static_cast<int>(std::min(useful, static_cast<std::uint64_t>(config_.bins)))};
  }

  Division divide(const Run& run, const Binning& binning, Bins& bins) const {
    Division division{.split = bins.best_split(binning, run.bounds.box, config_)};
    const SahSplit& split = division.split;
    if (run.count() <= config_.max_leaf) {
      const QuadBox& box = run.bounds.box;
      const float whole = box.half_area() > 0 ? box.half_area() : box.edge_length();
      const float leaf = config_.intersect_cost * block_tests(run.count(), config_.block) * whole;
      const float parted = config_.traversal_cost * whole + config_.intersect_cost * split.cost;
      division.is_leaf = !split.found() || parted >= leaf;
    }
    // A split so lopsided that its larger part might not fit under the depth limit is not taken.
    const std::uint32_t larger = std::max(split.below_count, run.count() - split.below_count);
    division.halved = !split.found() || larger > most_items_at(run.depth + 1);
    return division;
  }

  bool is_surely_leaf(const Run& run) const {
    return run.count() == 1 || run.depth == kMaxBvhDepth ||
           (run.count() <= config_.block && run.count() <= config_.max_leaf &&
            config_.traversal_cost >= 0);
  }

 private:
  /// How many items a node of this depth can hold if it is halved from there on.
  std::uint64_t most_items_at(std::uint32_t depth) const {
    const std::uint32_t levels = std::min(kMaxBvhDepth - depth, 32u);
    return std::uint64_t{config_.max_leaf} << levels;
  }

  BvhBuildConfig config_;
  std::array<std::vector<BuildItem>, 2> arrays_;
};

std::pair<Run, Run> children_of(const Run& run, std::uint32_t middle, std::uint32_t source) {
  return {Run{run.begin, middle, run.depth + 1, source, {}},
          Run{middle, run.end, run.depth + 1, source, {}}};
}

RunBounds bounds_of(std::span<const BuildItem> items) {
  RunBounds bounds;
  for (const BuildItem& item : items) bounds.add(item);
  return bounds;
}

/// Object median along the widest axis; equal centroids are told apart by number.
std::pair<Run, Run> halve(Items& items, const Run& run) {
  const Vec3f extent = run.bounds.centroids.box().extent();
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (extent[a] > extent[axis]) axis = a;
  const auto all = items.of(run);
  const std::uint32_t half = run.count() / 2;
  std::nth_element(all.begin(), all.begin() + half, all.end(),
                   [axis](const BuildItem& a, const BuildItem& b) {
                     return std::pair(a.centroid().v[axis], a.index()) <
                            std::pair(b.centroid().v[axis], b.index());
                   });
  auto [below, above] = children_of(run, run.begin + half, run.source);
  below.bounds = bounds_of(items.of(below));
  above.bounds = bounds_of(items.of(above));
  return {below, above};
}

/// A subtree by one thread: nodes with links among themselves, leaves in the common references.
class SubtreeBuilder {
 public:
  SubtreeBuilder(Items& items, std::span<std::uint32_t> refs) : items_(items), refs_(refs) {}

  std::vector<BvhNode> build(const Run& run) {
    nodes_.reserve(4 * (run.count() / items_.config().max_leaf + 1));
    nodes_.resize(1);
    build_node(0, run);
    return std::move(nodes_);
  }

 private:
  void build_node(std::uint32_t index, const Run& run) {
    nodes_[index].set_box(run.bounds.box.box());
    if (items_.is_surely_leaf(run)) return make_leaf(index, run);
    const Binning binning = items_.choose_bins(run);
    bins_.clear(binning.bins());
    bins_.add(items_.of(run), binning);
    const Division division = items_.divide(run, binning, bins_);
    if (division.is_leaf) return make_leaf(index, run);
    const auto [below, above] =
        division.halved ? halve(items_, run) : part(run, binning, division.split);
    const auto children = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index].first = children;
    nodes_.resize(children + 2u);
    build_node(children, below);
    build_node(children + 1, above);
  }

  /// Without branches: every item is written at both ends, and one end moves on.
  std::pair<Run, Run> part(const Run& run, const Binning& binning, const SahSplit& split) {
    BuildItem* const to = items_.destination(run);
    std::uint32_t low = run.begin, high = run.end;
    for (const BuildItem& item : items_.of(run)) {
      const bool is_below = binning.bin(item.centroid())[split.axis] < split.plane;
      to[low] = item;
      to[high - 1] = item;
      low += is_below;
      high -= !is_below;
    }
    auto [below, above] = children_of(run, low, run.source ^ 1u);
    below.bounds = bounds_of(items_.of(below));
    above.bounds = bounds_of(items_.of(above));
    return {below, above};
  }

  void make_leaf(std::uint32_t index, const Run& run) {
    const auto first = refs_.begin() + run.begin;
    std::transform(items_.of(run).begin(), items_.of(run).end(), first,
                   [](const BuildItem& item) { return item.index(); });
    std::sort(first, first + run.count());
    nodes_[index].first = run.begin;
    nodes_[index].count = run.count();
  }

  Items& items_;
  std::span<std::uint32_t> refs_;
  std::vector<BvhNode> nodes_;
  Bins bins_;
};

class BvhBuilder {
 public:
  BvhBuilder(std::span<const Aabb> boxes, const BvhBuildConfig& config) : items_(boxes, config) {
    assert(config.bins >= 2 && config.bins <= kMaxBins);
    assert(config.max_leaf >= 1 && config.block >= 1);
    bvh_.refs.resize(boxes.size());
  }

  Bvh build() {
    if (bvh_.refs.empty()) return {};
    Run all{0, static_cast<std::uint32_t>(bvh_.refs.size()), 0, 0, {}};
    all.bounds = chunk_bounds(all);
    bvh_.nodes.resize(1);
    build_top(0, all);
    build_subtrees();
    return std::move(bvh_);
  }

 private:
  struct Subtree {
    std::uint32_t node;
    Run run;
    std::vector<BvhNode> nodes;
  };
  /// What one chunk of a large node holds.
  struct Chunk {
    Bins bins;
    std::uint32_t first_below = 0, first_above = 0;  ///< where its items go
    RunBounds below, above;
  };

  void build_top(std::uint32_t index, const Run& run) {
    if (run.count() <= kSubtreeItems) {
      subtrees_.push_back({index, run, {}});
      return;
    }
    bvh_.nodes[index].set_box(run.bounds.box.box());
    const auto [below, above] = part_large(run);
    const auto children = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes[index].first = children;
    bvh_.nodes.resize(children + 2u);
    build_top(children, below);
    build_top(children + 1, above);
  }

  template <class Body>
  void for_chunks(const Run& run, const Body& body) {
    parallel_chunks(run.count(), kChunkItems, [&](std::size_t begin, std::size_t end) {
      body(chunks_[begin / kChunkItems],
           std::span<const BuildItem>(items_.of(run)).subspan(begin, end - begin));
    });
  }

  RunBounds chunk_bounds(const Run& run) {
    chunks_.resize((run.count() + kChunkItems - 1) / kChunkItems);
    for_chunks(run, [](Chunk& chunk, auto items) { chunk.below = bounds_of(items); });
    RunBounds bounds;
    for (const Chunk& chunk : chunks_) bounds.merge(chunk.below);
    return bounds;
  }

  std::pair<Run, Run> part_large(const Run& run) {
    const Binning binning = items_.choose_bins(run);
    const std::size_t count = (run.count() + kChunkItems - 1) / kChunkItems;
    if (chunks_.size() < count) chunks_.resize(count);
    for_chunks(run, [&](Chunk& chunk, auto items) {
      chunk.bins.clear(binning.bins());
      chunk.bins.add(items, binning);
    });
    Bins all;
    all.clear(binning.bins());
    for (std::size_t c = 0; c < count; ++c) all.merge(chunks_[c].bins);
    const Division division = items_.divide(run, binning, all);
    if (division.halved) return halve(items_, run);
    return scatter(run, binning, division.split);
  }

  /// Each chunk's items go to places of their own, which the bins' counts foretell.
  std::pair<Run, Run> scatter(const Run& run, const Binning& binning, const SahSplit& split) {
    auto [below, above] = children_of(run, run.begin + split.below_count, run.source ^ 1u);
    const std::size_t count = (run.count() + kChunkItems - 1) / kChunkItems;
    std::uint32_t low = below.begin, high = above.begin;
    for (std::size_t c = 0; c < count; ++c) {
      const std::size_t begin = c * kChunkItems;
      const auto size =
          static_cast<std::uint32_t>(std::min<std::size_t>(kChunkItems, run.count() - begin));
      const std::uint32_t in_below = chunks_[c].bins.count_below(split.axis, split.plane);
      chunks_[c].first_below = low;
      chunks_[c].first_above = high;
      low += in_below;
      high += size - in_below;
    }
    BuildItem* const to = items_.destination(run);
    for_chunks(run, [&](Chunk& chunk, auto items) {
      chunk.below = chunk.above = {};
      std::uint32_t next_below = chunk.first_below, next_above = chunk.first_above;
      for (const BuildItem& item : items) {
        const bool is_below = binning.bin(item.centroid())[split.axis] < split.plane;
        to[is_below ? next_below++ : next_above++] = item;
        (is_below ? chunk.below : chunk.above).add(item);
      }
    });
    for (std::size_t c = 0; c < count; ++c) {
      below.bounds.merge(chunks_[c].below);
      above.bounds.merge(chunks_[c].above);
    }
    return {below, above};
  }

  void build_subtrees() {
    parallel_chunks(subtrees_.size(), 1, [&](std::size_t i, std::size_t) {
      subtrees_[i].nodes = SubtreeBuilder(items_, bvh_.refs).build(subtrees_[i].run);
    });
    for (Subtree& subtree : subtrees_) {
      // Node 0 of a subtree has its place; the others follow what there is.
      const auto shift = static_cast<std::uint32_t>(bvh_.nodes.size()) - 1;
      for (BvhNode& node : subtree.nodes)
        if (!node.is_leaf()) node.first += shift;
      bvh_.nodes[subtree.node] = subtree.nodes[0];
      bvh_.nodes.insert(bvh_.nodes.end(), subtree.nodes.begin() + 1, subtree.nodes.end());
    }
  }

  Items items_;
  Bvh bvh_;
  std::vector<Subtree> subtrees_;
  std::vector<Chunk> chunks_;
};

}  // namespace

Bvh build_bvh(std::span<const Aabb> boxes, const BvhBuildConfig& config) {
  return BvhBuilder(boxes, config).build();
}

}  // namespace mdk
