// Where nodes and joints stand at one moment; all in double.
#pragma once

#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "formats/gltf_animation.h"
#include "formats/gltf_document.h"
#include "formats/gltf_geometry.h"

namespace mdk::gltf {

/// One visible primitive: a node that shows it.
struct Instance {
  const PrimitiveGeometry* geometry = nullptr;
  int node = kNone;
  int skin = kNone;  ///< kNone where the node has none or the primitive has no joints
};

/// Skins with their inverse bind matrices read.
struct SkinBinding {
  std::vector<int> joints;                  ///< nodes
  std::vector<Affine3d> joint_from_vertex;  ///< per joint
};

std::vector<SkinBinding> read_skins(const Document& document);

/// All nodes at one moment.
struct NodePose {
  std::vector<Affine3d> world_from_node;
  std::vector<std::vector<double>> weights;  ///< per node: morph weights
};

/// The nodes at `seconds` from the clip's start; what the clip does not move stays as the file has
/// it.
NodePose pose_nodes(const Document& document, const AnimationClip& clip, double seconds);

/// One map per joint of a skin: world from the space its vertices are modelled in.
std::vector<Affine3d> pose_joints(const SkinBinding& skin, const NodePose& pose);

/// Whether the instance is mirrored: its maps' determinants, weighted by what they move, are
/// negative (glTF 2.0 §3.7.4: then its triangles wind the other way).
bool is_mirrored(const Instance& instance, const NodePose& pose, std::span<const Affine3d> joints);

}  // namespace mdk::gltf
