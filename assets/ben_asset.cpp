#include "assets/ben_asset.h"

#include <cmath>
#include <utility>

#include "assets/ben_shape.h"
#include "assets/ben_weights.h"
#include "assets/isotropic_remesher.h"
#include "assets/triangle_split.h"

namespace mdk {
namespace {

constexpr double kGridCell = 0.011, kGradientStep = 0.0006;

std::uint8_t linear_byte(std::uint8_t srgb) {
  const double s = srgb / 255.0;
  const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<std::uint8_t>(std::lround(linear * 255));
}

/// Meshed at a quarter of the triangles; their middles are put onto the surface.
TriangleMesh make_surface(const BenShape& shape, const DistanceField& field) {
  SampleSolid solid{field, [&](const Vec3d& p) { return shape.seam(p); }, shape.bounds(), kGridCell,
                    [&](const Vec3d& p) { return shape.edge_length(p); }};
  TriangleMesh mesh = mesh_solid(solid);
  TriangleSplit split = split_triangles(mesh.triangles, mesh.positions.size());
  mesh.triangles = std::move(split.triangles);
  for (const auto& [a, b] : split.parents)
    mesh.positions.push_back(
        project_to_surface(field, (mesh.positions[a] + mesh.positions[b]) * 0.5, kGradientStep));
  return mesh;
}

GlbMesh make_mesh(const BenRig& rig) {
  const BenShape shape(rig);
  const DistanceField field = [&](const Vec3d& p) { return shape.distance(p); };
  const TriangleMesh surface = make_surface(shape, field);
  GlbMesh mesh;
  mesh.name = "ben";
  mesh.triangles = surface.triangles;
  mesh.positions = surface.positions;
  for (const Vec3d& p : surface.positions) {
    mesh.normals.push_back(normalized(gradient(field, p, kGradientStep)));
    const ByteColor c = shape.color(p);
    mesh.colors.push_back({linear_byte(c[0]), linear_byte(c[1]), linear_byte(c[2]), 255});
  }
  BenWeights weights = ben_weights(surface, rig);
  mesh.joints = std::move(weights.joints);
  mesh.weights = std::move(weights.weights);
  return mesh;
}

}  // namespace

GlbScene make_ben_scene() {
  const BenRig rig = make_ben_rig();
  GlbScene scene;
  scene.copyright = "Apache-2.0";
  add_rig(rig.joints, 1, scene);
  scene.meshes.push_back(make_mesh(rig));
  GlbNode body;
  body.name = "ben_mesh";
  body.mesh = 0;
  body.skin = 0;
  scene.nodes.push_back(std::move(body));
  add_rig_clip(rig.joints, make_ben_run(rig), 1, scene);
  return scene;
}

}  // namespace mdk
