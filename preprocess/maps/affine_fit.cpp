#include "preprocess/maps/affine_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/base/parallel.h"

namespace mdk {
namespace {

using Matrix = Eigen::Matrix3d;

constexpr double kStrongestRidge = 1e3;  // of the trace: all but the similarity itself

Matrix to_eigen(const double (&m)[3][3]) {
  Matrix r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = m[i][j];
  return r;
}

Eigen::Vector3d to_eigen(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// The rotation nearest to a matrix of positive determinant, by Newton's iteration for the polar
/// factor (Higham 1986), which converges quadratically; none where the matrix is near singular.
std::optional<Matrix> nearest_rotation_quickly(const Matrix& m) {
  constexpr double kMinDeterminant = 1e-3;  // of that of a rotation of the same norm
  constexpr int kMaxSteps = 12;
  const double scale = std::sqrt(3.0) / m.norm();
  if (!(m.determinant() * scale * scale * scale > kMinDeterminant)) return std::nullopt;
  Matrix rotation = m * scale;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Matrix next = 0.5 * (rotation + rotation.inverse().transpose());
    const double change = (next - rotation).squaredNorm();
    rotation = next;
    if (change < 1e-18) return rotation;  // the next step would change its square: nothing
  }
  return std::nullopt;
}

/// The proper rotation nearest to a matrix.
Matrix nearest_rotation(const Matrix& m) {
  if (const std::optional<Matrix> rotation = nearest_rotation_quickly(m)) return *rotation;
  const Eigen::JacobiSVD<Matrix> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

/// The similarity that maps source to target best; its rotation is proper. A little identity in the
/// cross moments settles rotations that the points leave open (about a line, of a point).
Matrix best_similarity(const Matrix& cross, const Matrix& source, double max_scale) {
  const double size = cross.norm();
  if (!(size > std::numeric_limits<double>::min())) return Matrix::Identity();
  const Matrix rotation = nearest_rotation(cross + Matrix::Identity() * (1e-9 * size));
  const double trace = source.trace();
  const double scale = trace > 0 ? (rotation.transpose() * cross).trace() / trace : 1.0;
  return rotation * std::clamp(scale, 1 / max_scale, max_scale);
}

double residual_of(const Matrix& map, const Matrix& cross, const Matrix& source,
                   double target_trace) {
  const double residual = target_trace - 2 * (map * cross.transpose()).trace() +
                          (map * source * map.transpose()).trace();
  return std::max(residual, 0.0);
}

/// Whether a map turns inside out, or nearly so.
bool mirrors(const Matrix& map) {
  constexpr double kThinnest = 1e-3;  // of the volume of a similarity of the same norm
  const double norm = map.norm();
  return !(map.determinant() > kThinnest * norm * norm * norm);
}

/// Puts the singular values into a range with bounded condition; leaves a good map untouched.
Matrix bounded(const Matrix& map, const FitOptions& options) {
  // |det| <= s_min * (norm / sqrt 2)^2 bounds the smallest singular value from below cheaply.
  const double norm = map.norm();
  const double smallest = 2 * std::abs(map.determinant()) / (norm * norm);
  if (smallest * options.max_condition >= norm && smallest * options.max_scale >= 1 &&
      norm <= options.max_scale)
    return map;
  const Eigen::JacobiSVD<Matrix> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d s = svd.singularValues();
  const double largest = std::clamp(s(0), 1 / options.max_scale, options.max_scale);
  const double floor = std::max(largest / options.max_condition, 1 / options.max_scale);
  for (int i = 0; i < 3; ++i) s(i) = std::clamp(s(i), floor, largest);
  return svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
}

/// acc[i] += |m (x, y, z)[i] - rest[i]|^2 over one block of vertices of one row.
void add_block_residuals(const Affine3<float>& m, const float* __restrict x,
                         const float* __restrict y, const float* __restrict z,
                         const float* __restrict rx, const float* __restrict ry,
                         const float* __restrict rz, float* __restrict acc, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = m.m[0][0] * x[i] + m.m[0][1] * y[i] + m.m[0][2] * z[i] + (m.m[0][3] - rx[i]);
    const float dy = m.m[1][0] * x[i] + m.m[1][1] * y[i] + m.m[1][2] * z[i] + (m.m[1][3] - ry[i]);
    const float dz = m.m[2][0] * x[i] + m.m[2][1] * y[i] + m.m[2][2] * z[i] + (m.m[2][3] - rz[i]);
    acc[i] += dx * dx + dy * dy + dz * dz;
  }
}

/// Maps of `clusters` clusters at all rows, cluster-major; `add(cluster, row, sum)` adds the pairs
/// that one is fitted to.
template <class AddPairs>
std::vector<Affine3d> fit_rows(std::size_t clusters, std::size_t rows, const AddPairs& add) {
  constexpr std::size_t kFitsPerChunk = 8;
  std::vector<Affine3d> maps(clusters * rows);
  parallel_chunks(maps.size(), kFitsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      MomentSum sum;
      add(i / rows, static_cast<std::uint32_t>(i % rows), sum);
      maps[i] = fit_affine(sum.moments(), kTableFit).target_from_source;
    }
  });
  return maps;
}

}  // namespace

void MomentSum::add(const Vec3d& source, const Vec3d& target, double weight) {
  if (weight_ == 0) {
    source_origin_ = source;
    target_origin_ = target;
  }
  weight_ += weight;
  const Vec3d v = source - source_origin_, r = target - target_origin_;
  const Vec3d wv = v * weight;
  source_square_[0] += wv.x * v.x;
  source_square_[1] += wv.y * v.y;
  source_square_[2] += wv.z * v.z;
  source_square_[3] += wv.x * v.y;
  source_square_[4] += wv.y * v.z;
  source_square_[5] += wv.z * v.x;
  for (std::size_t i = 0; i < 3; ++i) {
    source_[i] += wv[i];
    target_[i] += weight * r[i];
    for (std::size_t j = 0; j < 3; ++j) cross_[i][j] += r[i] * wv[j];
  }
  target_square_ += weight * dot(r, r);
}

FitMoments MomentSum::moments() const {
  FitMoments m;
  m.weight = weight_;
  if (!(weight_ > 0)) return m;
  const double square[3][3] = {{source_square_[0], source_square_[3], source_square_[5]},
                               {source_square_[3], source_square_[1], source_square_[4]},
                               {source_square_[5], source_square_[4], source_square_[2]}};
  m.target_trace = target_square_;
  for (std::size_t i = 0; i < 3; ++i) {
    m.source_mean[i] = source_origin_[i] + source_[i] / weight_;
    m.target_mean[i] = target_origin_[i] + target_[i] / weight_;
    m.target_trace -= target_[i] * target_[i] / weight_;
    for (std::size_t j = 0; j < 3; ++j) {
      m.source[i][j] = square[i][j] - source_[i] * source_[j] / weight_;
      m.cross[i][j] = cross_[i][j] - target_[i] * source_[j] / weight_;
    }
  }
  m.target_trace = std::max(m.target_trace, 0.0);
  return m;
}

AffineFit fit_affine(const FitMoments& moments, const FitOptions& options) {
  const Matrix source = to_eigen(moments.source), cross = to_eigen(moments.cross);
  const Matrix similarity = best_similarity(cross, source, options.max_scale);
  const auto solve = [&](double ridge) -> Matrix {
    if (!(ridge > 0)) return similarity;
    const Matrix damped = source + ridge * Matrix::Identity();
    return damped.ldlt().solve((cross + ridge * similarity).transpose()).transpose();
  };

  // First nearly unregularised; what is left over tells how far the points can be trusted.
  const double least = 1e-10 * source.trace() + moments.weight * options.noise * options.noise;
  Matrix map = solve(least);
  const double left = residual_of(map, cross, source, moments.target_trace);
  double ridge = least + options.ridge * left;
  if (left > 0 && options.ridge > 0) map = solve(ridge);
  if (options.keep_orientation) {
    // The similarity is proper: a pull towards it that is strong enough ends every mirroring.
    const double strongest = kStrongestRidge * source.trace();
    for (ridge = std::max(ridge, 1e-6 * source.trace()); mirrors(map) && ridge < strongest;) {
      ridge *= 10;
      map = solve(ridge);
    }
  }
  map = bounded(map, options);

  AffineFit fit;
  fit.residual = residual_of(map, cross, source, moments.target_trace);
  const Eigen::Vector3d shift = to_eigen(moments.target_mean) - map * to_eigen(moments.source_mean);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) fit.target_from_source.m[i][j] = map(i, j);
    fit.target_from_source.m[i][3] = shift(i);
  }
  return fit;
}

Affine3d principal_rotation(const double (&scatter)[3][3]) {
  Matrix axes = Eigen::SelfAdjointEigenSolver<Matrix>(to_eigen(scatter)).eigenvectors();
  if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
  Affine3d rotation;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rotation.m[i][j] = axes(j, i);
  return rotation;
}

std::vector<Affine3d> fit_clusters(const PoseTable& table, const ClusterMembers& members,
                                   std::uint32_t rest_row) {
  return fit_rows(members.cluster_count(), table.row_count(),
                  [&](std::size_t cluster, std::uint32_t row, MomentSum& sum) {
                    for (std::uint32_t s = members.vertex_begin[cluster];
                         s < members.vertex_begin[cluster + 1]; ++s)
                      sum.add(table.position(row, members.vertices[s]),
                              table.position(rest_row, members.vertices[s]), members.uses[s]);
                  });
}

std::vector<Affine3d> fit_triangles(const MovingMesh& mesh, std::span<const std::uint32_t> chosen,
                                    std::uint32_t rest_row) {
  const PoseTable& table = mesh.poses;
  return fit_rows(1, table.row_count(), [&](std::size_t, std::uint32_t row, MomentSum& sum) {
    for (const std::uint32_t t : chosen)
      for (const std::uint32_t v : mesh.triangles[t].v)
        sum.add(table.position(row, v), table.position(rest_row, v), 1);
  });
}

std::vector<float> vertex_residuals(const PoseTable& table, std::uint32_t rest_row,
                                    std::span<const Affine3d> maps) {
  constexpr std::size_t kVertexBlock = 256;
  const std::size_t rows = table.row_count(), clusters = maps.size() / rows;
  std::vector<float> residuals(clusters * table.vertex_count);
  std::vector<Affine3f> narrow(maps.size());
  std::transform(maps.begin(), maps.end(), narrow.begin(),
                 [](const Affine3d& m) { return to_float(m); });
  parallel_chunks(table.vertex_count, kVertexBlock, [&](std::size_t begin, std::size_t end) {
    // Row by row over all clusters, so that a row's block is read from the first cache.
    std::vector<float> acc(clusters * kVertexBlock, 0.0f);
    const std::size_t rest = table.row_offset(rest_row) + begin;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t at = table.row_offset(static_cast<std::uint32_t>(row)) + begin;
      for (std::size_t c = 0; c < clusters; ++c)
        add_block_residuals(narrow[c * rows + row], &table.x[at], &table.y[at], &table.z[at],
                            &table.x[rest], &table.y[rest], &table.z[rest], &acc[c * kVertexBlock],
                            end - begin);
    }
    for (std::size_t c = 0; c < clusters; ++c)
      std::copy_n(&acc[c * kVertexBlock], end - begin, &residuals[c * table.vertex_count + begin]);
  });
  return residuals;
}

}  // namespace mdk
