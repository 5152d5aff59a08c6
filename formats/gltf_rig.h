// Everything that is shown, as one rig: joints and nodes become bones, the morph targets of a
// node's mesh become targets. Rounded to float once, after the node hierarchy was followed in
// double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "common/motion/rig.h"
#include "formats/gltf_pose.h"

namespace mdk::gltf {

/// Which bone and which target stands for what. Vertices stand instance by instance.
class RigPlan {
 public:
  /// Instances and skins must outlive it.
  RigPlan(std::span<const Instance> instances, std::span<const SkinBinding> skins);

  /// No list of bone weights or morph offsets is longer.
  std::size_t most_links() const { return most_links_; }
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
  std::size_t bone_count_ = 0, most_links_ = 0;
};

}  // namespace mdk::gltf
