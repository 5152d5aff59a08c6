#include "preprocess/pose/rest_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kPosesPerBlock = 8;

/// One cluster's vertices in all candidate poses, centred on the cluster's weighted mean in each
/// and scaled by the square root of their weight: row i holds vertex i, three columns a pose.
struct CenteredPoses {
  std::size_t width = 0, height = 0;
  std::vector<double> values;

  const double* row(std::size_t i) const { return &values[i * width]; }
};

CenteredPoses center_poses(const PoseTable& table, const ClusterMembers& members,
                           std::uint32_t cluster, std::span<const std::uint32_t> rows) {
  const std::uint32_t first = members.vertex_begin[cluster];
  CenteredPoses result;
  result.width = 3 * rows.size();
  result.height = members.vertex_begin[cluster + 1] - first;
  result.values.resize(result.width * result.height);
  parallel_chunks(rows.size(), kPosesPerBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Vec3d mean;
      double weight = 0;
      for (std::size_t i = 0; i < result.height; ++i) {
        const double w = members.uses[first + i];
        mean += table.position(rows[p], members.vertices[first + i]) * w;
        weight += w;
      }
      mean = mean * (1 / weight);
      for (std::size_t i = 0; i < result.height; ++i) {
        const Vec3d v = (table.position(rows[p], members.vertices[first + i]) - mean) *
                        std::sqrt(static_cast<double>(members.uses[first + i]));
        for (std::size_t j = 0; j < 3; ++j) result.values[i * result.width + 3 * p + j] = v[j];
      }
    }
  });
  return result;
}

/// gram[a * width + b] = sum over vertices of column (begin + a) times column (begin + b), for the
/// columns from `begin` on: the block's rows of the Gram matrix, right of the diagonal.
void gram_rows(const CenteredPoses& poses, std::size_t begin, std::size_t end,
               std::vector<double>& gram) {
  const std::size_t width = poses.width - begin;
  gram.assign((end - begin) * width, 0.0);
  std::size_t i = 0;
  for (; i + 4 <= poses.height; i += 4) {
    const double* __restrict p0 = poses.row(i) + begin;
    const double* __restrict p1 = poses.row(i + 1) + begin;
    const double* __restrict p2 = poses.row(i + 2) + begin;
    const double* __restrict p3 = poses.row(i + 3) + begin;
    for (std::size_t a = 0; a < end - begin; ++a) {
      double* __restrict out = &gram[a * width];
      const double a0 = p0[a], a1 = p1[a], a2 = p2[a], a3 = p3[a];
      for (std::size_t b = 0; b < width; ++b)
        out[b] += (a0 * p0[b] + a1 * p1[b]) + (a2 * p2[b] + a3 * p3[b]);
    }
  }
  for (; i < poses.height; ++i) {
    const double* __restrict p = poses.row(i) + begin;
    for (std::size_t a = 0; a < end - begin; ++a)
      for (std::size_t b = 0; b < width; ++b) gram[a * width + b] += p[a] * p[b];
  }
}

/// Second moments of each pose and their damped inverses.
struct PoseMoments {
  std::vector<double> trace;
  std::vector<Eigen::Matrix3d> inverse;
};

PoseMoments pose_moments(const CenteredPoses& poses) {
  PoseMoments result;
  const std::size_t count = poses.width / 3;
  result.trace.resize(count);
  result.inverse.resize(count);
  parallel_chunks(count, kPosesPerBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
      for (std::size_t i = 0; i < poses.height; ++i) {
        const double* v = poses.row(i) + 3 * p;
        const Eigen::Vector3d x(v[0], v[1], v[2]);
        square += x * x.transpose();
      }
      result.trace[p] = square.trace();
      // What float positions cannot hold is no information.
      const double damping = 1e-9 * square.trace() + 1e-14 * static_cast<double>(poses.height);
      result.inverse[p] = (square + damping * Eigen::Matrix3d::Identity()).inverse();
    }
  });
  return result;
}

double unexplained(double trace, const Eigen::Matrix3d& m, const Eigen::Matrix3d& inverse) {
  return std::max(0.0, trace - (m.transpose() * inverse * m).trace());
}

/// Adds one cluster's residuals: residuals[r] += sum over t of what r leaves of t, or t of r.
void add_cluster(const CenteredPoses& poses, RestPoseRule rule, std::vector<double>& residuals) {
  const std::size_t count = residuals.size();
  const std::size_t blocks = (count + kPosesPerBlock - 1) / kPosesPerBlock;
  const PoseMoments moments = pose_moments(poses);
  std::vector<std::vector<double>> partial(blocks);
  parallel_chunks(blocks, 1, [&](std::size_t block, std::size_t) {
    const std::size_t begin = block * kPosesPerBlock;
    const std::size_t end = std::min(count, begin + kPosesPerBlock);
    std::vector<double> gram;
    gram_rows(poses, 3 * begin, 3 * end, gram);
    const std::size_t width = poses.width - 3 * begin;
    partial[block].assign(count, 0.0);
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t t = r; t < count; ++t) {
        Eigen::Matrix3d m;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j)
            m(static_cast<int>(i), static_cast<int>(j)) =
                gram[(3 * (r - begin) + i) * width + 3 * (t - begin) + j];
        const double left_of_t = unexplained(moments.trace[t], m, moments.inverse[r]);
        const double left_of_r = unexplained(moments.trace[r], m.transpose(), moments.inverse[t]);
        const bool explains = rule == RestPoseRule::kExplainsOthers;
        partial[block][r] += explains ? left_of_t : left_of_r;
        if (t != r) partial[block][t] += explains ? left_of_r : left_of_t;
      }
  });
  for (const std::vector<double>& p : partial)
    for (std::size_t r = 0; r < count; ++r) residuals[r] += p[r];
}

}  // namespace

RestPoseScores score_rest_poses(const PoseTable& table, const ClusterMembers& members,
                                RestPoseRule rule, double max_multiply_adds) {
  const double slots = static_cast<double>(members.vertices.size());
  const double affordable = std::sqrt(max_multiply_adds / (4.5 * std::max(slots, 1.0)));
  const auto step = static_cast<std::uint32_t>(
      std::max(1.0, std::ceil(table.row_count() / std::max(affordable, 2.0))));
  RestPoseScores scores;
  for (std::uint32_t row = 0; row < table.row_count(); row += step) scores.rows.push_back(row);
  scores.residuals.assign(scores.rows.size(), 0.0);
  for (std::uint32_t c = 0; c < members.cluster_count(); ++c)
    add_cluster(center_poses(table, members, c, scores.rows), rule, scores.residuals);
  return scores;
}

std::vector<std::uint32_t> best_rest_rows(const RestPoseScores& scores, std::size_t count) {
  std::vector<std::size_t> order(scores.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return scores.residuals[a] < scores.residuals[b];
  });
  order.resize(std::min(count, order.size()));
  std::vector<std::uint32_t> rows;
  for (const std::size_t i : order) rows.push_back(scores.rows[i]);
  return rows;
}

}  // namespace mdk
