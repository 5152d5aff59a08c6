// What the viewer tells about a model: parts of it, the triangle under a pixel, where boxes lie in
// the picture, facts of clusters.
#include <gtest/gtest.h>

#include <numeric>

#include "common/trace/heat_map.h"
#include "common/trace/renderer.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/state/camera.h"
#include "viewer/state/clusters.h"
#include "viewer/state/pick.h"

namespace mdk {
namespace {

class Bar : public testing::Test {
 protected:
  Bar() {
    request_.width = 96;
    request_.height = 64;
    request_.camera = fit_camera(model_.bounds, 1.5);
    request_.at = locate_time(model_, 0, 0.37);
  }

  ModelStorage storage_ = test::waving_bar();
  ModelView model_ = storage_.view();
  FrameRequest request_;
};

TEST_F(Bar, HasSeveralClusters) { EXPECT_GE(model_.cluster_count(), 2u); }

TEST_F(Bar, APartShowsTheSameByEveryTechniqueAndNothingOfWhatIsLeftOut) {
  std::vector<std::uint8_t> left_out(model_.cluster_count(), 0);
  left_out[1] = 1;
  const PartialModel part(model_, left_out);
  Renderer brute(part.model(), "brute-force"), whole(model_, "brute-force");
  brute.trace(request_);
  whole.trace(request_);
  EXPECT_LT(brute.stats().hits, whole.stats().hits);
  EXPECT_GT(brute.stats().hits, 100u);
  for (std::uint32_t y = 0; y < request_.height; ++y)
    for (std::uint32_t x = 0; x < request_.width; ++x) {
      const std::uint32_t triangle = brute.hits().triangle(x, y);
      if (triangle != kNoHit) {
        EXPECT_NE(cluster_of_triangle(model_, triangle), 1u);
      }
      const std::uint32_t before = whole.hits().triangle(x, y);
      if (before != kNoHit && cluster_of_triangle(model_, before) != 1) {
        EXPECT_EQ(triangle, before);
      }
    }
  for (const TechniqueInfo& technique : technique_table()) {
    Renderer renderer(part.model(), technique.id);
    renderer.trace(request_);
    EXPECT_EQ(count_mismatches(renderer.hits(), brute.hits(), technique.agreement()), 0u)
        << technique.id;
  }
}

TEST_F(Bar, APartWithoutAnyClusterIsEmpty) {
  const std::vector<std::uint8_t> left_out(model_.cluster_count(), 1);
  const PartialModel part(model_, left_out);
  for (const TechniqueInfo& technique : technique_table()) {
    Renderer renderer(part.model(), technique.id);
    EXPECT_EQ(renderer.trace(request_).hits, 0u) << technique.id;
  }
}

TEST_F(Bar, AViewOfClustersMakesAPartOnlyWhereSomethingIsHidden) {
  ClusterView view(model_);
  EXPECT_EQ(view.part(), nullptr);
  view.toggle_hidden(1);
  EXPECT_FALSE(view.shown(1));
  EXPECT_NE(view.part(), nullptr);
  view.toggle_solo(1);
  EXPECT_TRUE(view.shown(1));
  EXPECT_FALSE(view.shown(0));
  EXPECT_EQ(view.shown_count(), 1u);
  view.toggle_solo(1);
  EXPECT_EQ(view.shown_count(), model_.cluster_count() - 1);
  view.show_all();
  EXPECT_EQ(view.part(), nullptr);
}

TEST_F(Bar, APickIsTheTriangleThatThePictureShows) {
  Renderer renderer(model_, "fuzzy-bvh");
  renderer.trace(request_);
  const Moment moment{request_.at, {}};
  std::uint32_t picked = 0;
  for (std::uint32_t y = 0; y < request_.height; y += 3)
    for (std::uint32_t x = 0; x < request_.width; x += 3) {
      const auto pick =
          pick_triangle(model_, moment, {request_.camera, request_.width, request_.height}, x, y);
      const std::uint32_t shown = renderer.hits().triangle(x, y);
      ASSERT_EQ(pick.has_value(), shown != kNoHit) << x << " " << y;
      if (!pick) continue;
      ++picked;
      EXPECT_EQ(pick->triangle, shown) << x << " " << y;
      EXPECT_NEAR(pick->depth, renderer.hits().t(x, y), 1e-4 * pick->depth);
      const Cluster& cluster = model_.clusters[pick->cluster];
      EXPECT_GE(shown, cluster.first_triangle);
      EXPECT_LT(shown, cluster.first_triangle + cluster.triangle_count);
    }
  EXPECT_GT(picked, 20u);
}

TEST_F(Bar, TheResidualCurveIsThatOfTheHeatMap) {
  const std::uint32_t triangle = model_.triangle_count() / 2;
  const ResidualCurve curve = residual_curve(model_, 1, triangle);
  const Clip& clip = model_.clips[1];
  ASSERT_EQ(curve.residuals.size(), clip.key_count);
  std::vector<float> residuals(model_.triangle_count());
  for (std::uint32_t i = 0; i < clip.key_count; ++i) {
    PosedMesh mesh(model_);
    mesh.set_time(at_key(clip.first_key + i));
    triangle_residuals(mesh, residuals);
    EXPECT_NEAR(curve.residuals[i], residuals[triangle], 1e-6);
  }
  ResidualCurveCache cache;
  EXPECT_EQ(cache.curve(model_, 1, triangle).residuals, curve.residuals);
  EXPECT_EQ(cache.curve(model_, 0, triangle).residuals.size(), model_.clips[0].key_count);
  EXPECT_EQ(cache.curve(model_, 1, triangle).residuals, curve.residuals);
}

TEST_F(Bar, FactsOfClustersAddUp) {
  const std::vector<ClusterFacts> facts = cluster_facts(model_);
  ASSERT_EQ(facts.size(), model_.cluster_count());
  std::uint32_t triangles = 0;
  double cost = 0;
  for (const ClusterFacts& f : facts) {
    triangles += f.triangles;
    cost += f.cost_share;
    EXPECT_GT(f.cost_share, 0);
    EXPECT_GE(f.residual, 0);
    EXPECT_LT(f.residual, 0.1);
  }
  EXPECT_EQ(triangles, model_.triangle_count());
  EXPECT_NEAR(cost, 1, 1e-12);
}

TEST_F(Bar, PointsOfARayAreProjectedOntoItsPixel) {
  const PinholeRays rays = make_pinhole_rays(request_.camera, request_.width, request_.height);
  const Projector projector(request_.camera, {100, 50, 960, 640});
  for (const float depth : {0.5f, 3.0f, 20.0f})
    for (const float x : {-10.0f, 0.0f, 48.5f, 96.0f})
      for (const float y : {0.0f, 31.0f, 80.0f}) {
        const Vec3d point = to_double(rays.origin + rays.direction(x, y) * depth);
        const auto seen = projector.project(point, point);
        ASSERT_TRUE(seen);
        EXPECT_NEAR(seen->from.x, 100 + 10 * x, 0.05);
        EXPECT_NEAR(seen->from.y, 50 + 10 * y, 0.05);
      }
}

TEST_F(Bar, ASegmentThatPassesTheEyeIsCutBeforeIt) {
  const Camera camera{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40};
  const Projector projector(camera, {0, 0, 100, 100});
  EXPECT_FALSE(projector.project({0, 0, 6}, {1, 0, 9}));
  const auto cut = projector.project({0.1, 0, 0}, {0.1, 0, 50});
  ASSERT_TRUE(cut);
  EXPECT_GT(cut->to.x, 100);  // leaves the picture at the right
  const auto turned = projector.project({0.1, 0, 50}, {0.1, 0, 0});
  ASSERT_TRUE(turned);
  EXPECT_FLOAT_EQ(turned->from.x, cut->to.x);
}

TEST_F(Bar, PlacesOfClustersAreThoseOfThePosedMesh) {
  const Moment moment{request_.at, {}};
  const ClusterPlaces places = cluster_places(model_, moment);
  const PosedMesh mesh = mesh_at(model_, moment);
  for (std::uint32_t c = 0; c < model_.cluster_count(); ++c) {
    EXPECT_EQ(places.local_from_world[c], mesh.cluster_map(c));
    EXPECT_EQ(places.world_boxes[c], mesh.cluster_box(c));
  }
  const auto corners = corners_at(model_, moment, 5);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(corners[i], to_double(mesh.positions()[model_.triangles[5].v[i]]));
}

}  // namespace
}  // namespace mdk
