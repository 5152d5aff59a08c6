#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "preprocess/cluster/paper/residual_clusters.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

namespace mdk {
namespace {

/// A sequence and all its poses.
struct Case {
  PoseSequence sequence;
  PoseTable table;

  explicit Case(PoseSequence s) : sequence(std::move(s)), table(whole_table(sequence)) {}

  ConnectedMesh mesh() const { return ConnectedMesh({table, sequence.triangles}); }
  ResidualClustering whole() const {
    return fit_residuals(mesh(), 0, std::vector<std::uint32_t>(sequence.triangles.size(), 0));
  }
};

Growth grow(const Case& c, const ClusterRequest& request) {
  const Growth growth = grow_by_residuals(c.mesh(), request, [](const GrowthStep&) {});
  validate(growth, c.sequence.triangles.size());
  return growth;
}

ClusterRequest exactly(std::uint32_t clusters) { return {.clusters = clusters}; }
ClusterRequest until_gains_are_below(double percent) { return {.stop_percent = percent}; }

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
    const Growth growth = grow(c, until_gains_are_below(1));
    EXPECT_EQ(growth.cluster_count, parts);
    EXPECT_TRUE(same_partition(growth.cluster_of_triangle, truth)) << parts << " parts";
    EXPECT_LT(fit_residuals(c.mesh(), growth.rest_key, growth.cluster_of_triangle).rms(c.mesh()),
              1e-6);
    EXPECT_EQ(growth.stop_reason, StopReason::kPercent);
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
  const Growth growth = grow(c, exactly(2));
  std::vector<std::uint32_t> truth;
  for (const Triangle& t : mesh.triangles) {
    bool right = false;
    for (const std::uint32_t v : t.v) right = right || mesh.vertices[v].x > 0.5 + 1e-9;
    truth.push_back(right);
  }
  EXPECT_TRUE(same_partition(growth.cluster_of_triangle, truth));
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
  const Growth growth = grow(Case(soup), until_gains_are_below(1));
  EXPECT_EQ(growth.cluster_count, 3u);
  EXPECT_TRUE(same_partition(growth.cluster_of_triangle, truth));
}

TEST(Clustering, RelaxationNeverRaisesTheResidual) {
  const Case c(wild_motion(5, 16));
  ResidualClustering state = c.whole();
  for (int i = 0; i < 6; ++i) {
    const ClusterOffer offer = best_new_cluster(c.mesh(), state);
    ASSERT_GT(offer.gain, 0);
    ResidualClustering more = accept_offer(c.mesh(), state, offer);
    const double before = more.residual;
    ResidualClustering relaxed = relax(c.mesh(), std::move(more));
    EXPECT_LE(relaxed.residual, before);
    EXPECT_LT(relaxed.residual, state.residual) << "a further cluster did not help";
    state = std::move(relaxed);
  }
}

TEST(Clustering, AnOfferGainsAtLeastWhatItPromises) {
  const Case c(independent_parts(3, 12));
  const ResidualClustering one = c.whole();
  const ClusterOffer offer = best_new_cluster(c.mesh(), one);
  EXPECT_LE(accept_offer(c.mesh(), one, offer).residual, (one.residual - offer.gain) * 1.001);
}

TEST(Clustering, ReportsTheResidualOfItsOwnMaps) {
  const Case c(wild_motion(6, 9));
  const ResidualClustering one = c.whole();
  double sum = 0;
  for (std::uint32_t row = 0; row < c.table.row_count(); ++row)
    for (const Triangle& t : c.sequence.triangles)
      for (const std::uint32_t v : t.v) {
        const Vec3d d = one.maps[row].point(c.table.position(row, v)) - c.table.position(0, v);
        sum += dot(d, d);
      }
  EXPECT_NEAR(one.residual, sum, 1e-4 * sum);
}

TEST(Clustering, IsTheSameAtAnySizeAndPlace) {
  const PoseSequence original = wild_motion(7, 10);
  const Growth reference = grow(Case(original), exactly(6));
  for (const double scale : {1e-6, 0.37, 4e5}) {
    PoseSequence moved = original;
    // The shift is as large as float positions can take without losing the motion itself.
    for (Vec3f& v : moved.positions)
      v = to_float(to_double(v) * scale + Vec3d{3 * scale, -2 * scale, scale});
    const Growth growth = grow(Case(moved), exactly(6));
    std::size_t alike = 0;
    for (std::size_t t = 0; t < original.triangles.size(); ++t)
      alike += growth.cluster_of_triangle[t] == reference.cluster_of_triangle[t];
    EXPECT_EQ(alike, original.triangles.size()) << "scale " << scale;
  }
}

TEST(Clustering, GivesExactlyAsManyClustersAsAskedFor) {
  for (const std::uint32_t count : {1u, 2u, 7u, 40u}) {
    for (const PoseSequence& s : {wild_motion(8, 6), independent_parts(2, 5)}) {
      const Growth growth = grow(Case(s), exactly(count));
      EXPECT_EQ(growth.cluster_count, count);
      EXPECT_EQ(growth.stop_reason, StopReason::kCount);
      const std::set<std::uint32_t> used(growth.cluster_of_triangle.begin(),
                                         growth.cluster_of_triangle.end());
      EXPECT_EQ(used.size(), count);
    }
  }
}

TEST(Clustering, ThePercentRuleStopsWhereAClusterGainsLess) {
  const Case c(wild_motion(9, 12));
  const Growth growth = grow(c, until_gains_are_below(12));
  ASSERT_EQ(growth.stop_reason, StopReason::kPercent);
  ASSERT_EQ(growth.steps.size(), growth.cluster_count + 1u);
  for (std::size_t i = 1; i < growth.steps.size(); ++i) {
    const double gain = 1 - growth.steps[i].residual_rms / growth.steps[i - 1].residual_rms;
    EXPECT_EQ(gain < 0.12, i + 1 == growth.steps.size()) << "step " << i;
  }
}

TEST(Clustering, KeepsARequestedRestPose) {
  ClusterRequest request = exactly(5);
  request.rest_key = 7;
  EXPECT_EQ(grow(Case(wild_motion(10, 12)), request).rest_key, 7u);
}

TEST(Clustering, PatchesAreOfTheMeshTheyAreGrownIn) {
  const Case c(independent_parts(2, 3));
  const std::size_t half = c.sequence.triangles.size() / 2;
  // A part of the mesh: its triangles have other numbers than in the whole.
  const MovingMesh part{c.table, std::span(c.sequence.triangles).subspan(half)};
  const ConnectedMesh mesh(part);
  for (const std::uint32_t seed : {0u, 17u, static_cast<std::uint32_t>(half) - 1}) {
    std::set<std::uint32_t> vertices;
    for (const std::uint32_t t : mesh.patch(seed)) {
      ASSERT_LT(t, part.triangles.size());
      bool shares = t == seed;
      for (const std::uint32_t v : part.triangles[t].v)
        shares = !vertices.insert(v).second || shares;
      EXPECT_TRUE(shares) << t;
    }
    EXPECT_GE(vertices.size(), 12u);
  }
}

}  // namespace
}  // namespace mdk
