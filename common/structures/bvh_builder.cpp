// build_bvh(): top-down binned SAH. Large nodes are binned and parted by all threads together, in
// fixed chunks; what is left below them are subtrees, each built by one thread. Who builds what
// depends on the input alone, and so does the result. Items go to and fro between two arrays: a
// node's are read from one and written, parted, to the other.
#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include "common/base/parallel.h"
#include "common/structures/bvh.h"
#include "common/structures/bvh_bins.h"
#include "common/structures/link_check.h"
#include "common/structures/top_down.h"

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
  std::size_t chunk_count() const { return (count() + kChunkItems - 1) / kChunkItems; }
  Aabb box() const { return bounds.box.box(); }
};

struct Halves {
  Run below, above;

  /// Of `run`, without bounds.
  Halves(const Run& run, std::uint32_t middle, std::uint32_t source)
      : below{run.begin, middle, run.depth + 1, source, {}},
        above{middle, run.end, run.depth + 1, source, {}} {}
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
  /// Where the items of `run` go.
  BuildItem* destination(const Run& run) { return arrays_[run.source ^ 1u].data(); }

  bool is_surely_leaf(const Run& run) const {
    return run.count() == 1 || run.depth == kMaxBvhDepth ||
           (run.count() <= config_.block && run.count() <= config_.max_leaf &&
            config_.traversal_cost >= 0);
  }

  /// More bins than twice the items, or than a few per block, would tell nothing new.
  Binning choose_bins(const Run& run) const {
    const std::uint64_t useful = std::max<std::uint64_t>(
        4,
        std::min(2 * std::uint64_t{run.count()}, 8 * std::uint64_t{run.count()} / config_.block));
    return {run.bounds.centroids,
            static_cast<int>(std::min(useful, static_cast<std::uint64_t>(config_.bins)))};
  }

  /// The cheapest split, or nothing where a leaf is cheaper. A split that is not found() stands for
  /// one in the middle.
  std::optional<SahSplit> choose_split(const Run& run, const Binning& binning, Bins& bins) const {
    const QuadBox& box = run.bounds.box;
    const SahSplit split = bins.best_split(binning, box, config_);
    if (run.count() <= config_.max_leaf) {
      const float whole = box.has_area() ? box.half_area() : box.edge_length();
      const float leaf = config_.intersect_cost * config_.leaf_tests(run.count()) * whole;
      const float parted = config_.traversal_cost * whole + config_.intersect_cost * split.cost;
      if (!split.found() || parted >= leaf) return {};
    }
    // A split so lopsided that its larger part might not fit under the depth limit is not taken.
    const std::uint32_t larger = std::max(split.below_count, run.count() - split.below_count);
    return larger > max_items_at(run.depth + 1) ? SahSplit{} : split;
  }

  /// Object median along the widest axis.
  Halves halve(const Run& run) {
    const auto all = std::span(arrays_[run.source]).subspan(run.begin, run.count());
    part_at_median(
        all, run.bounds.centroids.box(),
        [](const BuildItem& item, std::size_t axis) { return item.centroid().v[axis]; },
        [](const BuildItem& item) { return item.index(); });
    Halves halves(run, run.begin + run.count() / 2, run.source);
    halves.below.bounds = RunBounds(of(halves.below));
    halves.above.bounds = RunBounds(of(halves.above));
    return halves;
  }

 private:
  /// How many items a node of this depth can hold if it is halved from there on.
  std::uint64_t max_items_at(std::uint32_t depth) const {
    const std::uint32_t levels = std::min(kMaxBvhDepth - depth, 32u);
    return std::uint64_t{config_.max_leaf} << levels;
  }

  BvhBuildConfig config_;
  std::array<std::vector<BuildItem>, 2> arrays_;
};

/// Divides the runs of a subtree, by one thread; writes the references of its leaves.
class SubtreeSplitter {
 public:
  using Part = Run;
  using Split = Halves;

  SubtreeSplitter(Items& items, std::span<std::uint32_t> refs) : items_(items), refs_(refs) {}

  std::optional<Halves> try_split(const Run& run) {
    if (items_.is_surely_leaf(run)) return {};
    const Binning binning = items_.choose_bins(run);
    bins_.clear(binning.bins());
    bins_.add(items_.of(run), binning);
    const std::optional<SahSplit> split = items_.choose_split(run, binning, bins_);
    if (!split) return {};
    return split->found() ? part(run, binning, *split) : items_.halve(run);
  }

  BvhNode make_inner(const Run& run, const Halves&, std::uint32_t children) const {
    return BvhNode::inner(run.box(), children);
  }

  BvhNode make_leaf(const Run& run) {
    const auto first = refs_.begin() + run.begin;
    std::ranges::transform(items_.of(run), first, &BuildItem::index);
    std::sort(first, first + run.count());
    return BvhNode::leaf(run.box(), run.begin, run.count());
  }

 private:
  /// Without branches: every item is written at both ends, and one end moves on.
  Halves part(const Run& run, const Binning& binning, const SahSplit& split) {
    BuildItem* const to = items_.destination(run);
    std::uint32_t low = run.begin, high = run.end;
    for (const BuildItem& item : items_.of(run)) {
      const bool is_below = binning.bin(item.centroid())[split.axis] < split.plane;
      to[low] = item;
      to[high - 1] = item;
      low += is_below;
      high -= !is_below;
    }
    Halves halves(run, low, run.source ^ 1u);
    halves.below.bounds = RunBounds(items_.of(halves.below));
    halves.above.bounds = RunBounds(items_.of(halves.above));
    return halves;
  }

  Items& items_;
  std::span<std::uint32_t> refs_;
  Bins bins_;
};

/// Divides large runs, each by all threads. Its leaves stand for the subtrees that are left, by
/// number.
class LargeSplitter {
 public:
  using Part = Run;
  using Split = Halves;

  explicit LargeSplitter(Items& items) : items_(items) {}

  /// All `count` items.
  Run whole(std::uint32_t count) {
    Run all{0, count, 0, 0, {}};
    chunks_.resize(all.chunk_count());
    for_chunks(all, [](Chunk& chunk, auto items) { chunk.below = RunBounds(items); });
    for (const Chunk& chunk : chunks_) all.bounds.merge(chunk.below);
    return all;
  }
  const std::vector<Run>& subtrees() const { return subtrees_; }

  std::optional<Halves> try_split(const Run& run) {
    if (run.count() <= kSubtreeItems) return {};
    const Binning binning = items_.choose_bins(run);
    for_chunks(run, [&](Chunk& chunk, auto items) {
      chunk.bins.clear(binning.bins());
      chunk.bins.add(items, binning);
    });
    Bins all;
    all.clear(binning.bins());
    for (std::size_t c = 0; c < run.chunk_count(); ++c) all.merge(chunks_[c].bins);
    const std::optional<SahSplit> split = items_.choose_split(run, binning, all);
    assert(split && "leaves are smaller than large runs");
    return split->found() ? scatter(run, binning, *split) : items_.halve(run);
  }

  BvhNode make_inner(const Run& run, const Halves&, std::uint32_t children) const {
    return BvhNode::inner(run.box(), children);
  }

  BvhNode make_leaf(const Run& run) {
    subtrees_.push_back(run);
    return BvhNode::leaf(run.box(), static_cast<std::uint32_t>(subtrees_.size() - 1), run.count());
  }

 private:
  /// What one chunk of a run holds.
  struct Chunk {
    Bins bins;
    std::uint32_t first_below = 0, first_above = 0;  ///< where its items go
    RunBounds below, above;
  };

  template <class Body>
  void for_chunks(const Run& run, const Body& body) {
    parallel_chunks(run.count(), kChunkItems, [&](std::size_t begin, std::size_t end) {
      body(chunks_[begin / kChunkItems], items_.of(run).subspan(begin, end - begin));
    });
  }

  /// Each chunk's items go to places of their own, which the bins' counts give in advance.
  Halves scatter(const Run& run, const Binning& binning, const SahSplit& split) {
    Halves halves(run, run.begin + split.below_count, run.source ^ 1u);
    std::uint32_t low = halves.below.begin, high = halves.above.begin;
    for (std::size_t c = 0; c < run.chunk_count(); ++c) {
      const auto size = static_cast<std::uint32_t>(
          std::min<std::size_t>(kChunkItems, run.count() - c * kChunkItems));
      const std::uint32_t in_below = chunks_[c].bins.count_below(split);
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
    for (std::size_t c = 0; c < run.chunk_count(); ++c) {
      halves.below.bounds.merge(chunks_[c].below);
      halves.above.bounds.merge(chunks_[c].above);
    }
    return halves;
  }

  Items& items_;
  std::vector<Run> subtrees_;
  std::vector<Chunk> chunks_;
};

/// Puts each subtree where its leaf stands among `nodes`: its root in the leaf's place, the others,
/// whose links count among themselves, behind what there is.
void attach(std::vector<std::vector<BvhNode>> subtrees, std::vector<BvhNode>& nodes) {
  std::vector<std::size_t> places(subtrees.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].is_leaf()) places[nodes[i].first] = i;
  for (std::size_t s = 0; s < subtrees.size(); ++s) {
    std::vector<BvhNode>& subtree = subtrees[s];
    const auto shift = static_cast<std::uint32_t>(nodes.size()) - 1;
    for (BvhNode& node : subtree)
      if (!node.is_leaf()) node.first += shift;
    nodes[places[s]] = subtree[0];
    nodes.insert(nodes.end(), subtree.begin() + 1, subtree.end());
  }
}

/// The union of what is under a node.
Aabb box_under(const Bvh& bvh, const BvhNode& node, std::span<const Aabb> boxes) {
  Aabb box;
  if (node.is_leaf()) {
    for (std::uint32_t r = 0; r < node.count; ++r) box.extend(boxes[bvh.refs[node.first + r]]);
  } else {
    box = bvh.nodes[node.first].box();
    box.extend(bvh.nodes[node.first + 1].box());
  }
  return box;
}

}  // namespace

Bvh build_bvh(std::span<const Aabb> boxes, const BvhBuildConfig& config) {
  assert(config.bins >= 2 && config.bins <= kMaxBins);
  assert(config.max_leaf >= 1 && config.max_leaf <= kSubtreeItems && config.block >= 1);
  Bvh bvh;
  if (boxes.empty()) return bvh;
  bvh.refs.resize(boxes.size());
  Items items(boxes, config);
  LargeSplitter large(items);
  bvh.nodes =
      build_top_down<BvhNode>(large, large.whole(static_cast<std::uint32_t>(boxes.size())), 1);
  std::vector<std::vector<BvhNode>> subtrees(large.subtrees().size());
  parallel_chunks(subtrees.size(), 1, [&](std::size_t i, std::size_t) {
    const Run& run = large.subtrees()[i];
    SubtreeSplitter splitter(items, bvh.refs);
    subtrees[i] = build_top_down<BvhNode>(splitter, run, 4 * (run.count() / config.max_leaf + 1));
  });
  attach(std::move(subtrees), bvh.nodes);
  assert(validate(bvh, boxes, config.max_leaf).empty());
  return bvh;
}

std::string validate(const Bvh& bvh, std::span<const Aabb> boxes, std::uint32_t max_leaf) {
  LinkCheck nodes("node", bvh.nodes.size(), kMaxBvhDepth), items("item", boxes.size());
  if (!bvh.nodes.empty()) nodes.reach(0);
  const auto fault_of = [&](std::size_t i) -> std::string {
    const BvhNode& node = bvh.nodes[i];
    if (!nodes.is_reached(i)) return "no node before it links to it";
    if (node.is_leaf()) {
      if (node.count > max_leaf) return "a leaf of " + std::to_string(node.count) + " items";
      if (std::size_t{node.first} + node.count > bvh.refs.size()) return "a leaf past the end";
      for (std::uint32_t r = 0; r < node.count; ++r)
        if (std::string fault = items.reach(bvh.refs[node.first + r]); !fault.empty()) return fault;
    } else {
      for (const std::size_t child : {std::size_t{node.first}, std::size_t{node.first} + 1})
        if (std::string fault = nodes.reach(child, nodes.depth(i) + 1); !fault.empty())
          return fault;
    }
    return node.box() == box_under(bvh, node, boxes) ? "" : "its box is not that of its content";
  };
  for (std::size_t i = 0; i < bvh.nodes.size(); ++i)
    if (const std::string fault = fault_of(i); !fault.empty()) return nodes.name(i) + ": " + fault;
  return items.find_missing();
}

}  // namespace mdk
