// The mesh as the clusters' maps alone would have it, on two clusters that share an edge.
#include "common/trace/affine_copy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.h"
#include "common/trace/renderer.h"

namespace mdk {
namespace {

/// Two triangles on one edge, in the plane z = 0 at key 0 (the rest pose). At key 1 the first one,
/// vertices 0 to 2, has moved by (0, 0, 1) as a whole, and vertex 3 has stayed. Both clusters' maps
/// say that all moved by (0, 0, 1) of which the second one's explains nothing of vertex 3.
ModelStorage hinge() {
  ModelStorage model;
  model.vertex_count = 4;
  model.clips = {{"", 0, 2}};
  model.key_times = {0, 1};
  model.triangles = {{{0, 1, 2}}, {{2, 1, 3}}};
  model.source_triangles = {0, 1};
  model.clusters = {{0, 1}, {1, 1}};
  const Vec3f rest[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  for (const Vec3f& p : rest) model.poses.key_positions.push_back(p);
  for (int i = 0; i < 3; ++i) model.poses.key_positions.push_back(rest[i] + Vec3f{0, 0, 1});
  model.poses.key_positions.push_back(rest[3]);
  Affine3f turned;  // any basis will do: it must not show
  turned.m[0][0] = turned.m[1][1] = 0;
  turned.m[0][1] = -2;
  turned.m[1][0] = 2;
  Affine3f back = turned;
  back.m[2][3] = -1;
  model.local_from_world = {turned, turned, back, back};
  model.key_boxes = {{{0, 0, 0}, {1, 1, 0}}, {{0, 0, 0}, {1, 1, 1}}};
  model.cluster_world_boxes.resize(4);
  for (QuantizedBox& box : model.cluster_world_boxes) box = {{0, 0, 0}, {65535, 65535, 65535}};
  model.bounds = {{0, 0, 0}, {1, 1, 1}};
  model.rest_diagonal = std::sqrt(2.0);
  model.segments = {{0, 1}};
  model.appearance.materials.resize(1);
  model.appearance.triangle_materials = {0, 0};
  return model;
}

std::vector<Vec3f> corners_of(const ModelView& copy, std::uint32_t triangle) {
  std::vector<Vec3f> corners;
  for (const std::uint32_t v : copy.triangles[triangle].v)
    corners.push_back(copy.poses.key_positions[v]);
  return corners;
}

void expect_near(const Vec3f& a, const Vec3f& b) {
  EXPECT_NEAR(a.x, b.x, 1e-6);
  EXPECT_NEAR(a.y, b.y, 1e-6);
  EXPECT_NEAR(a.z, b.z, 1e-6);
}

TEST(AffineCopy, ClustersAreTheirRestPoseMovedByTheirMaps) {
  const ModelStorage storage = hinge();
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  AffineCopy copy(model);
  const Vec3f rest[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  for (const KeyInterval& at : {at_key(0), at_key(1), KeyInterval{0, 1, 0.25f}}) {
    mesh.set_time(at);
    const ModelView& moved = copy.at(mesh);
    EXPECT_EQ(moved.vertex_count, 6u) << "clusters share no vertices";
    const Vec3f shift{0, 0, at.key0 == 1 ? 1 : at.s};
    for (std::uint32_t t = 0; t < 2; ++t)
      for (std::uint32_t i = 0; i < 3; ++i)
        expect_near(corners_of(moved, t)[i], rest[model.triangles[t].v[i]] + shift);
    expect_near(moved.bounds.lo, shift);
  }
}

TEST(AffineCopy, IsWhatTheShadingModeShows) {
  const ModelStorage storage = hinge();
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  // From above, on the quarter that only vertex 3 reaches into: at key 1 the second triangle
  // slopes down to it, in its cluster's motion alone it lies flat.
  FrameRequest request{
      .at = at_key(1), .camera = fit_camera(model.bounds, 1), .width = 64, .height = 64};
  renderer.render(request);
  const std::vector<std::uint32_t> real(renderer.pixels().begin(), renderer.pixels().end());
  request.shading = ShadingMode::kAffine;
  renderer.render(request);
  EXPECT_GT(renderer.stats().hits, 50u);
  const std::vector<std::uint32_t> affine(renderer.pixels().begin(), renderer.pixels().end());
  EXPECT_NE(affine, real);
  request.at = at_key(0);
  renderer.render(request);
  const std::vector<std::uint32_t> affine_rest(renderer.pixels().begin(), renderer.pixels().end());
  request.shading = ShadingMode::kDiffuse;
  renderer.render(request);
  EXPECT_TRUE(std::equal(affine_rest.begin(), affine_rest.end(), renderer.pixels().begin()))
      << "at the rest pose there is nothing to explain";
  const KeyInterval moments[] = {at_key(0), at_key(1)};
  request.shading = ShadingMode::kAffine;
  request.samples = 2;
  request.shutter = moments;
  EXPECT_THROW(renderer.render(request), Error);
}

}  // namespace
}  // namespace mdk
