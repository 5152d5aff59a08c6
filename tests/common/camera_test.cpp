#include "common/trace/camera.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/base/error.h"
#include "common/trace/kernels/tile_kernels.h"

namespace mdk {
namespace {

TEST(Camera, MiddleRayGoesToTheTargetAndRowsGoDown) {
  const Camera camera{.eye = {1, 2, 3}, .target = {4, 2, 3}, .vertical_fov_deg = 90};
  const PinholeRays rays = make_pinhole_rays(camera, 200, 100);
  const Vec3f middle = rays.direction(100, 50);
  EXPECT_NEAR(middle.x, 1, 1e-6);  // depth along the view axis is 1
  EXPECT_NEAR(middle.y, 0, 1e-6);
  EXPECT_NEAR(middle.z, 0, 1e-6);
  EXPECT_NEAR(rays.direction(100, 0).y, 1, 1e-6);   // 45 degrees up at the upper edge
  EXPECT_NEAR(rays.direction(200, 50).z, 2, 1e-6);  // looking along +x, +z is to the right
}

TEST(Camera, PixelSpaceIsTheInverseOfTheRays) {
  const Camera camera{.eye = {10, -4, 7}, .target = {0, 1, 0}, .vertical_fov_deg = 35};
  const PinholeRays rays = make_pinhole_rays(camera, 640, 480);
  const PixelFromWorld map = make_pixel_from_world(rays);
  const Vec3f world = rays.origin + rays.direction(123.5f, 400.25f) * 6.0f;
  const Vec3f from_eye = world - map.origin;
  float p[3];
  for (int i = 0; i < 3; ++i)
    p[i] = map.m[i][0] * from_eye.x + map.m[i][1] * from_eye.y + map.m[i][2] * from_eye.z;
  EXPECT_NEAR(p[2], 6, 1e-4);
  EXPECT_NEAR(p[0] / p[2], 123.5, 1e-2);
  EXPECT_NEAR(p[1] / p[2], 400.25, 1e-2);
}

TEST(Camera, UpAlongTheViewAxisIsReplaced) {
  const Camera camera{.eye = {0, 5, 0}, .target = {0, 0, 0}, .up = {0, 1, 0}};
  const PinholeRays rays = make_pinhole_rays(camera, 10, 10);
  EXPECT_GT(length(rays.du), 0);
  EXPECT_GT(length(rays.dv), 0);
}

TEST(Camera, RefusesWhatSeesNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Camera& bad : {Camera{.eye = {1, 1, 1}, .target = {1, 1, 1}},
                            Camera{.vertical_fov_deg = 0}, Camera{.vertical_fov_deg = 180},
                            Camera{.vertical_fov_deg = nan}, Camera{.eye = {nan, 0, 0}}})
    EXPECT_THROW(make_pinhole_rays(bad, 8, 8), Error);
}

TEST(Camera, FitShowsEveryCornerOfTheBounds) {
  for (const Aabb& box : {Aabb{{-1, -2, -3}, {4, 5, 6}}, Aabb{{1e6f, 0, 0}, {1e6f + 50, 1, 200}},
                          Aabb{{0, 0, 0}, {1e-6f, 1e-5f, 1e-6f}}})
    for (const double aspect : {0.3, 1.0, 2.5}) {
      const auto width = static_cast<std::uint32_t>(400 * aspect), height = 400u;
      const PinholeRays rays = make_pinhole_rays(fit_camera(box, aspect), width, height);
      const PixelFromWorld map = make_pixel_from_world(rays);
      for (int i = 0; i < 8; ++i) {
        const Vec3f corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                           i & 4 ? box.hi.z : box.lo.z};
        const Vec3f d = corner - map.origin;
        const auto row = [&](int r) {
          return map.m[r][0] * d.x + map.m[r][1] * d.y + map.m[r][2] * d.z;
        };
        EXPECT_GT(row(2), 0);
        EXPECT_GE(row(0) / row(2), 0);
        EXPECT_LE(row(0) / row(2), width);
        EXPECT_GE(row(1) / row(2), 0);
        EXPECT_LE(row(1) / row(2), height);
      }
    }
}

TEST(Camera, FitOfAnEmptyOrPointBoxIsStillACamera) {
  EXPECT_NO_THROW(make_pinhole_rays(fit_camera(Aabb{}, 1), 8, 8));
  EXPECT_NO_THROW(make_pinhole_rays(fit_camera(Aabb{{1, 1, 1}, {1, 1, 1}}, 1), 8, 8));
}

}  // namespace
}  // namespace mdk
