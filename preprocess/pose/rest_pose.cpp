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
constexpr double kWorkPerPair = 9;  // multiply-adds for each vertex of two poses
// What a search with little time looks at all the same: vertices of a cluster, poses to explain.
constexpr std::size_t kMinClusterVertices = 24;
constexpr double kMinTargets = 32;

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

/// gram[a * width + b] = sum over vertices of column (begin + a) of `poses` times column b of
/// `targets`, whose width it has.
void gram_rows(const CenteredPoses& poses, std::size_t begin, std::size_t end,
               const CenteredPoses& targets, std::vector<double>& gram) {
  const std::size_t width = targets.width;
  gram.assign((end - begin) * width, 0.0);
  std::size_t i = 0;
  for (; i + 4 <= poses.height; i += 4) {
    const double* __restrict t0 = targets.row(i);
    const double* __restrict t1 = targets.row(i + 1);
    const double* __restrict t2 = targets.row(i + 2);
    const double* __restrict t3 = targets.row(i + 3);
    for (std::size_t a = 0; a < end - begin; ++a) {
      double* __restrict out = &gram[a * width];
      const double a0 = poses.row(i)[begin + a], a1 = poses.row(i + 1)[begin + a],
                   a2 = poses.row(i + 2)[begin + a], a3 = poses.row(i + 3)[begin + a];
      for (std::size_t b = 0; b < width; ++b)
        out[b] += (a0 * t0[b] + a1 * t1[b]) + (a2 * t2[b] + a3 * t3[b]);
    }
  }
  for (; i < poses.height; ++i) {
    const double* __restrict t = targets.row(i);
    for (std::size_t a = 0; a < end - begin; ++a)
      for (std::size_t b = 0; b < width; ++b) gram[a * width + b] += poses.row(i)[begin + a] * t[b];
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

/// Adds one cluster's residuals: residuals[r] += sum over targets t of what r leaves of t, or t of
/// r.
void add_cluster(const CenteredPoses& poses, const CenteredPoses& targets, RestPoseRule rule,
                 std::vector<double>& residuals) {
  const PoseMoments of_pose = pose_moments(poses), of_target = pose_moments(targets);
  parallel_chunks(residuals.size(), kPosesPerBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<double> gram;
    gram_rows(poses, 3 * begin, 3 * end, targets, gram);
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t t = 0; t < targets.width / 3; ++t) {
        Eigen::Matrix3d m;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j)
            m(static_cast<int>(i), static_cast<int>(j)) =
                gram[(3 * (r - begin) + i) * targets.width + 3 * t + j];
        residuals[r] += rule == RestPoseRule::kExplainsOthers
                            ? unexplained(of_target.trace[t], m, of_pose.inverse[r])
                            : unexplained(of_pose.trace[r], m.transpose(), of_target.inverse[t]);
      }
  });
}

std::vector<std::uint32_t> all_rows(const PoseTable& table) {
  std::vector<std::uint32_t> rows(table.row_count());
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

/// A number that tells nothing of `x`, always the same.
std::size_t scrambled(std::size_t x) {
  std::uint64_t mixed = (x + 1) * 0x9e3779b97f4a7c15u;
  mixed = (mixed ^ (mixed >> 29)) * 0xbf58476d1ce4e5b9u;
  return mixed ^ (mixed >> 32);
}

/// Some of each cluster's vertices, about `wanted` of all clusters' together.
ClusterMembers thinned(const ClusterMembers& members, std::size_t wanted) {
  const std::size_t step =
      std::max<std::size_t>(1, members.vertices.size() / std::max<std::size_t>(1, wanted));
  ClusterMembers thin;
  thin.triangle_begin = members.triangle_begin;  // for their number
  thin.vertex_begin.push_back(0);
  for (std::uint32_t c = 0; c < members.cluster_count(); ++c) {
    const std::uint32_t begin = members.vertex_begin[c], end = members.vertex_begin[c + 1];
    const std::size_t own =
        std::max<std::size_t>(1, std::min(step, (end - begin) / kMinClusterVertices));
    for (std::size_t first = begin; first < end; first += own) {
      // One of each so many, not always the same: meshes have regular grids.
      const std::size_t s = first + scrambled(first) % std::min(own, end - first);
      thin.vertices.push_back(members.vertices[s]);
      thin.uses.push_back(members.uses[s]);
    }
    thin.vertex_begin.push_back(static_cast<std::uint32_t>(thin.vertices.size()));
  }
  return thin;
}

/// All keys of these vertices alone, which are renumbered.
PoseTable table_of_vertices(const PoseSequence& sequence, double unit,
                            std::vector<std::uint32_t>& vertices) {
  PoseTable table;
  table.unit = unit;
  table.vertex_count = static_cast<std::uint32_t>(vertices.size());
  table.keys.resize(sequence.key_count());
  std::iota(table.keys.begin(), table.keys.end(), 0u);
  table.centers.resize(table.keys.size());
  table.resize(table.keys.size() * vertices.size());
  for (std::uint32_t key = 0; key < sequence.key_count(); ++key) {
    const std::span<const Vec3f> pose = sequence.pose(key);
    Vec3d& center = table.centers[key];
    for (const std::uint32_t v : vertices) center += to_double(pose[v]);
    center = center * (1.0 / static_cast<double>(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i)
      table.set(table.row_offset(key) + i,
                to_float((to_double(pose[vertices[i]]) - center) * (1 / unit)));
  }
  std::iota(vertices.begin(), vertices.end(), 0u);
  return table;
}

}  // namespace

std::vector<double> score_rest_poses(const PoseTable& table, const ClusterMembers& members,
                                     std::span<const std::uint32_t> targets, RestPoseRule rule) {
  std::vector<double> residuals(table.row_count(), 0.0);
  const std::vector<std::uint32_t> rows = all_rows(table);
  for (std::uint32_t c = 0; c < members.cluster_count(); ++c)
    add_cluster(center_poses(table, members, c, rows), center_poses(table, members, c, targets),
                rule, residuals);
  return residuals;
}

std::vector<double> score_rest_poses(const PoseTable& table, const ClusterMembers& members,
                                     RestPoseRule rule) {
  return score_rest_poses(table, members, all_rows(table), rule);
}

std::vector<std::uint32_t> best_rest_rows(std::span<const double> scores, std::size_t count) {
  std::vector<std::uint32_t> order(scores.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return scores[a] < scores[b]; });
  order.resize(std::min(count, order.size()));
  return order;
}

std::vector<std::uint32_t> best_rest_keys(const PoseSequence& sequence,
                                          const ClusterMembers& members, double unit,
                                          const RestKeySearch& search) {
  const auto keys = static_cast<double>(sequence.key_count());
  const double pairs = search.max_multiply_adds / kWorkPerPair;
  ClusterMembers thin =
      thinned(members, static_cast<std::size_t>(std::max(1.0, pairs / (keys * keys))));
  const double affordable = pairs / (keys * static_cast<double>(thin.vertices.size()));
  const std::vector<std::uint32_t> targets =
      sample_keys(sequence, static_cast<std::size_t>(std::max<double>(kMinTargets, affordable)));
  const PoseTable table = table_of_vertices(sequence, unit, thin.vertices);
  return best_rest_rows(score_rest_poses(table, thin, targets, search.rule), search.count);
}

}  // namespace mdk
