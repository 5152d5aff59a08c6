#include "assets/hand_asset.h"

#include "assets/hand_clips.h"
#include "assets/hand_colors.h"
#include "assets/hand_shape.h"
#include "assets/hand_skeleton.h"
#include "assets/isotropic_remesher.h"
#include "assets/rig.h"
#include "assets/skin_weights.h"
#include "assets/surface_mesher.h"

namespace mdk {
namespace {

constexpr double kMetresPerUnit = 0.01;  // the shape is modelled in centimetres
constexpr double kGridCell = 0.2;
constexpr double kGradientStep = 0.01;

GlbMesh make_mesh(const HandSkeleton& skeleton) {
  const HandShape shape(skeleton);
  const DistanceField field = [&](const Vec3d& p) { return shape.distance(p); };
  RemeshOptions options;
  options.edge_length = [&](const Vec3d& p) { return shape.edge_length(p); };
  options.seam = [&](const Vec3d& p) { return shape.seam(p); };
  options.gradient_step = kGradientStep;
  const TriangleMesh surface =
      remesh(mesh_surface(field, shape.bounds(), kGridCell), field, options);

  GlbMesh mesh;
  mesh.name = "hand";
  mesh.triangles = surface.triangles;
  for (const Vec3d& p : surface.positions) {
    const Vec3d normal = normalized(gradient(field, p, kGradientStep));
    mesh.positions.push_back(p * kMetresPerUnit);
    mesh.normals.push_back(normal);
    mesh.colors.push_back(surface_color(shape, p, normal));
  }
  for (const SkinInfluence& influence : skin_weights(surface, skeleton, shape)) {
    mesh.joints.push_back(influence.joints);
    mesh.weights.push_back(influence.weights);
  }
  return mesh;
}

}  // namespace

GlbScene make_hand_scene() {
  const HandSkeleton skeleton = make_hand_skeleton();
  GlbScene scene;
  scene.copyright = "Apache-2.0";
  add_rig(skeleton.joints, kMetresPerUnit, scene);
  scene.meshes.push_back(make_mesh(skeleton));
  GlbNode body;
  body.name = "hand_mesh";
  body.mesh = 0;
  body.skin = 0;
  scene.nodes.push_back(std::move(body));
  for (const RigClip& clip : make_hand_clips(skeleton))
    add_rig_clip(skeleton.joints, clip, kMetresPerUnit, scene);
  return scene;
}

}  // namespace mdk
