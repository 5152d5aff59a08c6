// Cutting a cluster in two by two-means, and dissolving clusters into the others.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/cluster/boxes/box_clusters.h"

namespace mdk {
namespace {

constexpr std::size_t kSeeds = 3;
constexpr int kTwoMeansRounds = 3;
constexpr std::size_t kPatchTriangles = 8;
constexpr std::size_t kPatchShare = 24;  // a patch has at least a 24th of the cluster's triangles
// Cuts are looked for on few poses and on few of a large cluster's triangles.
constexpr std::uint32_t kCutRows = 32;
constexpr std::size_t kCutTriangles = 384;
constexpr int kBoxRounds = 2;  // in which boxes decide, after residuals did

double sum_at(const std::vector<float>& per_vertex, const std::uint32_t* corners) {
  return static_cast<double>(per_vertex[corners[0]]) + per_vertex[corners[1]] +
         per_vertex[corners[2]];
}

/// Two-means inside one cluster.
class Cutter {
 public:
  /// Row 0 of `points` is the rest pose.
  explicit Cutter(const ClusterPoints& points)
      : points_(points), rest_(row_targets(points, 0)), whole_(residuals_of(points.weights)) {}

  /// The best cut by residual from a few seeds: which triangles leave. Empty where there is none.
  std::vector<char> best_cut() const {
    std::vector<std::size_t> order(points_.triangle_count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<double> own(order.size());
    for (std::size_t t = 0; t < own.size(); ++t) own[t] = sum_at(whole_, corners(t));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return own[a] > own[b]; });
    std::vector<char> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kSeeds; ++i) {
      double left = 0;
      std::vector<char> cut = cut_from(order[order.size() * i / (2 * kSeeds)], left);
      if (cut.empty() || left >= least) continue;
      least = left;
      best = std::move(cut);
    }
    return best;
  }

 private:
  const std::uint32_t* corners(std::size_t t) const { return &points_.corners[3 * t]; }

  std::vector<float> residuals_of(std::span<const float> weights) const {
    return point_residuals(points_, fit_points(points_, rest_, weights).maps, rest_);
  }

  /// Corners of chosen triangles as weights.
  std::vector<float> weights_of(std::span<const char> chosen, char value) const {
    std::vector<float> weights(points_.stride, 0.0f);
    for (std::size_t t = 0; t < chosen.size(); ++t)
      if (chosen[t] == value)
        for (std::size_t k = 0; k < 3; ++k) weights[corners(t)[k]] += 1;
    return weights;
  }

  /// The triangles that stay nearest to a triangle's first corner in all poses.
  std::vector<char> patch(std::size_t seed) const {
    std::vector<float> distance(points_.stride, 0.0f);
    for (std::uint32_t row = 0; row < points_.row_count; ++row) {
      const std::size_t at = points_.row_offset(row), s = at + corners(seed)[0];
      for (std::size_t i = 0; i < points_.stride; ++i) {
        const float dx = points_.x[at + i] - points_.x[s], dy = points_.y[at + i] - points_.y[s],
                    dz = points_.z[at + i] - points_.z[s];
        distance[i] += dx * dx + dy * dy + dz * dz;
      }
    }
    const std::size_t triangles = points_.triangle_count();
    const std::size_t count =
        std::min(triangles - 1, std::max(kPatchTriangles, triangles / kPatchShare));
    std::vector<std::size_t> order(triangles);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<double> far(triangles);
    for (std::size_t t = 0; t < triangles; ++t) far[t] = sum_at(distance, corners(t));
    std::nth_element(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
        [&](std::size_t a, std::size_t b) { return far[a] != far[b] ? far[a] < far[b] : a < b; });
    std::vector<char> chosen(triangles, 0);
    for (std::size_t i = 0; i < count; ++i) chosen[order[i]] = 1;
    return chosen;
  }

  /// Empty where one side wins everything; `left` is the residual of both sides.
  std::vector<char> cut_from(std::size_t seed, double& left) const {
    std::vector<char> chosen = patch(seed);
    std::vector<float> stay = whole_;
    for (int round = 0; round < kTwoMeansRounds; ++round) {
      const std::vector<float> leave = residuals_of(weights_of(chosen, 1));
      if (round > 0) stay = residuals_of(weights_of(chosen, 0));
      std::size_t count = 0;
      left = 0;
      for (std::size_t t = 0; t < chosen.size(); ++t) {
        const double a = sum_at(leave, corners(t)), b = sum_at(stay, corners(t));
        chosen[t] = a < b;
        count += a < b;
        left += std::min(a, b);
      }
      if (count == 0 || count == chosen.size()) return {};
    }
    return chosen;
  }

  const ClusterPoints& points_;
  PointTargets rest_;
  std::vector<float> whole_;  ///< residuals of the uncut cluster
};

/// The triangles on one side of a cut, 1: those that leave.
std::vector<std::uint32_t> side_of(std::span<const char> cut, char side) {
  std::vector<std::uint32_t> chosen;
  for (std::uint32_t t = 0; t < cut.size(); ++t)
    if (cut[t] == side) chosen.push_back(t);
  return chosen;
}

/// Carries a cut of some triangles over to all: fits both sides and lets every triangle choose.
std::vector<char> cut_of_all(const ClusterPoints& all, const ClusterPoints& some,
                             std::span<const char> cut) {
  const PointTargets rest = row_targets(all, 0);
  std::vector<float> residuals[2];
  for (const char side : {0, 1}) {
    const ClusterPoints points = gather_subset(some, side_of(cut, side));
    PointTargets shape = row_targets(points, 0);  // about its own centre; moved to that of all
    const Vec3f shift = to_float(points.centers[0] - all.centers[0]);
    for (float& x : shape.x) x += shift.x;
    for (float& y : shape.y) y += shift.y;
    for (float& z : shape.z) z += shift.z;
    const PointFit fit = fit_points(points, shape, points.weights);
    residuals[static_cast<int>(side)] =
        point_residuals(all, from_centered(all, from_table(points, fit.maps)), rest);
  }
  std::vector<char> result(all.triangle_count());
  for (std::size_t t = 0; t < result.size(); ++t)
    result[t] =
        sum_at(residuals[1], &all.corners[3 * t]) < sum_at(residuals[0], &all.corners[3 * t]);
  return result;
}

/// What both sides of a cut cost, infinite where one is empty; `next` receives the cut in which
/// each triangle chooses the side that makes its box smaller.
double cut_cost(const BoxMeasure& measure, const ClusterPoints& points, std::span<const char> cut,
                std::vector<char>& next) {
  std::vector<float> areas[2];
  double cost = 0;
  for (const char side : {0, 1}) {
    const std::vector<std::uint32_t> chosen = side_of(cut, side);
    if (chosen.empty()) return std::numeric_limits<double>::infinity();
    const BoxCluster cluster = fit_box_cluster(measure, gather_subset(points, chosen));
    cost += cluster.work.cost();
    PointBoxes boxes = mapped_boxes(points, from_centered(points, cluster.maps));
    areas[static_cast<int>(side)] = triangle_areas(points, boxes, cluster.work.weights);
  }
  next.resize(cut.size());
  for (std::size_t t = 0; t < cut.size(); ++t) next[t] = areas[1][t] < areas[0][t];
  return cost;
}

/// The rest row first, then others spread evenly.
std::vector<std::uint32_t> cut_rows(const BoxMeasure& measure, std::uint32_t row_count) {
  std::vector<std::uint32_t> rows{measure.rest_row};
  const std::uint32_t step = (row_count + kCutRows - 1) / kCutRows;
  for (std::uint32_t row = 0; row < row_count; row += step)
    if (row != measure.rest_row) rows.push_back(row);
  return rows;
}

ClusterOffer find_split(const BoxMeasure& measure, const ClusterPoints& all_rows,
                        std::span<const std::uint32_t> triangles) {
  ClusterOffer split;
  if (triangles.size() < 2) return split;
  const std::vector<std::uint32_t> rows = cut_rows(measure, all_rows.row_count);
  const ClusterPoints points = gather_rows(all_rows, rows);
  std::vector<char> cut;
  if (triangles.size() <= kCutTriangles) {
    cut = Cutter(points).best_cut();
  } else {
    std::vector<std::uint32_t> chosen;
    const std::size_t step = triangles.size() / kCutTriangles;
    for (std::size_t t = 0; t < triangles.size(); t += step)
      chosen.push_back(static_cast<std::uint32_t>(t));
    const ClusterPoints some = gather_subset(points, chosen);
    cut = Cutter(some).best_cut();
    if (!cut.empty()) cut = cut_of_all(points, some, cut);
  }
  if (cut.empty()) return split;

  BoxMeasure cut_measure = measure;
  cut_measure.rest_row = 0;
  cut_measure.model_areas.clear();
  for (const std::uint32_t row : rows) cut_measure.model_areas.push_back(measure.model_areas[row]);
  const double whole = fit_box_cluster(cut_measure, points).work.cost();
  double least = std::numeric_limits<double>::infinity();
  for (int round = 0; round <= kBoxRounds; ++round) {
    std::vector<char> next;
    const double cost = cut_cost(cut_measure, points, cut, next);
    if (!(cost < least)) break;
    least = cost;
    split.triangles.clear();
    for (const std::uint32_t t : side_of(cut, 1)) split.triangles.push_back(triangles[t]);
    cut = std::move(next);
  }
  if (!split.triangles.empty()) split.gain = whole - least;
  return split;
}

/// What dissolving each cluster would save.
std::vector<double> dissolving_gains(const BoxClustering& clustering,
                                     const BoxAlternatives& alternatives) {
  std::vector<double> gains(clustering.cluster_count);
  for (std::size_t c = 0; c < gains.size(); ++c) gains[c] = clustering.clusters[c].work.overhead();
  for (std::size_t t = 0; t < clustering.cluster_of_triangle.size(); ++t)
    gains[clustering.cluster_of_triangle[t]] -=
        static_cast<double>(alternatives.other_area[t]) - alternatives.own_area[t];
  return gains;
}

/// An assignment on its way to another one, in which some clusters are dissolved into those whose
/// boxes suit their triangles best, and some are cut.
class Rearrangement {
 public:
  Rearrangement(const BoxClustering& clustering, const BoxAlternatives& alternatives)
      : clustering_(clustering),
        alternatives_(alternatives),
        state_(clustering.cluster_count, State::kAsItWas),
        assignment_(clustering.cluster_of_triangle) {}

  /// Whether that can be done: not to one that has taken in others' triangles or was cut, nor
  /// into one that is gone.
  bool dissolve(std::uint32_t c) {
    if (state_[c] != State::kAsItWas) return false;
    for (std::size_t t = 0; t < assignment_.size(); ++t)
      if (clustering_.cluster_of_triangle[t] == c &&
          state_[alternatives_.other[t]] == State::kDissolved)
        return false;
    state_[c] = State::kDissolved;
    for (std::size_t t = 0; t < assignment_.size(); ++t)
      if (clustering_.cluster_of_triangle[t] == c) {
        assignment_[t] = alternatives_.other[t];
        state_[alternatives_.other[t]] = State::kChanged;
      }
    return true;
  }

  /// A cut, the part of `c` that leaves becoming cluster `as`. Whether it can be made: not of a
  /// cluster that was changed before.
  bool cut(std::uint32_t c, const ClusterOffer& offer, std::uint32_t as) {
    if (state_[c] != State::kAsItWas) return false;
    state_[c] = State::kChanged;
    for (const std::uint32_t t : offer.triangles) assignment_[t] = as;
    return true;
  }

  bool may_change(std::uint32_t c) const { return state_[c] == State::kAsItWas; }
  const std::vector<std::uint32_t>& assignment() const { return assignment_; }

 private:
  enum class State : char { kAsItWas, kChanged, kDissolved };

  const BoxClustering& clustering_;
  const BoxAlternatives& alternatives_;
  std::vector<State> state_;
  std::vector<std::uint32_t> assignment_;
};

/// The clusters by what is gained with each, most first.
std::vector<std::uint32_t> by_gain(const std::vector<double>& gains) {
  std::vector<std::uint32_t> order(gains.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return gains[a] > gains[b]; });
  return order;
}

}  // namespace

std::vector<ClusterOffer> find_splits(const BoxProblem& problem, const BoxClustering& clustering) {
  const ClusterMembers members = problem.mesh.members_of(clustering);
  std::vector<ClusterOffer> splits(clustering.cluster_count);
  parallel_chunks(splits.size(), 1, [&](std::size_t i, std::size_t) {
    const auto c = static_cast<std::uint32_t>(i);
    splits[c] = find_split(problem.measure, gather_points(problem.mesh.poses, members, c),
                           members.triangles_of(c));
  });
  return splits;
}

BoxClustering make_splits(const BoxProblem& problem, const BoxClustering& clustering,
                          const std::vector<ClusterOffer>& splits, std::uint32_t count,
                          double min_gain) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < splits.size(); ++i)
    if (!splits[i].triangles.empty() && splits[i].gain > min_gain) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return splits[a].gain > splits[b].gain; });
  if (order.size() > count) order.resize(count);
  std::vector<std::uint32_t> assignment = clustering.cluster_of_triangle;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const std::uint32_t t : splits[order[i]].triangles)
      assignment[t] = clustering.cluster_count + static_cast<std::uint32_t>(i);
  return fit_boxes(problem, std::move(assignment));
}

BoxClustering dissolve_clusters(const BoxProblem& problem, BoxClustering clustering) {
  while (clustering.cluster_count > 1) {
    const BoxAlternatives alternatives = find_alternatives(problem, clustering);
    const std::vector<double> gains = dissolving_gains(clustering, alternatives);
    Rearrangement rearrangement(clustering, alternatives);
    std::size_t count = 0;
    for (const std::uint32_t c : by_gain(gains)) {
      if (gains[c] <= 0 || count > gains.size() / 4) break;  // at most every fourth at a time
      count += rearrangement.dissolve(c);
    }
    if (count == 0) break;
    BoxClustering next = fit_boxes(problem, rearrangement.assignment());
    if (next.cost >= clustering.cost) break;
    clustering = std::move(next);
  }
  return clustering;
}

BoxClustering exchange_clusters(const BoxProblem& problem, const BoxClustering& clustering,
                                std::uint32_t count) {
  const BoxAlternatives alternatives = find_alternatives(problem, clustering);
  const std::vector<double> loss = dissolving_gains(clustering, alternatives);
  const std::vector<ClusterOffer> splits = find_splits(problem, clustering);
  std::vector<double> split_gains;
  for (const ClusterOffer& split : splits)
    split_gains.push_back(split.triangles.empty() ? -std::numeric_limits<double>::infinity()
                                                  : split.gain);
  Rearrangement rearrangement(clustering, alternatives);
  const std::vector<std::uint32_t> cut_order = by_gain(split_gains);
  auto cut = cut_order.begin();
  for (const std::uint32_t c : by_gain(loss)) {
    if (count == 0) break;
    // Where the one to be cut takes in some of the dissolved one's triangles, the next one is cut.
    while (cut != cut_order.end() && (*cut == c || !rearrangement.may_change(*cut))) ++cut;
    if (cut == cut_order.end() || !(loss[c] + split_gains[*cut] > 0)) break;
    if (!rearrangement.dissolve(c)) continue;
    while (cut != cut_order.end() && !rearrangement.cut(*cut, splits[*cut], c)) ++cut;
    --count;
  }
  return fit_boxes(problem, rearrangement.assignment());
}

}  // namespace mdk
