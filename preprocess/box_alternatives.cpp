#include "preprocess/box_alternatives.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "common/base/parallel.h"
#include "common/trace/kernels/point_kernels.h"

namespace mdk {
namespace {

constexpr std::size_t kBlockTriangles = 256;
constexpr std::uint32_t kBoundRows = 6;  // whose boxes bound those of all rows from below

/// The maps of one cluster as the kernels take them.
struct CandidateMaps {
  std::vector<Affine3f> maps;  ///< R
  AreaWeights weights;
};

/// Some consecutive triangles with their vertices gathered, and boxes of these.
class TriangleBlock {
 public:
  TriangleBlock(const MovingMesh& mesh, std::size_t first, std::size_t count) {
    std::vector<std::uint32_t> vertices;
    for (std::size_t t = first; t < first + count; ++t)
      vertices.insert(vertices.end(), mesh.triangles[t].v, mesh.triangles[t].v + 3);
    corners_ = vertices;
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (std::uint32_t& corner : corners_)
      corner = static_cast<std::uint32_t>(
          std::lower_bound(vertices.begin(), vertices.end(), corner) - vertices.begin());
    vertex_count_ = vertices.size();
    row_count_ = mesh.poses.row_count();
    gather(mesh.poses.x, mesh.poses, vertices, x_);
    gather(mesh.poses.y, mesh.poses, vertices, y_);
    gather(mesh.poses.z, mesh.poses, vertices, z_);
    for (int axis = 0; axis < 3; ++axis) {
      lo_[axis].resize(vertex_count_);
      hi_[axis].resize(vertex_count_);
    }
  }

  std::size_t size() const { return corners_.size() / 3; }

  /// Areas of the triangles' boxes over every `step`-th row.
  void measure(const CandidateMaps& candidate, std::uint32_t step, float* areas) {
    for (int axis = 0; axis < 3; ++axis) {
      std::fill(lo_[axis].begin(), lo_[axis].end(), std::numeric_limits<float>::max());
      std::fill(hi_[axis].begin(), hi_[axis].end(), std::numeric_limits<float>::lowest());
    }
    const BoxRow sides{{lo_[0].data(), lo_[1].data(), lo_[2].data()},
                       {hi_[0].data(), hi_[1].data(), hi_[2].data()}};
    for (std::uint32_t row = 0; row < row_count_; row += step) {
      const std::size_t at = row * vertex_count_;
      extend_boxes(candidate.maps[row], {&x_[at], &y_[at], &z_[at]}, vertex_count_, sides);
    }
    for (std::size_t t = 0; t < size(); ++t) areas[t] = area(&corners_[3 * t], candidate.weights);
  }

 private:
  void gather(const std::vector<float>& from, const PoseTable& table,
              std::span<const std::uint32_t> vertices, std::vector<float>& to) {
    to.resize(row_count_ * vertex_count_);
    float* out = to.data();
    for (std::uint32_t row = 0; row < row_count_; ++row) {
      const float* in = &from[table.row_offset(row)];
      for (const std::uint32_t v : vertices) *out++ = in[v];
    }
  }

  float area(const std::uint32_t* v, const AreaWeights& weights) const {
    float e[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float *l = lo_[axis].data(), *h = hi_[axis].data();
      e[axis] = std::max(std::max(h[v[0]], h[v[1]]), h[v[2]]) -
                std::min(std::min(l[v[0]], l[v[1]]), l[v[2]]);
    }
    return static_cast<float>(weights.area({e[0], e[1], e[2]}));
  }

  std::size_t vertex_count_ = 0;
  std::uint32_t row_count_ = 0;
  std::vector<std::uint32_t> corners_;  ///< 3 per triangle: numbers of gathered vertices
  std::vector<float> x_, y_, z_;        ///< row-major
  std::vector<float> lo_[3], hi_[3];
};

/// The part of the answer that one block of triangles has.
class BlockAlternatives {
 public:
  BlockAlternatives(TriangleBlock& block, std::span<const std::uint32_t> own,
                    std::span<const CandidateMaps> candidates)
      : block_(block), own_(own), candidates_(candidates), areas_(block.size()) {}

  /// Looks at all candidates, the most promising first. `first`: the block's first triangle.
  void find(std::uint32_t row_count, std::size_t first, BoxAlternatives& result) {
    const std::uint32_t step = std::max(1u, row_count / kBoundRows);
    const std::size_t size = block_.size();
    std::vector<float> bounds(candidates_.size() * size);
    std::vector<double> sums(candidates_.size());
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      block_.measure(candidates_[c], step, &bounds[c * size]);
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
    block_.measure(candidates_[c], 1, areas_.data());
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

  TriangleBlock& block_;
  std::span<const std::uint32_t> own_;
  std::span<const CandidateMaps> candidates_;
  std::vector<float> areas_;
};

}  // namespace

BoxAlternatives find_alternatives(const BoxProblem& problem, const BoxClustering& clustering) {
  const std::size_t triangles = problem.mesh.triangles.size();
  BoxAlternatives result;
  result.own_area.resize(triangles);
  result.other_area.assign(triangles, std::numeric_limits<float>::infinity());
  result.other.assign(triangles, 0);
  std::vector<CandidateMaps> candidates(clustering.cluster_count());
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const BoxCluster& cluster = clustering.clusters[c];
    candidates[c].weights = cluster.work.weights * problem.measure.triangle_weight;
    for (const Affine3d& map : cluster.maps) candidates[c].maps.push_back(to_float(map));
  }
  parallel_chunks(triangles, kBlockTriangles, [&](std::size_t begin, std::size_t end) {
    TriangleBlock block(problem.mesh, begin, end - begin);
    BlockAlternatives(block, std::span(clustering.cluster_of_triangle).subspan(begin, end - begin),
                      candidates)
        .find(problem.mesh.poses.row_count(), begin, result);
  });
  return result;
}

std::vector<std::uint32_t> assign_to_smallest_boxes(const BoxProblem& problem,
                                                    std::vector<BoxCluster> clusters) {
  BoxClustering nowhere;
  nowhere.clusters = std::move(clusters);
  nowhere.cluster_of_triangle.assign(problem.mesh.triangles.size(), nowhere.cluster_count());
  return find_alternatives(problem, nowhere).other;
}

}  // namespace mdk
