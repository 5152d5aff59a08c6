// Model: a decomposed animated mesh ready to be traced, as spans. It owns nothing: the memory is a
// mapped file (formats/mdk_view.h) or a ModelStorage. Everything here was checked when it was made:
// tracing may follow every index and link without asking again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/math/quantized_box.h"
#include "common/motion/appearance.h"
#include "common/motion/pose_sequence.h"
#include "common/motion/pose_source.h"
#include "common/structures/kd_tree.h"

namespace mdk {

/// One cluster: triangles that move alike, in one local basis (GFW06 §3.1). 8 bytes, as the file
/// holds it. Clusters partition the triangles in order: each one's range starts where the last
/// ended.
struct Cluster {
  std::uint32_t first_triangle = 0, triangle_count = 0;
};

/// A stretch of the time line with fuzzy boxes and trees of its own, both keys inclusive; clusters
/// and maps are shared by all (GFW06 §6). 8 bytes, as the file holds it. Segments cover the keys in
/// order. A cut inside a clip shares its key, so that each interval between keys lies in one
/// segment; a cut between clips shares nothing:
///
///     keys       0  1  2  3  4 | 5  6       a clip of five keys, one of two
///     segments  [0     2]
///                     [2     4]  [5  6]     cut at key 2, and between the clips
struct Segment {
  std::uint32_t first_key = 0, last_key = 0;

  bool operator==(const Segment&) const = default;
};

/// The fuzzy kd-tree of one cluster in one segment. 40 bytes, as the file holds it.
struct FuzzyTree {
  std::uint32_t first_node = 0, node_count = 0;  ///< in kd_nodes
  std::uint32_t first_ref = 0, ref_count = 0;    ///< in kd_refs
  Aabb local_box;  ///< what the fuzzy boxes of the cluster in the segment are quantised in
};

/// The bone that a cluster follows: local_from_world = local_from_base * bone⁻¹. 52 bytes, as the
/// file holds it.
struct ClusterBone {
  std::uint32_t bone = 0;
  Affine3f local_from_base;
};
static_assert(sizeof(ClusterBone) == 52);

/// F keys, V vertices, T triangles, K clusters, S segments.
struct Model {
  std::uint32_t vertex_count = 0;
  std::uint32_t rest_key = 0;  ///< the pose the local bases were fitted to (GFW06 §3.3)
  Aabb bounds;                 ///< holds the mesh at every time
  double rest_diagonal = 0;    ///< of the rest pose's box: the unit of residuals in reports

  std::span<const Clip> clips;
  std::span<const double> key_times;  ///< F
  PoseSource poses;

  /// Of models whose boxes hold in every pose within the joints' limits; else both are empty.
  SkeletonView skeleton;
  std::span<const ClusterBone> cluster_bones;  ///< K

  std::span<const Triangle> triangles;              ///< T, sorted by cluster
  std::span<const std::uint32_t> source_triangles;  ///< T: the triangle's number in the input

  std::span<const Cluster> clusters;                  ///< K
  std::span<const Affine3f> local_from_world;         ///< F * K, key-major
  std::span<const Aabb> key_boxes;                    ///< F: the mesh at each key
  std::span<const QuantizedBox> cluster_world_boxes;  ///< F * K, key-major, in the key's box

  std::span<const Segment> segments;          ///< S, at least one
  std::span<const FuzzyTree> fuzzy_trees;     ///< S * K, segment-major
  std::span<const QuantizedBox> fuzzy_boxes;  ///< S * T, segment-major, in the tree's local box
  std::span<const KdNode> kd_nodes;           ///< node links relative to the tree's first node
  std::span<const std::uint32_t> kd_refs;     ///< triangle indices (absolute)

  std::span<const Material> materials;
  std::span<const std::uint32_t> triangle_materials;  ///< T
  std::span<const TexCoord> corner_texcoords;         ///< 0 or 3 T
  std::span<const std::uint32_t> corner_colors;       ///< 0 or 3 T
  std::span<const Texture> textures;
  std::span<const std::uint32_t> texels;

  std::uint32_t key_count() const { return static_cast<std::uint32_t>(key_times.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles.size()); }
  std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(clusters.size()); }
  std::uint32_t segment_count() const { return static_cast<std::uint32_t>(segments.size()); }

  /// Maps of all clusters at a key.
  std::span<const Affine3f> key_maps(std::uint32_t key) const {
    return local_from_world.subspan(static_cast<std::size_t>(key) * clusters.size(),
                                    clusters.size());
  }
  /// Holds a cluster at a key, in world space.
  Aabb world_box(std::uint32_t key, std::size_t cluster) const {
    return dequantize(
        cluster_world_boxes[static_cast<std::size_t>(key) * clusters.size() + cluster],
        key_boxes[key]);
  }
  /// Holds a triangle, which must be the cluster's, at every time of a segment, in the cluster's
  /// local basis.
  Aabb fuzzy_box(std::uint32_t segment, std::size_t cluster, std::size_t triangle) const {
    return dequantize(fuzzy_boxes[static_cast<std::size_t>(segment) * triangles.size() + triangle],
                      segment_trees(segment)[cluster].local_box);
  }
  /// The fuzzy boxes of a cluster's triangles in a segment. Cost: O(triangles of the cluster).
  std::vector<Aabb> cluster_fuzzy_boxes(std::uint32_t segment, std::size_t cluster) const;
  /// Trees of all clusters in a segment.
  std::span<const FuzzyTree> segment_trees(std::uint32_t segment) const {
    return fuzzy_trees.subspan(static_cast<std::size_t>(segment) * clusters.size(),
                               clusters.size());
  }
  KdTreeView tree_view(const FuzzyTree& t) const {
    return {kd_nodes.subspan(t.first_node, t.node_count), kd_refs.subspan(t.first_ref, t.ref_count),
            t.local_box};
  }
  double clip_seconds(const Clip& clip) const {
    return key_times[clip.first_key + clip.key_count - 1];
  }
};

/// A model that owns its memory: what the decomposition returns, before it is written.
struct ModelStorage {
  std::uint32_t vertex_count = 0;
  std::uint32_t rest_key = 0;
  Aabb bounds;
  double rest_diagonal = 0;

  std::vector<Clip> clips;
  std::vector<double> key_times;
  PoseStorage poses;
  Skeleton skeleton;
  std::vector<ClusterBone> cluster_bones;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> source_triangles;
  std::vector<Cluster> clusters;
  std::vector<Affine3f> local_from_world;
  std::vector<Aabb> key_boxes;
  std::vector<QuantizedBox> cluster_world_boxes;
  std::vector<Segment> segments;
  std::vector<FuzzyTree> fuzzy_trees;
  std::vector<QuantizedBox> fuzzy_boxes;
  std::vector<KdNode> kd_nodes;
  std::vector<std::uint32_t> kd_refs;
  Appearance appearance;

  /// Valid while this lives and is not changed.
  Model view() const;
};

/// Where a time lies between keys: pose(t) = key0 + s (key1 - key0). At a key exactly, key0 == key1
/// and s == 0.
struct KeyInterval {
  std::uint32_t key0 = 0, key1 = 0;
  float s = 0;  ///< in [0, 1)

  bool operator==(const KeyInterval&) const = default;
};

/// The interval of `clip` (an index) that holds `seconds`; times outside the clip are clamped to
/// it. Cost: O(log keys).
KeyInterval locate_time(const Model& model, std::uint32_t clip, double seconds);

/// Exactly at a key.
inline KeyInterval at_key(std::uint32_t key) { return {key, key, 0.0f}; }

/// The segment whose boxes hold at a moment; at a key that two segments share, the earlier one.
/// Cost: O(log segments).
std::uint32_t segment_of(const Model& model, const KeyInterval& at);

/// World positions of a range of vertices at a key; `out` has one per vertex of the range. Always
/// the same bits, whichever ranges are asked for. Cost: O(range), and O(bones) for a rig.
void decode_pose(const Model& model, std::uint32_t key, VertexRange range, std::span<Vec3f> out);

/// A box that holds the mesh at every time of a clip. Cost: O(keys of the clip).
Aabb clip_bounds(const Model& model, std::uint32_t clip);

/// Which clip a key belongs to. Cost: O(log clips).
std::uint32_t clip_of_key(const Model& model, std::uint32_t key);

}  // namespace mdk
