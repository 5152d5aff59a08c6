#include "preprocess/rest_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "preprocess/cluster_fit.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

PoseTable whole_table(const PoseSequence& sequence) {
  std::vector<std::uint32_t> keys(sequence.key_count());
  std::iota(keys.begin(), keys.end(), 0u);
  return make_pose_table(sequence, keys, pose_unit(sequence));
}

ClusterMembers one_cluster(const PoseSequence& sequence) {
  return make_cluster_members(sequence.triangles,
                              std::vector<std::uint32_t>(sequence.triangles.size(), 0), 1,
                              sequence.vertex_count);
}

std::uint32_t best_row(const PoseSequence& sequence) {
  return best_rest_rows(score_rest_poses(whole_table(sequence), one_cluster(sequence)), 1).front();
}

/// Key `middle` is a plain sheet; the others are that sheet with one of several bumps on it, so
/// that between two others lie two bumps, and between `middle` and any other one.
PoseSequence bumps_around(std::uint32_t middle, std::uint32_t keys, double squeeze_of_key_1) {
  const Mesh mesh = curved_sheet(8);
  return make_sequence(mesh, keys, [=](std::uint32_t k, std::uint32_t i) {
    Vec3d v = mesh.vertices[i];
    const double bump = k == middle ? 0.0 : 0.2;
    const double phase = 1.7 * k;
    v.z += bump * std::sin(9 * v.x + phase) * std::cos(7 * v.y - 2 * phase);
    const Affine3d move = rigid_motion({1, 0.3 * k, 2}, 0.4 * k, {0.1 * k, 0, 1.0 * k});
    return move.point(v * (k == 1 ? squeeze_of_key_1 : 1.0));
  });
}

TEST(RestPose, IsTheKeyInTheMiddleOfAllOthers) {
  for (const std::uint32_t middle : {0u, 4u, 8u})
    EXPECT_EQ(best_row(bumps_around(middle, 9, 1)), middle);
}

TEST(RestPose, AShrunkenPoseDoesNotWinBecauseItsResidualsAreSmall) {
  const PoseSequence sequence = bumps_around(4, 9, 0.01);
  const PoseTable table = whole_table(sequence);
  const ClusterMembers members = one_cluster(sequence);
  const auto plain_residual = [&](std::uint32_t row) {
    double sum = 0;
    for (const double r : fit_clusters(table, members, row).residuals) sum += r;
    return sum;
  };
  EXPECT_LT(plain_residual(1), plain_residual(4))
      << "equation (3) alone does not fall into the trap";
  EXPECT_EQ(best_row(sequence), 4u);
}

TEST(RestPose, AFlattenedPoseDoesNotWin) {
  const Mesh mesh = curved_sheet(8);
  const PoseSequence sequence = make_sequence(mesh, 8, [&](std::uint32_t k, std::uint32_t i) {
    Vec3d v = mesh.vertices[i];
    v.z += k == 5 ? 0 : 0.15 * std::sin(11 * v.x + 2 * k) * std::cos(5 * v.y + k);
    if (k == 2) v.z = 0;
    return v;
  });
  EXPECT_EQ(best_row(sequence), 5u);
}

TEST(RestPose, ScoresAgreeWithFittingEachPairOfPoses) {
  const PoseSequence sequence = wild_motion(11, 7);
  const PoseTable table = whole_table(sequence);
  const ClusterMembers members = one_cluster(sequence);
  const RestPoseScores scores = score_rest_poses(table, members);
  ASSERT_EQ(scores.rows.size(), 7u);
  FitOptions plain;
  plain.ridge = 0;
  for (std::uint32_t r = 0; r < 7; ++r) {
    double sum = 0;
    for (std::uint32_t t = 0; t < 7; ++t) {
      MomentSum pairs;
      for (std::uint32_t s = 0; s < members.vertices.size(); ++s)
        pairs.add(table.position(r, members.vertices[s]), table.position(t, members.vertices[s]),
                  members.uses[s]);
      sum += fit_affine(pairs.moments(), plain).residual;
    }
    EXPECT_NEAR(scores.residuals[r], sum, 1e-6 * sum + 1e-9) << "row " << r;
  }
}

TEST(RestPose, PastTheBudgetCandidatesAreFewer) {
  const PoseSequence sequence = wild_motion(12, 40);
  RestPoseOptions options;
  options.max_multiply_adds = 4.5 * 10 * 10 * sequence.vertex_count;
  const RestPoseScores scores =
      score_rest_poses(whole_table(sequence), one_cluster(sequence), options);
  EXPECT_LE(scores.rows.size(), 11u);
  EXPECT_GE(scores.rows.size(), 5u);
  EXPECT_EQ(scores.rows.size(), scores.residuals.size());
}

}  // namespace
}  // namespace mdk
