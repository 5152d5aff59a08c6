#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "viewer/state/camera.h"

namespace mdk {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

const Aabb kScene{{-1, -1, -1}, {1, 1, 1}};
const Camera kFront{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 45};

OrbitCamera looking_from_front() {
  OrbitCamera camera;
  camera.set(kFront, kScene);
  return camera;
}

double distance(const Camera& camera) { return length(to_double(camera.eye - camera.target)); }

// Where a world point appears, in picture heights from the picture's centre.
PictureOffset project(const Camera& camera, const Vec3d& point) {
  const PinholeRays rays = make_pinhole_rays(camera, 1, 1);
  const Vec3d du = to_double(rays.du), dv = to_double(rays.dv);
  const Vec3d axis = to_double(rays.direction(0.5f, 0.5f));
  const Vec3d to_point = point - to_double(rays.origin);
  const double depth = dot(to_point, axis) / dot(axis, axis);
  return {dot(to_point, du) / dot(du, du) / depth, dot(to_point, dv) / dot(dv, dv) / depth};
}

void expect_usable(const Camera& camera, double least_upright) {
  for (const Vec3f& v : {camera.eye, camera.target, camera.up})
    for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(std::isfinite(v[i]));
  ASSERT_NO_THROW(make_pinhole_rays(camera, 64, 64));
  const Vec3d forward = normalized(to_double(camera.target) - to_double(camera.eye));
  const double across = length(cross(forward, to_double(camera.up)));
  ASSERT_GT(across, least_upright) << "looks along its up axis";
}

TEST(OrbitCamera, ShowsTheGivenCameraExactlyUntilItIsMoved) {
  const Camera odd{{3, 40, 2}, {0.3f, -0.7f, 2}, {0.1f, 0.9f, 0.3f}, 33};
  OrbitCamera camera;
  camera.set(odd, kScene);
  EXPECT_EQ(camera.camera(), odd);
}

TEST(OrbitCamera, StartsAMotionFromWhereTheCameraStood) {
  const Camera odd{{3, 2, -4}, {0.3f, -0.7f, 0.5f}, {0.2f, 0.9f, 0.3f}, 33};
  OrbitCamera camera;
  camera.set(odd, kScene);
  camera.orbit({0, 0});
  EXPECT_NEAR(length(to_double(camera.camera().eye - odd.eye)), 0, 1e-5);
  EXPECT_NEAR(length(to_double(camera.camera().target - odd.target)), 0, 1e-6);
}

TEST(OrbitCamera, TurnsHalfAroundForADragOfOnePictureHeight) {
  OrbitCamera camera = looking_from_front();
  camera.orbit({1, 0});
  EXPECT_NEAR(length(to_double(camera.camera().eye - Vec3f{0, 0, -5})), 0, 1e-5);
  EXPECT_NEAR(distance(camera.camera()), 5, 1e-5);
}

TEST(OrbitCamera, TurnsWhatIsInFrontTheWayThePointerGoes) {
  const Vec3d nearest{0, 0, 1};
  OrbitCamera camera = looking_from_front();
  camera.orbit({0.1, 0});
  EXPECT_GT(project(camera.camera(), nearest).x, 0.01);
  camera = looking_from_front();
  camera.orbit({0, 0.1});
  EXPECT_GT(project(camera.camera(), nearest).y, 0.01);
}

TEST(OrbitCamera, StopsShortOfThePoles) {
  OrbitCamera camera = looking_from_front();
  camera.orbit({0, 3});
  EXPECT_GT(camera.camera().eye.y, 4.9f);
  expect_usable(camera.camera(), 1e-3);
  camera.orbit({0, -6});
  EXPECT_LT(camera.camera().eye.y, -4.9f);
  expect_usable(camera.camera(), 1e-3);
}

TEST(OrbitCamera, PansSoThatTheTargetPlaneFollowsThePointer) {
  OrbitCamera camera = looking_from_front();
  camera.orbit({0.2, 0.1});
  camera.pan({0.3, -0.2});
  const PictureOffset old_target = project(camera.camera(), {0, 0, 0});
  EXPECT_NEAR(old_target.x, 0.3, 1e-5);
  EXPECT_NEAR(old_target.y, -0.2, 1e-5);
  EXPECT_NEAR(distance(camera.camera()), 5, 1e-5);
}

TEST(OrbitCamera, ZoomsToWhatLiesUnderThePointer) {
  OrbitCamera camera = looking_from_front();
  const Vec3d point{0.8, 0.5, 0};  // in the target's plane
  const PictureOffset before = project(camera.camera(), point);
  camera.zoom(3, before);
  const PictureOffset after = project(camera.camera(), point);
  EXPECT_NEAR(after.x, before.x, 1e-5);
  EXPECT_NEAR(after.y, before.y, 1e-5);
  EXPECT_NEAR(distance(camera.camera()), 5 * 0.9 * 0.9 * 0.9, 1e-5);
}

TEST(OrbitCamera, ZoomingInAndOutComesBack) {
  OrbitCamera camera = looking_from_front();
  camera.zoom(4, {0.1, 0.2});
  camera.zoom(-4, {0.1, 0.2});
  EXPECT_NEAR(length(to_double(camera.camera().eye - kFront.eye)), 0, 1e-5);
}

TEST(OrbitCamera, NeverReachesTheTargetNorLosesTheScene) {
  OrbitCamera camera = looking_from_front();
  for (int i = 0; i < 100; ++i) camera.zoom(50, {0.5, 0.5});
  EXPECT_GT(distance(camera.camera()), 1e-4);
  expect_usable(camera.camera(), 1e-3);
  for (int i = 0; i < 100; ++i) camera.zoom(-50, {0.5, 0.5});
  EXPECT_LT(distance(camera.camera()), 1e5);
  for (int i = 0; i < 1000; ++i) camera.pan({1e6, 1e6});
  EXPECT_LT(length(to_double(camera.camera().target)), 1e3);
  expect_usable(camera.camera(), 1e-3);
}

TEST(OrbitCamera, FitPutsEveryCornerIntoThePictureAndKeepsTheDirection) {
  for (const double aspect : {0.4, 1.0, 2.5}) {
    OrbitCamera camera = looking_from_front();
    camera.orbit({0.13, 0.21});
    const Vec3d before = normalized(to_double(camera.camera().eye - camera.camera().target));
    camera.pan({2, 1});
    camera.zoom(10, {0, 0});
    const Aabb box{{3, -2, 0}, {9, 1, 4}};
    camera.fit(box, aspect);
    const Vec3d after = normalized(to_double(camera.camera().eye - camera.camera().target));
    EXPECT_NEAR(dot(before, after), 1, 1e-6);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d point{corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                        corner & 4 ? box.hi.z : box.lo.z};
      const PictureOffset at = project(camera.camera(), point);
      EXPECT_LE(std::abs(at.x), 0.5 * aspect + 1e-5);
      EXPECT_LE(std::abs(at.y), 0.5 + 1e-5);
    }
  }
}

TEST(OrbitCamera, IgnoresMotionsThatAreNotNumbers) {
  OrbitCamera camera = looking_from_front();
  camera.orbit({0.1, 0.1});
  const Camera before = camera.camera();
  camera.orbit({kNaN, 0});
  camera.orbit({0, kInf});
  camera.pan({kInf, kNaN});
  camera.zoom(kNaN, {0, 0});
  camera.zoom(1, {kNaN, 0});
  camera.fit(Aabb{}, 1);
  camera.fit(kScene, kNaN);
  camera.fit(kScene, 0);
  EXPECT_EQ(camera.camera(), before);
}

// Scenes of many sizes and places, some of a single point, some far from the origin.
TEST(OrbitCamera, StaysUsableUnderAnyMotions) {
  constexpr unsigned kSeed = 20240611;
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  std::normal_distribution<double> step(0, 2);
  for (const float size : {0.0f, 1e-6f, 1.0f, 1e6f})
    for (const float place : {0.0f, 1.0f, 1e5f}) {
      const Aabb scene{{place, place, place}, {place + size, place + size, place + size}};
      OrbitCamera camera;
      camera.set(fit_camera(scene, 1.5), scene);
      for (int i = 0; i < 2000; ++i) {
        switch (random() % 4) {
          case 0:
            camera.orbit({step(random), step(random)});
            break;
          case 1:
            camera.pan({step(random), step(random)});
            break;
          case 2:
            camera.zoom(5 * step(random), {step(random), step(random)});
            break;
          case 3:
            camera.fit(scene, std::exp(step(random)));
            break;
        }
        ASSERT_NO_FATAL_FAILURE(expect_usable(camera.camera(), 1e-3))
            << "size " << size << " at " << place << ", motion " << i;
      }
    }
}

}  // namespace
}  // namespace mdk
