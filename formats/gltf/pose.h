// Where nodes and joints stand at one moment, in double, and the rig that everything shown becomes:
// joints and nodes are bones, the morph targets of a node's mesh are targets. Rounded to float
// once, after the node hierarchy was followed in double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/rig.h"
#include "formats/gltf/animation.h"
#include "formats/gltf/document.h"
#include "formats/gltf/geometry.h"

namespace mdk::gltf {

/// One visible primitive: a node that shows it.
struct Instance {
  const PrimitiveGeometry* geometry = nullptr;
  int node = kNone;
  int skin = kNone;  ///< kNone where the node has none or the primitive has no joints

  /// None without a skin.
  std::span<const Influence> influences(std::size_t vertex) const;
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

/// Which bone and which target stands for what. Vertices stand instance by instance.
class RigPlan {
 public:
  /// Instances and skins must outlive it.
  RigPlan(std::span<const Instance> instances, std::span<const SkinBinding> skins);

  /// No list of bone weights or morph offsets is longer.
  std::size_t max_links() const { return max_links_; }
  std::size_t bytes_per_key() const {
    return bone_count_ * sizeof(Affine3f) + targets_.size() * sizeof(float);
  }

  /// The rig without poses: vertices, weights, offsets that are not zero.
  Rig shape() const;
  /// What the bones hang on: the nodes they move with and the ancestors of those, as the file has
  /// them at rest; no limits.
  Skeleton skeleton(const Document& document) const;
  void make_room(Rig& rig, std::size_t key_count) const;
  /// Different keys may be set at the same time.
  void set_key(Rig& rig, std::size_t key, const NodePose& pose) const;

 private:
  struct Target {
    int node = kNone;
    std::size_t number = 0;
  };

  /// Which nodes are joints.
  std::vector<char> joint_nodes(const Document& document) const;
  void append_vertices(const Instance& instance, Rig& rig) const;

  std::span<const Instance> instances_;
  std::span<const SkinBinding> skins_;
  std::map<int, std::uint32_t> skin_bones_;    ///< by skin: the bone of its first joint
  std::map<int, std::uint32_t> node_bones_;    ///< by node
  std::map<int, std::uint32_t> node_targets_;  ///< by node: its first target
  std::vector<Target> targets_;
  std::size_t bone_count_ = 0, max_links_ = 0;
};

}  // namespace mdk::gltf
