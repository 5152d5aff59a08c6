// Refinement of a cluster's maps towards the smallest fuzzy boxes (GFW06 §4.1 notes that surface
// area is the better measure, and minimises squared distances all the same).
//
// The cost of a cluster is 2 sum over sides of W S: S sums the products of the boxes' extents, W is
// the mean over keys of what a local side is worth in the world (cost.h). Both are functions of the
// maps alone. Extents are ranges over time, which are not smooth; they are replaced by a 16-norm
// about the boxes' middles,
//
//     max over t of |x(t) - c|   <=   (sum over t of (x(t) - c)^16)^(1/16),
//
// which weighs the extreme keys and forgets the others. L-BFGS (Ceres) descends in the coordinates
// in which every key's points have unit scatter, where all entries of a map count alike. It needs
// sums and square roots alone, which are the same on every machine. A step that would turn the sign
// of a map's determinant is none: the descent shortens it, so no map mirrors that did not before.
#include <ceres/ceres.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "preprocess/maps/cluster_maps.h"

namespace mdk {
namespace {

using Matrix = Eigen::Matrix3d;

constexpr int kRestarts = 2;     // each moves the middles to where the boxes are now
constexpr int kIterations = 10;  // of L-BFGS, each about one evaluation
constexpr std::size_t kParametersPerRow = 12;
constexpr float kMinScale = 0.02f;  // of the mean extent: keeps 16th powers inside float
constexpr float kMinNorm = 0.01f;   // below it a vertex stands still

/// x^15 by squaring.
float power15(float x) {
  const float x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  return x8 * x4 * (x2 * x);
}

/// The points of each row in coordinates in which they have unit scatter.
struct WhitePoints {
  std::vector<Matrix> factor;   ///< R: x = factor w, lower triangular
  std::vector<Matrix> inverse;  ///< R
  PointArrays points;           ///< R * stride

  explicit WhitePoints(const ClusterPoints& source) {
    points.resize(source.row_count * source.stride);
    for (std::uint32_t row = 0; row < source.row_count; ++row) add_row(source, row);
  }

 private:
  void add_row(const ClusterPoints& source, std::uint32_t row) {
    const std::size_t at = source.row_offset(row);
    Matrix scatter = Matrix::Zero();
    for (std::size_t i = at; i < at + source.vertex_count; ++i) {
      const Eigen::Vector3d p(source.x[i], source.y[i], source.z[i]);
      scatter += p * p.transpose();
    }
    scatter /= std::max(1.0, static_cast<double>(source.vertex_count));
    const double ridge = 1e-3 * scatter.trace() + 1e-14;
    const Matrix lower = (scatter + ridge * Matrix::Identity()).llt().matrixL();
    factor.push_back(lower);
    inverse.push_back(lower.inverse());
    const Eigen::Matrix3f narrow = inverse.back().cast<float>();
    for (std::size_t i = at; i < at + source.vertex_count; ++i) {
      const Eigen::Vector3f w = narrow * Eigen::Vector3f(source.x[i], source.y[i], source.z[i]);
      points.set(i, {w(0), w(1), w(2)});
    }
  }
};

/// The smooth cost of one cluster and its gradient over all rows' maps.
class SmoothCost final : public ceres::FirstOrderFunction {
 public:
  SmoothCost(const ClusterPoints& points, const WhitePoints& white, std::span<const double> areas)
      : points_(points), white_(white), areas_(areas) {
    for (const double a : areas_) counted_rows_ += a > 0;
  }

  /// Sets the boxes' middles, the scale of powers and the caps of weights by these maps.
  void settle(std::span<const Affine3d> maps) {
    const PointBoxes boxes = mapped_boxes(points_, maps);
    for (int k = 0; k < 3; ++k) {
      middle_[k].resize(points_.stride);
      scale_[k].resize(points_.stride);
      double sum = 0;
      for (std::size_t i = 0; i < points_.stride; ++i) {
        middle_[k][i] = 0.5f * (boxes.lo[k][i] + boxes.hi[k][i]);
        scale_[k][i] = 0.5f * (boxes.hi[k][i] - boxes.lo[k][i]);
      }
      for (std::size_t i = 0; i < points_.vertex_count; ++i) sum += scale_[k][i];
      mean_extent_[k] = static_cast<float>(sum / points_.vertex_count);
    }
    const float least = kMinScale * std::max({mean_extent_[0], mean_extent_[1], mean_extent_[2]});
    for (std::vector<float>& s : scale_)
      for (float& v : s) v = std::max(v, std::max(least, 1e-12f));
    const AreaWeights caps = area_weight_caps(maps, areas_);
    caps_ = {caps.yz, caps.zx, caps.xy};
    is_mirrored_.clear();
    for (const Affine3d& map : maps) is_mirrored_.push_back(map.determinant() < 0);
    unit_ = 1;
    double value = 0;
    std::vector<double> start = parameters_of(maps);
    Evaluate(start.data(), &value, nullptr);
    if (value > 0 && std::isfinite(value)) unit_ = 1 / value;
  }

  std::vector<double> parameters_of(std::span<const Affine3d> maps) const {
    std::vector<double> parameters;
    parameters.reserve(kParametersPerRow * maps.size());
    for (std::size_t row = 0; row < maps.size(); ++row)
      for (int i = 0; i < 3; ++i) {
        const Eigen::RowVector3d linear(maps[row].m[i][0], maps[row].m[i][1], maps[row].m[i][2]);
        const Eigen::RowVector3d white = linear * white_.factor[row];
        for (int j = 0; j < 3; ++j) parameters.push_back(white(j));
        parameters.push_back(maps[row].m[i][3]);
      }
    return parameters;
  }

  std::vector<Affine3d> maps_of(std::span<const double> parameters) const {
    std::vector<Affine3d> maps(points_.row_count);
    for (std::size_t row = 0; row < maps.size(); ++row) {
      const Matrix linear = linear_part(&parameters[kParametersPerRow * row], row);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) maps[row].m[i][j] = linear(i, j);
        maps[row].m[i][3] =
            parameters[kParametersPerRow * row + 4 * static_cast<std::size_t>(i) + 3];
      }
    }
    return maps;
  }

  int NumParameters() const override {
    return static_cast<int>(kParametersPerRow * points_.row_count);
  }

  bool Evaluate(const double* parameters, double* value, double* gradient) const override {
    if (turns_a_map_over(parameters)) return false;
    Norms norms = vertex_norms(parameters);
    const Sides weights = mean_weights(parameters);
    Norms pull;
    for (std::vector<float>& p : pull.axis) p.assign(points_.stride, 0.0f);
    const Sides sums = side_sums(norms, weights, pull);
    double cost = 0;
    for (std::size_t s = 0; s < 3; ++s) cost += 2 * weights[s] * sums[s];
    *value = cost * unit_;
    if (gradient != nullptr) {
      std::fill_n(gradient, NumParameters(), 0.0);
      for (int k = 0; k < 3; ++k) add_pull(parameters, k, norms.axis[k], pull.axis[k], gradient);
      add_weight_gradient(parameters, sums, gradient);
      for (int i = 0; i < NumParameters(); ++i) gradient[i] *= unit_;
    }
    return std::isfinite(*value);
  }

 private:
  /// One number per side: spanned by axes 1 and 2, 2 and 0, 0 and 1 (the normal's axis counts).
  using Sides = std::array<double, 3>;
  struct Norms {
    std::vector<float> axis[3];  ///< stride
  };

  Matrix linear_part(const double* row_parameters, std::size_t row) const {
    Matrix white;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) white(i, j) = row_parameters[4 * i + j];
    return white * white_.inverse[row];
  }

  /// Whether the determinant of any map has another sign than at the start, or none.
  bool turns_a_map_over(const double* parameters) const {
    for (std::size_t row = 0; row < points_.row_count; ++row) {
      const double det = linear_part(parameters + kParametersPerRow * row, row).determinant();
      if (!(is_mirrored_[row] ? det < 0 : det > 0)) return true;
    }
    return false;
  }

  /// What a side with unit extents is worth in the world under a map with this linear part.
  Sides side_weights(const Matrix& linear) const {
    const double det = std::abs(linear.determinant());
    return {linear.row(0).norm() / det, linear.row(1).norm() / det, linear.row(2).norm() / det};
  }

  Sides mean_weights(const double* parameters) const {
    Sides mean{};
    for (std::size_t row = 0; row < points_.row_count; ++row) {
      if (!(areas_[row] > 0)) continue;
      const Sides w = side_weights(linear_part(parameters + kParametersPerRow * row, row));
      for (std::size_t s = 0; s < 3; ++s) mean[s] += std::min(w[s] / areas_[row], caps_[s]);
    }
    for (double& m : mean) m /= std::max(1, counted_rows_);
    return mean;
  }

  ScaledCoordinate coordinate(const double* parameters, std::uint32_t row, int k,
                              const std::vector<float>& per_scale) const {
    const double* p = parameters + kParametersPerRow * row + 4 * k;
    return {{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
             static_cast<float>(p[3])},
            middle_[k].data(),
            per_scale.data()};
  }

  /// (sum over rows of ((x - c) / h)^16)^(1/16) per vertex and axis.
  Norms vertex_norms(const double* parameters) const {
    Norms norms;
    const std::size_t n = points_.stride;
    for (int k = 0; k < 3; ++k) {
      norms.axis[k].assign(n, 0.0f);
      std::vector<float> per_scale(n);
      for (std::size_t i = 0; i < n; ++i) per_scale[i] = 1 / scale_[k][i];
      std::vector<float>& sum = norms.axis[k];
      for (std::uint32_t row = 0; row < points_.row_count; ++row)
        add_sixteenth_powers(coordinate(parameters, row, k, per_scale),
                             white_.points.from(points_.row_offset(row)), n, sum.data());
      for (std::size_t i = 0; i < n; ++i)
        sum[i] = std::sqrt(std::sqrt(std::sqrt(std::sqrt(sum[i]))));
    }
    return norms;
  }

  /// Sums of products of extents; `pull` receives the derivative of the cost by half-extents.
  Sides side_sums(const Norms& norms, const Sides& weights, Norms& pull) const {
    Sides sums{};
    for (std::size_t t = 0; t < points_.triangle_count(); ++t) {
      const std::uint32_t* v = &points_.corners[3 * t];
      std::uint32_t top[3], bottom[3];
      double extent[3];
      for (std::size_t k = 0; k < 3; ++k) {
        float highest = -std::numeric_limits<float>::infinity(), lowest = -highest;
        top[k] = bottom[k] = v[0];
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::uint32_t i = v[corner];
          const float half = scale_[k][i] * norms.axis[k][i];
          if (middle_[k][i] + half > highest) {
            highest = middle_[k][i] + half;
            top[k] = i;
          }
          if (middle_[k][i] - half < lowest) {
            lowest = middle_[k][i] - half;
            bottom[k] = i;
          }
        }
        extent[k] = static_cast<double>(highest) - lowest;
      }
      for (std::size_t s = 0; s < 3; ++s) {
        const std::size_t a = (s + 1) % 3, b = (s + 2) % 3;
        sums[s] += extent[a] * extent[b];
        const auto by_a = static_cast<float>(2 * weights[s] * extent[b]);
        const auto by_b = static_cast<float>(2 * weights[s] * extent[a]);
        pull.axis[a][top[a]] += by_a;
        pull.axis[a][bottom[a]] += by_a;
        pull.axis[b][top[b]] += by_b;
        pull.axis[b][bottom[b]] += by_b;
      }
    }
    return sums;
  }

  /// d half-extent / d x = ((x - c) / h)^15 / norm^15, times d x / d map, summed over vertices.
  void add_pull(const double* parameters, int k, std::span<const float> norm,
                std::span<const float> pull, double* gradient) const {
    const std::size_t n = points_.stride;
    std::vector<float> strength(n), per_scale(n);
    for (std::size_t i = 0; i < n; ++i) {
      per_scale[i] = 1 / scale_[k][i];
      strength[i] = norm[i] > kMinNorm ? pull[i] / power15(norm[i]) : 0.0f;
    }
    for (std::uint32_t row = 0; row < points_.row_count; ++row) {
      double sum[4] = {};
      add_pulls(coordinate(parameters, row, k, per_scale),
                white_.points.from(points_.row_offset(row)), strength.data(), n, sum);
      double* out = gradient + kParametersPerRow * row + 4 * k;
      for (int j = 0; j < 4; ++j) out[j] += sum[j];
    }
  }

  /// W of side s at a row is |a_s| / |det A|, and d|det A| = |det A| A^-T : dA.
  void add_weight_gradient(const double* parameters, const Sides& sums, double* gradient) const {
    for (std::size_t row = 0; row < points_.row_count; ++row) {
      if (!(areas_[row] > 0)) continue;
      const Matrix linear = linear_part(parameters + kParametersPerRow * row, row);
      const Sides w = side_weights(linear);
      const Matrix by_determinant = linear.inverse().transpose();
      Matrix slope = Matrix::Zero();
      for (int s = 0; s < 3; ++s) {
        const auto side = static_cast<std::size_t>(s);
        if (!(w[side] / areas_[row] < caps_[side])) continue;
        const double share = 2 * sums[side] * w[side] / (areas_[row] * counted_rows_);
        slope -= share * by_determinant;
        slope.row(s) += share * linear.row(s) / linear.row(s).squaredNorm();
      }
      const Matrix white = slope * white_.inverse[row].transpose();
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          gradient[kParametersPerRow * row + static_cast<std::size_t>(4 * i + j)] += white(i, j);
    }
  }

  const ClusterPoints& points_;
  const WhitePoints& white_;
  std::span<const double> areas_;
  int counted_rows_ = 0;
  std::vector<float> middle_[3], scale_[3];
  float mean_extent_[3] = {};
  Sides caps_{};
  std::vector<bool> is_mirrored_;  ///< R: at the start
  double unit_ = 1;                ///< makes the start's cost 1
};

}  // namespace

std::vector<Affine3d> refine_maps(const ClusterPoints& points, std::span<const Affine3d> maps,
                                  std::span<const double> model_areas) {
  const WhitePoints white(points);
  std::vector<Affine3d> best(maps.begin(), maps.end());
  for (int restart = 0; restart < kRestarts; ++restart) {
    auto* function = new SmoothCost(points, white, model_areas);
    const ceres::GradientProblem problem(function);  // owns it
    function->settle(best);
    std::vector<double> parameters = function->parameters_of(best);
    ceres::GradientProblemSolver::Options solver;
    solver.logging_type = ceres::SILENT;
    solver.max_num_iterations = kIterations;
    solver.line_search_interpolation_type = ceres::QUADRATIC;
    solver.function_tolerance = 1e-3;
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(solver, problem, parameters.data(), &summary);
    if (!summary.IsSolutionUsable() || !(summary.final_cost < summary.initial_cost)) break;
    best = function->maps_of(parameters);
  }
  return best;
}

}  // namespace mdk
