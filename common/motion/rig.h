// Rig: what a skinned, morphed or rigidly moving mesh is computed from. A vertex is
//
//     p = sum over its bones of  w * (M_bone * (base + sum over its targets of  a_target * offset))
//
// with one 3x4 matrix M per bone and one weight a per morph target at every key: a thousand keys
// take the room of a few. A part that moves as a whole is one bone with weight 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/math/vec3.h"

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
};

template <class T>
using ConstSpan = std::span<const T>;
template <class T>
using OwnedList = std::vector<T>;

using RigView = RigLists<ConstSpan>;

/// A rig that owns its lists.
struct Rig : RigLists<OwnedList> {
  /// Valid while this lives and is not changed.
  RigView view() const;
  /// Bytes of all lists.
  std::size_t bytes() const;
};

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

}  // namespace mdk
