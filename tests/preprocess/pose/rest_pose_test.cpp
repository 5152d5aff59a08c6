#include "preprocess/pose/rest_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "preprocess/maps/affine_fit.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

namespace mdk {
namespace {

/// Pairs of a row's positions and another's.
MomentSum pairs_of(const PoseTable& table, const ClusterMembers& members, std::uint32_t from,
                   std::uint32_t to) {
  MomentSum pairs;
  for (std::uint32_t s = 0; s < members.vertices.size(); ++s)
    pairs.add(table.position(from, members.vertices[s]), table.position(to, members.vertices[s]),
              members.uses[s]);
  return pairs;
}

std::uint32_t best_row(const PoseSequence& sequence) {
  return best_rest_rows(score_rest_poses(whole_table(sequence), whole_members(sequence)), 1)
      .front();
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
  const ClusterMembers members = whole_members(sequence);
  const auto plain_residual = [&](std::uint32_t rest_row) {
    double sum = 0;
    for (std::uint32_t row = 0; row < table.row_count(); ++row)
      sum += fit_affine(pairs_of(table, members, row, rest_row).moments(), kTableFit).residual;
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
  const ClusterMembers members = whole_members(sequence);
  const RestPoseScores scores = score_rest_poses(table, members);
  ASSERT_EQ(scores.rows.size(), 7u);
  FitOptions plain;
  plain.ridge = 0;
  for (std::uint32_t r = 0; r < 7; ++r) {
    double sum = 0;
    for (std::uint32_t t = 0; t < 7; ++t) {
      sum += fit_affine(pairs_of(table, members, r, t).moments(), plain).residual;
    }
    EXPECT_NEAR(scores.residuals[r], sum, 1e-6 * sum + 1e-9) << "row " << r;
  }
}

TEST(RestPose, PastTheBudgetCandidatesAreFewer) {
  const PoseSequence sequence = wild_motion(12, 40);
  const RestPoseScores scores =
      score_rest_poses(whole_table(sequence), whole_members(sequence),
                       RestPoseRule::kExplainsOthers, 4.5 * 10 * 10 * sequence.vertex_count);
  EXPECT_LE(scores.rows.size(), 11u);
  EXPECT_GE(scores.rows.size(), 5u);
  EXPECT_EQ(scores.rows.size(), scores.residuals.size());
}

}  // namespace
}  // namespace mdk
