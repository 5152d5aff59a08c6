// Rig: what a skinned, morphed or rigidly moving mesh is computed from. A vertex is
//
//     p = sum over its bones of  w * (M_bone * (base + sum over its targets of  a_target * offset))
//
// with one 3x4 matrix M per bone and one weight a per morph target at every key: a thousand keys
// take the room of a few. A part that moves as a whole is one bone with weight 1.
//
// Skeleton: the joints behind a rig's bones, so that a mesh can be posed by hand, also in poses
// that no clip contains (GFSS06; Lo09 §4.3). A joint turns about its own origin:
//
//     world_from_joint = world_from_parent * parent_from_joint * turn * scale
//     bone (world from base) = world_from_joint * joint_from_base
//
// Translations and scales stay as they are at rest. A limit says how far a joint may turn from its
// rest rotation, about any axis: the poses within all limits are what boxes can be made for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "common/motion/arrays.h"

namespace mdk {

/// Vertices [begin, end).
struct VertexRange {
  std::uint32_t begin = 0, end = 0;

  std::uint32_t size() const { return end - begin; }
};

/// 8 bytes, as the file holds it.
struct BoneWeight {
  std::uint32_t bone = 0;
  float weight = 0;

  bool operator==(const BoneWeight&) const = default;
};

/// How far a morph target of weight 1 moves a vertex. 16 bytes, as the file holds it.
struct MorphOffset {
  std::uint32_t target = 0;
  Vec3f offset;

  bool operator==(const MorphOffset&) const = default;
};

/// V vertices, F keys, J bones, M morph targets; no owner. `List<T>` is a span or a vector.
template <template <class> class List>
struct RigLists {
  List<Vec3f> base_positions;        ///< V
  List<std::uint32_t> first_weight;  ///< V + 1: vertex i's in bone_weights; at least one each
  List<BoneWeight> bone_weights;     ///< bones below J
  List<std::uint32_t> first_offset;  ///< V + 1: vertex i's in morph_offsets; empty without morphs
  List<MorphOffset> morph_offsets;   ///< targets below M
  List<Affine3f> bone_maps;          ///< F * J, key-major: world from base
  List<float> target_weights;        ///< F * M, key-major

  /// Calls visit(row, the array of each rig) for every array, in file order.
  template <class Visit, class... Rigs>
  static void for_each_array(Visit&& visit, Rigs&... rigs) {
    using enum Count;
    using namespace count_rules;
    constexpr ModelPart kPart = ModelPart::kRig;
    visit(array_row("BONE", "bone_maps", per_key(), kPart), rigs.bone_maps...);
    visit(array_row("TGTW", "target_weights", per_key(), kPart), rigs.target_weights...);
    visit(array_row("BASE", "base_positions", exactly(kVertices), kPart), rigs.base_positions...);
    visit(array_row("BWFI", "first_weight", exactly_one_more_than(kVertices), kPart),
          rigs.first_weight...);
    visit(array_row("BWGT", "bone_weights", any(), kPart), rigs.bone_weights...);
    visit(array_row("MOFI", "first_offset", none_or_one_more_than(kVertices), kPart),
          rigs.first_offset...);
    visit(array_row("MOFF", "morph_offsets", any(), kPart), rigs.morph_offsets...);
  }

  /// Valid while this lives and is not changed.
  RigLists<ConstSpan> view() const {
    RigLists<ConstSpan> rig;
    for_each_array(kAssign, rig, *this);
    return rig;
  }
  /// Bytes of all arrays.
  std::size_t bytes() const {
    ByteSum sum;
    for_each_array(sum, *this);
    return sum.bytes;
  }
};

using RigView = RigLists<ConstSpan>;
/// A rig that owns its arrays.
using Rig = RigLists<OwnedList>;

/// The bones and morph weights of one moment.
struct RigPose {
  std::span<const Affine3f> bones;        ///< J
  std::span<const float> target_weights;  ///< M
};

/// The pose at a key of a rig with `key_count` keys.
RigPose rig_pose(const RigView& rig, std::uint32_t key, std::uint32_t key_count);

/// World positions of a range of vertices; `out` has one per vertex of the range. Float, in the
/// order of the lists and without fused multiply-adds: every machine gives the same bits.
/// Cost: O(J + the range's bone weights and morph offsets).
void pose_vertices(const RigView& rig, const RigPose& pose, VertexRange range,
                   std::span<Vec3f> out);

/// The rig of the vertices `kept`, in that order.
Rig select_vertices(const Rig& rig, std::span<const std::uint32_t> kept);

enum class AlikeBones {
  kJoin,  ///< bones that are alike at every key become one
  kKeep,  ///< since in other poses they may not be alike
};

/// Joins alike bones or keeps them, drops bones and morph targets that move no vertex, puts each
/// vertex's weights in bone order and one per bone. Positions change by rounding at most. Returns
/// the old numbers of the bones that are left. Cost: O(F * J log J + weights + offsets).
std::vector<std::uint32_t> simplify_rig(Rig& rig, std::uint32_t key_count,
                                        AlikeBones alike = AlikeBones::kJoin);

/// Per vertex the lowest vertex that is computed from the same numbers and has the same group.
/// `groups`: one per vertex, or empty for "all alike". Cost: O(V log V).
std::vector<std::uint32_t> lowest_alike_vertices(const Rig& rig,
                                                 std::span<const std::uint64_t> groups);

inline constexpr std::uint32_t kNoParent = 0xffffffffu;

/// 80 bytes, as the file holds it.
struct Joint {
  std::uint32_t parent = kNoParent;  ///< a lower number than its own
  float limit = 0;                   ///< radians, in [0, pi]
  std::uint32_t name_offset = 0, name_bytes = 0;
  Affine3f parent_from_joint;  ///< at rest, without its scale
  Vec3f scale{1, 1, 1};
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Joint) == 80);

/// Which joint a bone of the rig hangs on. 52 bytes, as the file holds it.
struct BoneBinding {
  std::uint32_t joint = 0;
  Affine3f joint_from_base;
};
static_assert(sizeof(BoneBinding) == 52);

template <template <class> class List>
struct SkeletonLists {
  List<Joint> joints;
  List<char> names;         ///< one after another
  List<BoneBinding> bones;  ///< one per bone of the rig

  /// See RigLists.
  template <class Visit, class... Skeletons>
  static void for_each_array(Visit&& visit, Skeletons&... skeletons) {
    using namespace count_rules;
    constexpr ModelPart kPart = ModelPart::kSkeleton;
    visit(array_row("JNTS", "joints", any(), kPart), skeletons.joints...);
    visit(array_row("JNAM", "joint_names", any(), kPart), skeletons.names...);
    visit(array_row("BIND", "bone_bindings", exactly(Count::kBones), kPart), skeletons.bones...);
  }

  /// Valid while this lives and is not changed.
  SkeletonLists<ConstSpan> view() const {
    SkeletonLists<ConstSpan> skeleton;
    for_each_array(kAssign, skeleton, *this);
    return skeleton;
  }
  std::string_view name(const Joint& joint) const {
    return {names.data() + joint.name_offset, joint.name_bytes};
  }
};

using SkeletonView = SkeletonLists<ConstSpan>;
/// A skeleton that owns its arrays.
using Skeleton = SkeletonLists<OwnedList>;

/// How a skeleton stands, apart from its rest.
struct SkeletonPose {
  std::vector<Vec3d> turns;           ///< per joint, in its own axes: axis times angle in radians
  std::vector<float> target_weights;  ///< per morph target of the rig

  bool operator==(const SkeletonPose&) const = default;
};

/// The rotation by |turn| radians about `turn`.
Affine3d rotation(const Vec3d& turn);

/// x -> s x, coordinate by coordinate.
inline Affine3d scaling(const Vec3f& s) {
  Affine3d a;
  a.m[0][0] = s.x;
  a.m[1][1] = s.y;
  a.m[2][2] = s.z;
  return a;
}

/// Per joint. `pose` has a turn for each. Cost: O(joints).
std::vector<Affine3d> world_from_joints(const SkeletonView& skeleton, const SkeletonPose& pose);

/// Per bone: world from base, rounded to float once.
std::vector<Affine3f> bone_maps(const SkeletonView& skeleton, const SkeletonPose& pose);

/// The first joint that is turned past its limit (or by no number at all); kNoParent where none is.
std::uint32_t joint_past_limit(const SkeletonView& skeleton, const SkeletonPose& pose);

}  // namespace mdk
