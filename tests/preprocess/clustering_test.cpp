#include "preprocess/clustering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "preprocess/cluster_growth.h"
#include "preprocess/cluster_seeds.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

/// A sequence with what clustering wants to know about it.
struct Case {
  PoseSequence sequence;
  PoseTable table;
  VertexTriangles neighbors;

  explicit Case(PoseSequence s)
      : sequence(std::move(s)),
        neighbors(make_vertex_triangles(sequence.triangles, sequence.vertex_count)) {
    std::vector<std::uint32_t> keys(sequence.key_count());
    std::iota(keys.begin(), keys.end(), 0u);
    table = make_pose_table(sequence, keys, pose_unit(sequence));
  }
  MovingMesh mesh() const { return {table, sequence.triangles, neighbors}; }
  Clustering one_cluster() const {
    return fit_assignment(mesh(), 0, std::vector<std::uint32_t>(sequence.triangles.size(), 0));
  }
};

Growth grow(const Case& c, const GrowthOptions& options = {}) {
  return grow_clusters(c.mesh(), 0, options, [](const GrowthStep&) {});
}

/// Whether two labellings cut the triangles alike.
bool same_partition(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::map<std::uint32_t, std::uint32_t> from_a, from_b;
  for (std::size_t t = 0; t < a.size(); ++t)
    if (from_a.emplace(a[t], b[t]).first->second != b[t] ||
        from_b.emplace(b[t], a[t]).first->second != a[t])
      return false;
  return a.size() == b.size();
}

TEST(Clustering, FindsExactlyThePartsThatMoveIndependently) {
  for (const std::uint32_t parts : {2u, 3u, 5u}) {
    std::vector<std::uint32_t> truth;
    const Case c(independent_parts(parts, 20, &truth));
    const Growth growth = grow(c);
    EXPECT_EQ(growth.clustering.cluster_count, parts);
    EXPECT_TRUE(same_partition(growth.clustering.cluster_of_triangle, truth)) << parts << " parts";
    EXPECT_LT(residual_rms(c.mesh(), growth.clustering), 1e-6);
    EXPECT_EQ(growth.stop_reason, "cost");
  }
}

TEST(Clustering, OneSheetFoldedAlongALineFallsApartAtTheFold) {
  Mesh mesh = curved_sheet(10);
  for (Vec3d& v : mesh.vertices) v.z = (v.x - 0.5) * (std::sin(3 * v.y) + v.x);  // 0 at the fold
  const Case c(make_sequence(mesh, 12, [&](std::uint32_t k, std::uint32_t i) {
    const Vec3d v = mesh.vertices[i];
    if (v.x <= 0.5) return v;
    return rigid_motion({0, 1, 0}, 0.15 * k, {0.5, 0, 0}).point(v - Vec3d{0.5, 0, 0});
  }));
  GrowthOptions two;
  two.clusters = 2;
  const Growth growth = grow(c, two);
  std::vector<std::uint32_t> truth;
  for (const Triangle& t : mesh.triangles) {
    bool right = false;
    for (const std::uint32_t v : t.v) right = right || mesh.vertices[v].x > 0.5 + 1e-9;
    truth.push_back(right);
  }
  EXPECT_TRUE(same_partition(growth.clustering.cluster_of_triangle, truth));
}

TEST(Clustering, LooseTrianglesThatMoveAlikeShareACluster) {
  // A soup: no two triangles share a vertex, so that connectivity tells nothing.
  std::vector<std::uint32_t> truth;
  const PoseSequence parts = independent_parts(3, 10, &truth);
  PoseSequence soup = parts;
  soup.vertex_count = static_cast<std::uint32_t>(3 * parts.triangles.size());
  soup.positions.clear();
  for (std::uint32_t k = 0; k < parts.key_count(); ++k)
    for (const Triangle& t : parts.triangles)
      for (const std::uint32_t v : t.v) soup.positions.push_back(parts.pose(k)[v]);
  for (std::uint32_t t = 0; t < soup.triangles.size(); ++t)
    soup.triangles[t] = {{3 * t, 3 * t + 1, 3 * t + 2}};
  const Growth growth = grow(Case(soup));
  EXPECT_EQ(growth.clustering.cluster_count, 3u);
  EXPECT_TRUE(same_partition(growth.clustering.cluster_of_triangle, truth));
}

TEST(Clustering, RelaxationNeverRaisesTheResidual) {
  const Case c(wild_motion(5, 16));
  Clustering state = c.one_cluster();
  for (int i = 0; i < 6; ++i) {
    const ClusterOffer offer = best_new_cluster(c.mesh(), state);
    ASSERT_GT(offer.gain, 0);
    Clustering more = accept_offer(c.mesh(), state, offer);
    const double before = more.residual;
    Clustering relaxed = relax(c.mesh(), std::move(more));
    EXPECT_LE(relaxed.residual, before);
    EXPECT_LT(relaxed.residual, state.residual) << "a further cluster did not help";
    state = std::move(relaxed);
  }
}

TEST(Clustering, AnOfferGainsAtLeastWhatItPromises) {
  const Case c(independent_parts(3, 12));
  const Clustering one = c.one_cluster();
  const ClusterOffer offer = best_new_cluster(c.mesh(), one);
  EXPECT_LE(accept_offer(c.mesh(), one, offer).residual, (one.residual - offer.gain) * 1.001);
}

TEST(Clustering, ReportsTheResidualOfItsOwnMaps) {
  const Case c(wild_motion(6, 9));
  const Clustering one = c.one_cluster();
  double sum = 0;
  for (std::uint32_t row = 0; row < c.table.row_count(); ++row)
    for (const Triangle& t : c.sequence.triangles)
      for (const std::uint32_t v : t.v) {
        const Vec3d d =
            one.maps.of(0)[row].point(c.table.position(row, v)) - c.table.position(0, v);
        sum += dot(d, d);
      }
  EXPECT_NEAR(one.residual, sum, 1e-4 * sum);
}

TEST(Clustering, IsTheSameAtAnySizeAndPlace) {
  const PoseSequence original = wild_motion(7, 10);
  GrowthOptions options;
  options.clusters = 6;
  const Growth reference = grow(Case(original), options);
  for (const double scale : {1e-6, 0.37, 4e5}) {
    PoseSequence moved = original;
    // The shift is as large as float positions can take without losing the motion itself.
    for (Vec3f& v : moved.positions)
      v = to_float(to_double(v) * scale + Vec3d{3 * scale, -2 * scale, scale});
    const Growth growth = grow(Case(moved), options);
    std::size_t alike = 0;
    for (std::size_t t = 0; t < original.triangles.size(); ++t)
      alike +=
          growth.clustering.cluster_of_triangle[t] == reference.clustering.cluster_of_triangle[t];
    EXPECT_EQ(alike, original.triangles.size()) << "scale " << scale;
  }
}

TEST(Clustering, GivesExactlyAsManyClustersAsAskedFor) {
  for (const std::uint32_t count : {1u, 2u, 7u, 40u}) {
    GrowthOptions options;
    options.clusters = count;
    for (const PoseSequence& s : {wild_motion(8, 6), independent_parts(2, 5)}) {
      const Growth growth = grow(Case(s), options);
      EXPECT_EQ(growth.clustering.cluster_count, count);
      EXPECT_EQ(growth.stop_reason, "count");
      const std::set<std::uint32_t> used(growth.clustering.cluster_of_triangle.begin(),
                                         growth.clustering.cluster_of_triangle.end());
      EXPECT_EQ(used.size(), count);
    }
  }
}

TEST(Clustering, ThePercentRuleStopsWhereAClusterGainsLess) {
  const Case c(wild_motion(9, 12));
  GrowthOptions options;
  options.stop_percent = 12;
  const Growth growth = grow(c, options);
  ASSERT_EQ(growth.stop_reason, "percent");
  ASSERT_EQ(growth.steps.size(), growth.clustering.cluster_count + 1u);
  for (std::size_t i = 1; i < growth.steps.size(); ++i) {
    const double gain = 1 - growth.steps[i].residual_rms / growth.steps[i - 1].residual_rms;
    EXPECT_EQ(gain < 0.12, i + 1 == growth.steps.size()) << "step " << i;
  }
}

TEST(Clustering, TheCostRuleReturnsTheStepAfterWhichNoClusterPays) {
  const Case c(wild_motion(10, 12));
  const GrowthOptions options;
  const Growth growth = grow(c, options);
  const std::uint32_t chosen = growth.clustering.cluster_count;
  EXPECT_GT(chosen, 1u);
  for (const GrowthStep& step : growth.steps) {
    const double added = static_cast<double>(step.clusters) - chosen;
    EXPECT_GE(step.cost, growth.steps[chosen - 1].cost * (1 - options.min_gain * added));
  }
}

}  // namespace
}  // namespace mdk
