#include "preprocess/pose/rest_pose.h"

#include <gtest/gtest.h>

#include <algorithm>
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
  const std::vector<double> explaining = score_rest_poses(table, members);
  const std::vector<double> explained =
      score_rest_poses(table, members, RestPoseRule::kIsExplained);
  ASSERT_EQ(explaining.size(), 7u);
  ASSERT_EQ(explained.size(), 7u);
  FitOptions plain;
  plain.ridge = 0;
  const auto left_of = [&](std::uint32_t target, std::uint32_t source) {
    return fit_affine(pairs_of(table, members, source, target).moments(), plain).residual;
  };
  for (std::uint32_t r = 0; r < 7; ++r) {
    double of_others = 0, of_itself = 0;
    for (std::uint32_t t = 0; t < 7; ++t) {
      of_others += left_of(t, r);
      of_itself += left_of(r, t);  // GFW06 (3), squared
    }
    EXPECT_NEAR(explaining[r], of_others, 1e-6 * of_others + 1e-9) << "row " << r;
    EXPECT_NEAR(explained[r], of_itself, 1e-6 * of_itself + 1e-9) << "row " << r;
    EXPECT_GT(std::abs(of_others - of_itself), 1e-3 * of_itself) << "both rules say the same";
  }
}

TEST(RestPose, ThePapersRuleFallsForAShrunkenPose) {
  const PoseSequence sequence = bumps_around(4, 9, 0.01);
  EXPECT_EQ(best_rest_rows(score_rest_poses(whole_table(sequence), whole_members(sequence),
                                            RestPoseRule::kIsExplained),
                           1)[0],
            1u);
}

TEST(RestPose, EveryKeyOfALongSequenceIsACandidateWhateverTheBudget) {
  // The best key is one that no even or farthest-point sample of a few keys would hold.
  for (const std::uint32_t middle : {3u, 37u, 58u}) {
    const PoseSequence sequence = bumps_around(middle, 60, 1);
    const double unit = pose_unit(sequence);
    const auto best_keys = [&](double budget) {
      return best_rest_keys(sequence, whole_members(sequence), unit,
                            {.count = 3, .max_multiply_adds = budget});
    };
    EXPECT_EQ(best_keys(1e9)[0], middle);
    for (const double budget : {1.0, 1e5}) {  // fewer vertices and targets, not fewer candidates
      const std::vector<std::uint32_t> keys = best_keys(budget);
      ASSERT_EQ(keys.size(), 3u);
      EXPECT_TRUE(std::ranges::find(keys, middle) != keys.end()) << middle << " at " << budget;
    }
  }
}

}  // namespace
}  // namespace mdk
