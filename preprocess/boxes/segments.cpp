#include "preprocess/boxes/segments.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/boxes/fuzzy_boxes.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {
namespace {

constexpr std::uint32_t kBlocks = 64;       // candidates for cuts, where their number is free
constexpr std::size_t kMaxClipStarts = 48;  // up to so many clips each start is a candidate
constexpr std::uint32_t kMaxChosen = 2048;  // more segments than this are of one length
constexpr std::size_t kRuns = 16'384;       // runs of blocks that are looked at
constexpr std::size_t kBoxes = 512 * 1024;  // of sampled triangles in all blocks
constexpr std::size_t kMinTriangles = 256;

/// Bytes of a segment per triangle: a fuzzy box, and its share of nodes and references of a kd-tree
/// (24 on the sample hand).
constexpr double kBytesPerTriangle = 24 + 24;
/// What a byte of boxes and trees per triangle of the model must save at least, in expected
/// triangle tests per ray that hits it.
constexpr double kPricePerByte = 0.01;

/// Blocks of consecutive smallest segments.
struct Blocks {
  std::vector<Segment> keys;
  std::vector<std::uint32_t> intervals;  ///< how many smallest segments each one has

  std::uint32_t count() const { return static_cast<std::uint32_t>(keys.size()); }
};

/// `wanted` blocks of one length, each cut at clips' starts where there are at most
/// `max_clip_starts`.
Blocks make_blocks(std::span<const Segment> smallest, std::uint32_t wanted,
                   std::size_t max_clip_starts) {
  const std::size_t count = smallest.size();
  std::vector<bool> starts(count, false);
  for (std::size_t b = 0; b < wanted; ++b) starts[b * count / wanted] = true;
  std::vector<std::size_t> clip_starts;
  for (std::size_t i = 1; i < count; ++i)
    if (smallest[i].first_key != smallest[i - 1].last_key) clip_starts.push_back(i);
  if (clip_starts.size() <= max_clip_starts)
    for (const std::size_t i : clip_starts) starts[i] = true;
  Blocks blocks;
  for (std::size_t i = 0; i < count; ++i) {
    if (starts[i]) {
      blocks.keys.push_back(smallest[i]);
      blocks.intervals.push_back(0);
    }
    blocks.keys.back().last_key = smallest[i].last_key;
    ++blocks.intervals.back();
  }
  return blocks;
}

/// Some triangles of every cluster that stand for all.
struct Sample {
  ClusterMembers members;      ///< of the sampled triangles
  std::vector<double> stands;  ///< K: how many triangles each sampled one stands for
};

Sample sample_triangles(const PoseSequence& sequence, const ClusterMembers& members,
                        std::size_t wanted) {
  const std::uint32_t clusters = members.cluster_count();
  const std::size_t stride = (members.triangles.size() + wanted - 1) / wanted;
  Sample sample;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> cluster_of_triangle;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    const std::span<const std::uint32_t> all = members.triangles_of(c);
    const std::size_t before = triangles.size();
    for (std::size_t i = 0; i < all.size(); i += stride) {
      triangles.push_back(sequence.triangles[all[i]]);
      cluster_of_triangle.push_back(c);
    }
    const std::size_t taken = std::max<std::size_t>(1, triangles.size() - before);
    sample.stands.push_back(static_cast<double>(all.size()) / static_cast<double>(taken));
  }
  sample.members = make_cluster_members(triangles, {std::move(cluster_of_triangle), clusters},
                                        sequence.vertex_count);
  return sample;
}

/// Expected triangle tests of a ray at a random time, spent within each run of blocks.
class RunWork {
 public:
  RunWork(const Blocks& blocks, const Sample& sample, const AreaWeightTable& weights)
      : blocks_(blocks), sample_(sample), weights_(weights) {
    for (const std::uint32_t n : blocks.intervals) all_intervals_ += n;
  }

  /// Costs of the runs that start with `first`. `boxes`: per block, of the sampled triangles.
  void fill(std::uint32_t first, std::span<const std::vector<Aabb>> boxes, RunCosts& costs) const {
    std::vector<Aabb> unions = boxes[first];
    const std::uint32_t last = std::min(blocks_.count() - first, costs.longest) + first - 1;
    double intervals = 0;
    for (std::uint32_t b = first; b <= last; ++b) {
      if (b > first)
        for (std::size_t t = 0; t < unions.size(); ++t) unions[t].extend(boxes[b][t]);
      intervals += blocks_.intervals[b];
      costs.of(first, b) = intervals / all_intervals_ * work(unions, first, b);
    }
  }

 private:
  double work(std::span<const Aabb> boxes, std::uint32_t first, std::uint32_t last) const {
    const ClusterMembers& members = sample_.members;
    double sum = 0;
    for (std::uint32_t c = 0; c < members.cluster_count(); ++c) {
      FaceSums faces;
      for (std::uint32_t t = members.triangle_begin[c]; t < members.triangle_begin[c + 1]; ++t)
        faces.add(boxes[t]);
      sum += sample_.stands[c] * faces.area(weights_.mean(c, blocks_.keys[first].first_key,
                                                          blocks_.keys[last].last_key));
    }
    return sum;
  }

  const Blocks& blocks_;
  const Sample& sample_;
  const AreaWeightTable& weights_;
  double all_intervals_ = 0;
};

RunCosts run_costs(const PoseSequence& sequence, const ClusterMembers& members,
                   std::span<const Affine3f> local_from_world, const Blocks& blocks,
                   std::uint32_t longest, BetweenKeys between) {
  const Sample sample =
      sample_triangles(sequence, members, std::max(kBoxes / blocks.count(), kMinTriangles));
  std::vector<std::vector<Aabb>> boxes;
  for (const Segment& keys : blocks.keys)
    boxes.push_back(fuzzy_boxes(sequence, sample.members, local_from_world, keys, between));
  const AreaWeightTable weights(local_from_world, pose_box_areas(sequence));
  const RunWork work(blocks, sample, weights);
  RunCosts costs(blocks.count(), longest);
  parallel_chunks(blocks.count(), 1, [&](std::size_t first, std::size_t) {
    work.fill(static_cast<std::uint32_t>(first), boxes, costs);
  });
  return costs;
}

constexpr double kImpossible = std::numeric_limits<double>::infinity();

/// The cheapest ways to cover the first blocks with some number of runs: entry j is for j of them.
struct Covers {
  std::vector<double> cost;
  std::vector<std::uint32_t> last_run;  ///< first block of its last run

  explicit Covers(std::uint32_t blocks)
      : cost(blocks + std::size_t{1}, kImpossible), last_run(blocks + std::size_t{1}, 0) {}
};

/// Makes `covers` at `end` the cheapest cover that is one of `shorter` and one more run.
void add_last_run(const RunCosts& costs, const std::vector<double>& shorter, std::uint32_t end,
                  Covers& covers) {
  for (std::uint32_t first = end - std::min(end, costs.longest); first < end; ++first) {
    const double cost = shorter[first] + costs.of(first, end - 1);
    if (cost < covers.cost[end]) {
      covers.cost[end] = cost;
      covers.last_run[end] = first;
    }
  }
}

}  // namespace

std::vector<Segment> smallest_segments(std::span<const Clip> clips) {
  std::vector<Segment> segments;
  for (const Clip& clip : clips) {
    if (clip.key_count == 1) segments.push_back({clip.first_key, clip.first_key});
    for (std::uint32_t i = 1; i < clip.key_count; ++i)
      segments.push_back({clip.first_key + i - 1, clip.first_key + i});
  }
  return segments;
}

std::vector<Segment> choose_segments(const PoseSequence& sequence, const ClusterMembers& members,
                                     std::span<const Affine3f> local_from_world,
                                     std::uint32_t count, BetweenKeys between) {
  const std::vector<Segment> smallest = smallest_segments(sequence.clips);
  const auto max_count = static_cast<std::uint32_t>(smallest.size());
  count = std::min(count, max_count);
  if (count == 1 || max_count == 1) return {{0, sequence.key_count() - 1}};
  if (count == max_count) return smallest;
  if (count > kMaxChosen) return make_blocks(smallest, count, 0).keys;

  // At least twice as many candidates as cuts, so that there is a choice.
  const Blocks blocks =
      make_blocks(smallest, std::min(max_count, std::max(kBlocks, 2 * count)), kMaxClipStarts);
  const std::size_t even = count == 0 ? blocks.count() : blocks.count() / count;
  const std::size_t longest =
      std::min<std::size_t>(blocks.count(), std::max(4 * even, kRuns / blocks.count()));
  const RunCosts costs = run_costs(sequence, members, local_from_world, blocks,
                                   static_cast<std::uint32_t>(longest), between);
  const std::vector<std::uint32_t> runs =
      count == 0 ? cheapest_runs(costs, kPricePerByte * kBytesPerTriangle)
                 : cheapest_runs_of_count(costs, count);
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::uint32_t last = (i + 1 < runs.size() ? runs[i + 1] : blocks.count()) - 1;
    segments.push_back({blocks.keys[runs[i]].first_key, blocks.keys[last].last_key});
  }
  return segments;
}

std::vector<std::uint32_t> cheapest_runs(const RunCosts& costs, double price) {
  Covers covers(costs.blocks);
  covers.cost[0] = 0;
  for (std::uint32_t end = 1; end <= costs.blocks; ++end) {
    add_last_run(costs, covers.cost, end, covers);
    covers.cost[end] += price;
  }
  std::vector<std::uint32_t> runs;
  for (std::uint32_t end = costs.blocks; end > 0; end = runs.back())
    runs.push_back(covers.last_run[end]);
  std::reverse(runs.begin(), runs.end());
  return runs;
}

std::vector<std::uint32_t> cheapest_runs_of_count(const RunCosts& costs, std::uint32_t count) {
  std::vector<std::vector<std::uint32_t>> last_runs;  // per number of runs
  Covers shorter(costs.blocks);
  shorter.cost[0] = 0;
  for (std::uint32_t n = 1; n <= count; ++n) {
    Covers covers(costs.blocks);
    for (std::uint32_t end = n; end <= costs.blocks; ++end)
      add_last_run(costs, shorter.cost, end, covers);
    last_runs.push_back(covers.last_run);
    shorter = std::move(covers);
  }
  std::vector<std::uint32_t> runs;
  for (std::uint32_t n = count, end = costs.blocks; n > 0; --n) {
    end = last_runs[n - 1][end];
    runs.push_back(end);
  }
  std::reverse(runs.begin(), runs.end());
  return runs;
}

}  // namespace mdk
