#include "assets/elastic_lattice.h"

#include <gtest/gtest.h>

namespace mdk {
namespace {

double ball(const Vec3d& p) { return length(p) - 0.5; }

class ElasticBall : public testing::Test {
 protected:
  ElasticLattice lattice_{ball, {{-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7}}, 0.1};
  const ElasticLattice::StepRules kFree{1e-3, 5000, 1, {}, {}};

  Vec3d momentum() {
    Vec3d sum;
    for (const Vec3d& v : lattice_.velocities()) sum += v;
    return sum;
  }
};

TEST_F(ElasticBall, AtRestItStaysAndPointsStandWhereTheyWere) {
  const std::vector<Vec3d> points = {
      {0.5, 0, 0}, {0, -0.5, 0}, {0.1, 0.2, 0.3}, {-0.28, 0.28, 0.28}};
  const ElasticLattice::Embedding embedding(lattice_, points);
  for (int i = 0; i < 10; ++i) lattice_.step(kFree);
  const std::vector<Vec3d> now = embedding.positions(lattice_);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT(length(now[i] - points[i]), 1e-9) << i;
}

TEST_F(ElasticBall, SpringsKeepMomentumAndBringTheShapeBack) {
  const Vec3d push{0.3, 0, 0};
  for (std::size_t i = 0; i < lattice_.positions().size(); ++i)
    lattice_.positions()[i].y *= 1.2;  // drawn out
  for (Vec3d& v : lattice_.velocities()) v = push;
  const Vec3d before = momentum();
  ElasticLattice::StepRules damped = kFree;
  damped.damping = 10;
  for (int i = 0; i < 4000; ++i) lattice_.step(damped);
  EXPECT_LT(length(momentum() - before), 1e-9 * static_cast<double>(lattice_.rest().size()));
  double worst = 0;
  for (const LatticeSpring& spring : lattice_.springs())
    worst = std::max(
        worst, std::abs(length(lattice_.positions()[spring.b] - lattice_.positions()[spring.a]) -
                        spring.rest));
  EXPECT_LT(worst, 1e-3);
}

TEST_F(ElasticBall, FacesCloseTheLatticeAndLookOutwards) {
  double volume = 0;
  const auto& p = lattice_.rest();
  for (const LatticeFace& f : lattice_.faces())
    for (const auto& [a, b, c] : {std::array{f[0], f[1], f[2]}, std::array{f[0], f[2], f[3]}})
      volume += dot(p[a], cross(p[b], p[c])) / 6;
  EXPECT_GT(volume, 0.52);  // the ball's
  EXPECT_LT(volume, 4 * 0.52);
}

TEST_F(ElasticBall, AContactIsNeverCrossed) {
  const ElasticLattice::StepRules rules{1e-3, 5000, 1, {0, -10, 0}, [](Vec3d& p, Vec3d& v) {
                                          if (p.y >= -0.8) return;
                                          p.y = -0.8;
                                          v.y = std::abs(v.y);
                                        }};
  for (int i = 0; i < 2000; ++i) {
    lattice_.step(rules);
    for (const Vec3d& p : lattice_.positions()) ASSERT_GE(p.y, -0.8);
  }
}

}  // namespace
}  // namespace mdk
