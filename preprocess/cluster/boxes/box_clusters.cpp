#include "preprocess/cluster/boxes/box_clusters.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/simd/point_kernels.h"

namespace mdk {
namespace {

constexpr std::size_t kTrianglesPerChunk = 2048;
constexpr std::uint32_t kRowsForGrowth = 8;
/// A triangle moves only for more than this share of its area: less is float noise.
constexpr float kMinShare = 1e-3f;

constexpr std::size_t kBlockTriangles = 256;
/// A box over a few rows is part of the box over all, so its area bounds the latter from below:
/// clusters that are already too expensive on a few rows, nearly all of them, are not looked at
/// further.
constexpr std::uint32_t kBoundRows = 6;

/// The maps of one cluster as the kernels take them.
struct CandidateMaps {
  std::vector<Affine3f> maps;  ///< R
  FloatWeights weights;
};

/// Some consecutive triangles with their vertices gathered.
class TriangleBlock {
 public:
  TriangleBlock(const MovingMesh& mesh, std::size_t first, std::size_t count) {
    std::vector<std::uint32_t> vertices;
    for (std::size_t t = first; t < first + count; ++t)
      vertices.insert(vertices.end(), mesh.triangles[t].v, mesh.triangles[t].v + 3);
    corners_ = vertices;
    vertices = sorted_unique(std::move(vertices));
    for (std::uint32_t& corner : corners_)
      corner = static_cast<std::uint32_t>(
          std::lower_bound(vertices.begin(), vertices.end(), corner) - vertices.begin());
    vertex_count_ = vertices.size();
    row_count_ = mesh.poses.row_count();
    points_ = gather_vertices(mesh.poses, vertices);
  }

  std::size_t size() const { return corners_.size() / 3; }

  /// Areas of the triangles' boxes over every `step`-th row; `boxes` is scratch space.
  void measure(const CandidateMaps& candidate, std::uint32_t step, PointBoxes& boxes,
               float* areas) const {
    boxes.reset(vertex_count_);
    extend_boxes({candidate.maps.data(), (row_count_ + step - 1) / step, step, points_.from(0),
                  step * vertex_count_},
                 vertex_count_, boxes.row());
    triangle_box_areas(corners_.data(), size(), boxes.row(), candidate.weights.w, areas);
  }

 private:
  std::size_t vertex_count_ = 0;
  std::uint32_t row_count_ = 0;
  std::vector<std::uint32_t> corners_;  ///< 3 per triangle: numbers of gathered vertices
  PointArrays points_;                  ///< row by row
};

/// The part of the answer that one block of triangles has.
class BlockAlternatives {
 public:
  BlockAlternatives(const TriangleBlock& block, std::span<const std::uint32_t> own,
                    std::span<const CandidateMaps> candidates)
      : block_(block), own_(own), candidates_(candidates), areas_(block.size()) {}

  /// Looks at all candidates, the most promising first. `first`: the block's first triangle.
  void find(std::uint32_t row_count, std::size_t first, BoxAlternatives& result) {
    const std::uint32_t step = std::max(1u, row_count / kBoundRows);
    const std::size_t size = block_.size();
    std::vector<float> bounds(candidates_.size() * size);
    std::vector<double> sums(candidates_.size());
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      block_.measure(candidates_[c], step, boxes_, &bounds[c * size]);
      for (std::size_t t = 0; t < size; ++t) sums[c] += static_cast<double>(bounds[c * size + t]);
    }
    std::vector<std::uint32_t> order(candidates_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sums[a] < sums[b]; });
    for (const std::uint32_t c : order)
      if (may_matter(c, &bounds[c * size], &result.other_area[first])) look_at(c, first, result);
  }

 private:
  bool may_matter(std::uint32_t c, const float* bounds, const float* best) const {
    for (std::size_t t = 0; t < own_.size(); ++t)
      if (own_[t] == c || bounds[t] < best[t]) return true;
    return false;
  }

  void look_at(std::uint32_t c, std::size_t first, BoxAlternatives& result) {
    block_.measure(candidates_[c], 1, boxes_, areas_.data());
    for (std::size_t i = 0; i < own_.size(); ++i) {
      const std::size_t t = first + i;
      if (own_[i] == c) {
        result.own_area[t] = areas_[i];
      } else if (areas_[i] < result.other_area[t] ||
                 (areas_[i] == result.other_area[t] && c < result.other[t])) {
        result.other_area[t] = areas_[i];
        result.other[t] = c;
      }
    }
  }

  const TriangleBlock& block_;
  std::span<const std::uint32_t> own_;
  std::span<const CandidateMaps> candidates_;
  std::vector<float> areas_;
  PointBoxes boxes_;
};

/// What a triangle would add to the cost of entering a cluster: its world boxes grow.
double entry_growth(const BoxProblem& problem, const BoxCluster& cluster, const Triangle& t) {
  const PoseTable& table = problem.mesh.poses;
  const std::uint32_t step = (table.row_count() + kRowsForGrowth - 1) / kRowsForGrowth;
  double sum = 0, rows = 0;
  for (std::uint32_t row = 0; row < table.row_count(); row += step) {
    rows += 1;
    if (!(problem.measure.model_areas[row] > 0)) continue;
    const Aabb& box = cluster.world_boxes[row];
    Aabb grown = box;
    for (const std::uint32_t v : t.v) grown.extend(to_float(table.position(row, v)));
    sum += (surface_area(grown) - surface_area(box)) / problem.measure.model_areas[row];
  }
  return sum / rows * kEnteringCost;
}

/// Where triangles go that would cost less in another cluster.
std::vector<std::uint32_t> reassigned(const BoxProblem& problem, const BoxClustering& clustering) {
  const std::span<const Triangle> triangles = problem.mesh.triangles;
  const BoxAlternatives alternatives = find_alternatives(problem, clustering);
  std::vector<std::uint32_t> assignment = clustering.cluster_of_triangle;
  parallel_chunks(triangles.size(), kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const double gain = alternatives.own_area[t] * (1 - kMinShare) - alternatives.other_area[t];
      const std::uint32_t other = alternatives.other[t];
      if (gain > 0 && !(entry_growth(problem, clustering.clusters[other], triangles[t]) >= gain))
        assignment[t] = other;
    }
  });
  return assignment;
}

}  // namespace

/// The triangles of a mesh, block by block.
struct TriangleBlocks {
  std::vector<TriangleBlock> blocks;

  explicit TriangleBlocks(const MovingMesh& mesh) {
    const std::size_t triangles = mesh.triangles.size();
    std::vector<std::optional<TriangleBlock>> made((triangles + kBlockTriangles - 1) /
                                                   kBlockTriangles);
    parallel_chunks(triangles, kBlockTriangles, [&](std::size_t begin, std::size_t end) {
      made[begin / kBlockTriangles].emplace(mesh, begin, end - begin);
    });
    for (std::optional<TriangleBlock>& block : made) blocks.push_back(*std::move(block));
  }
};

BoxClustering fit_boxes(const BoxProblem& problem, std::vector<std::uint32_t> cluster_of_triangle) {
  BoxClustering result{make_assignment(std::move(cluster_of_triangle)), {}, 0};
  const ClusterMembers members = problem.mesh.members_of(result);
  result.clusters.resize(result.cluster_count);
  parallel_chunks(result.clusters.size(), 1, [&](std::size_t c, std::size_t) {
    result.clusters[c] = fit_box_cluster(
        problem.measure, gather_points(problem.mesh.poses, members, static_cast<std::uint32_t>(c)));
  });
  for (const BoxCluster& c : result.clusters) result.cost += c.work.cost();
  return result;
}

BoxClustering relax_boxes(const BoxProblem& problem, BoxClustering start,
                          const RelaxLimits& limits) {
  return relax_rounds(
      std::move(start), limits, &BoxClustering::cost,
      [&](const BoxClustering& clustering) { return reassigned(problem, clustering); },
      [&](std::vector<std::uint32_t> assignment) {
        return fit_boxes(problem, std::move(assignment));
      });
}

BoxAlternatives find_alternatives(const BoxProblem& problem, const BoxClustering& clustering) {
  const std::size_t triangles = problem.mesh.triangles.size();
  BoxAlternatives result;
  result.own_area.resize(triangles);
  result.other_area.assign(triangles, std::numeric_limits<float>::infinity());
  result.other.assign(triangles, 0);
  std::vector<CandidateMaps> candidates(clustering.clusters.size());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const BoxCluster& cluster = clustering.clusters[c];
    candidates[c].weights = to_float(cluster.work.weights * problem.measure.triangle_weight);
    for (const Affine3d& map : cluster.maps) candidates[c].maps.push_back(to_float(map));
  }
  if (problem.blocks == nullptr) problem.blocks = std::make_shared<TriangleBlocks>(problem.mesh);
  parallel_chunks(triangles, kBlockTriangles, [&](std::size_t begin, std::size_t end) {
    BlockAlternatives(problem.blocks->blocks[begin / kBlockTriangles],
                      std::span(clustering.cluster_of_triangle).subspan(begin, end - begin),
                      candidates)
        .find(problem.mesh.poses.row_count(), begin, result);
  });
  return result;
}

std::vector<std::uint32_t> assign_to_smallest_boxes(const BoxProblem& problem,
                                                    std::vector<BoxCluster> clusters) {
  BoxClustering nowhere;
  nowhere.clusters = std::move(clusters);
  nowhere.cluster_count = static_cast<std::uint32_t>(nowhere.clusters.size());
  nowhere.cluster_of_triangle.assign(problem.mesh.triangles.size(), nowhere.cluster_count);
  return find_alternatives(problem, nowhere).other;
}

}  // namespace mdk
