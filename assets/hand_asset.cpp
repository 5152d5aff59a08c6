#include "assets/hand_asset.h"

#include "assets/hand_clips.h"
#include "assets/hand_colors.h"
#include "assets/hand_shape.h"
#include "assets/hand_skeleton.h"
#include "assets/isotropic_remesher.h"
#include "assets/quaternion.h"
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

/// From model space into the joint's rest basis, column by column, in metres.
std::array<double, 16> inverse_bind_matrix(const Basis& b) {
  const Vec3d t = b.vector_to_local(b.origin) * -kMetresPerUnit;
  return {b.x.x, b.y.x, b.z.x, 0, b.x.y, b.y.y, b.z.y, 0, b.x.z, b.y.z, b.z.z, 0, t.x, t.y, t.z, 1};
}

Quaternion rest_rotation(const HandSkeleton& skeleton, const HandJoint& joint) {
  return rotation_between(joint.parent < 0 ? Basis{} : skeleton.rest(joint.parent), joint.rest);
}

void add_skeleton(const HandSkeleton& skeleton, GlbScene& scene) {
  GlbSkin skin;
  for (const HandJoint& joint : skeleton.joints) {
    const Basis parent = joint.parent < 0 ? Basis{} : skeleton.rest(joint.parent);
    skin.joints.push_back(static_cast<int>(scene.nodes.size()));
    skin.inverse_bind_matrices.push_back(inverse_bind_matrix(joint.rest));
    GlbNode node;
    node.name = joint.name;
    node.parent = joint.parent;
    node.translation = parent.to_local(joint.rest.origin) * kMetresPerUnit;
    node.rotation = rest_rotation(skeleton, joint);
    scene.nodes.push_back(std::move(node));
  }
  scene.skins.push_back(std::move(skin));
}

GlbClip make_clip(const HandSkeleton& skeleton, const HandClip& clip) {
  GlbClip out;
  out.name = clip.name;
  out.times = clip.times;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const Quaternion rest = rest_rotation(skeleton, skeleton.joints[j]);
    GlbTrack track;
    track.node = static_cast<int>(j);
    for (const auto& pose : clip.poses) {
      const Quaternion q = rest * joint_rotation(pose[j]);
      track.values.push_back({q.x, q.y, q.z, q.w});
    }
    out.tracks.push_back(std::move(track));
  }
  return out;
}

}  // namespace

GlbScene make_hand_scene() {
  const HandSkeleton skeleton = make_hand_skeleton();
  GlbScene scene;
  scene.copyright = "Apache-2.0";
  add_skeleton(skeleton, scene);  // node j is joint j
  scene.meshes.push_back(make_mesh(skeleton));
  GlbNode body;
  body.name = "hand_mesh";
  body.mesh = 0;
  body.skin = 0;
  scene.nodes.push_back(std::move(body));
  for (const HandClip& clip : make_hand_clips(skeleton))
    scene.clips.push_back(make_clip(skeleton, clip));
  return scene;
}

}  // namespace mdk
