// ModelView: a decomposed animated mesh ready to be traced, as spans. It owns nothing: the memory
// is a mapped file (formats/mdk/mdk_file.h) or a ModelStorage. Everything here was checked when it
// was made: tracing may follow every index and link without asking again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/arrays.h"
#include "common/motion/pose_sequence.h"
#include "common/motion/quantized_poses.h"
#include "common/motion/rig.h"
#include "common/structures/kd_tree.h"
#include "mdk/model.h"

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

enum class PoseKind : std::uint32_t {
  kKeyPositions = 0,  ///< every vertex at every key
  kRig = 1,           ///< bones and morph targets
  kQuantized = 2,     ///< key positions with few bits, not quite what was read
};

/// What key poses are computed from. A model has one kind of source, and its decoded key poses are
/// *the* poses: boxes bound them, between two keys vertices move on straight lines
/// (common/motion/posed_mesh.h). Decoding gives the same bits on every machine. F keys, V vertices.
/// The arrays of other kinds than `kind` are empty.
template <template <class> class List, template <class> class LargeList = List>
struct PoseLists {
  PoseKind kind = PoseKind::kKeyPositions;
  LargeList<Vec3f> key_positions;  ///< F * V, key-major, world space
  RigLists<List> rig;
  QuantizedLists<List, LargeList> quantized;
};
using PoseSource = PoseLists<ConstSpan>;
using PoseStorage = PoseLists<OwnedList, ScratchList>;

/// F keys, V vertices, T triangles, K clusters, S segments. `List<T>` is a span or a vector,
/// `LargeList<T>` one that may stand in a file. An array is added here, once: a member, and its row
/// in for_each_array().
template <template <class> class List, template <class> class LargeList = List>
struct ModelLists {
  std::uint32_t vertex_count = 0;
  std::uint32_t rest_key = 0;      ///< the pose the local bases were fitted to (GFW06 §3.3)
  bool holds_between_keys = true;  ///< else fuzzy boxes bound keys only, and only they are traced
  Aabb bounds;                     ///< holds the mesh at every time
  double rest_diagonal = 0;        ///< of the rest pose's box: the unit of residuals in reports

  List<Clip> clips;
  List<double> key_times;  ///< F
  PoseLists<List, LargeList> poses;

  /// Of models whose boxes hold in every pose within the joints' limits; else both are empty.
  SkeletonLists<List> skeleton;
  List<ClusterBone> cluster_bones;  ///< K

  List<Triangle> triangles;              ///< T, sorted by cluster
  List<std::uint32_t> source_triangles;  ///< T: the triangle's number in the input

  List<Cluster> clusters;                  ///< K
  List<Affine3f> local_from_world;         ///< F * K, key-major
  List<Aabb> key_boxes;                    ///< F: the mesh at each key
  List<QuantizedBox> cluster_world_boxes;  ///< F * K, key-major, in the key's box

  List<Segment> segments;          ///< S, at least one
  List<FuzzyTree> fuzzy_trees;     ///< S * K, segment-major
  List<QuantizedBox> fuzzy_boxes;  ///< S * T, segment-major, in the tree's local box
  List<KdNode> kd_nodes;           ///< node links relative to the tree's first node
  List<std::uint32_t> kd_refs;     ///< triangle indices (absolute)

  AppearanceLists<List> appearance;

  /// Calls visit(row, the array of each model) for the arrays that stand in a section of the file
  /// as they are, in file order: what opening reads first, the bulk last. Counts that others are
  /// made of come before those. Clips and scalars are records of the file and not visited.
  template <class Visit, class... Models>
  static void for_each_array(Visit&& visit, Models&... models) {
    using enum Count;
    using namespace count_rules;
    visit(array_row("TIME", "key_times", some()), models.key_times...);
    visit(array_row("CLUS", "clusters", some()), models.clusters...);
    visit(array_row("SEGM", "segments", at_most(kKeys)), models.segments...);
    visit(array_row("FTRE", "fuzzy_trees", exactly(kSegments, kClusters)), models.fuzzy_trees...);
    visit(array_row("NODE", "kd_nodes", between(1, kMaxLinks)), models.kd_nodes...);
    visit(array_row("REFS", "kd_refs", between(0, kMaxLinks)), models.kd_refs...);
    visit(array_row("TRIS", "triangles", some()), models.triangles...);
    visit(array_row("SRCT", "source_triangles", exactly(kTriangles)), models.source_triangles...);
    visit(array_row("MAPS", "local_from_world", exactly(kKeys, kClusters)),
          models.local_from_world...);
    visit(array_row("KBOX", "key_boxes", exactly(kKeys)), models.key_boxes...);
    visit(array_row("WBOX", "cluster_world_boxes", exactly(kKeys, kClusters)),
          models.cluster_world_boxes...);
    visit(array_row("FBOX", "fuzzy_boxes", exactly(kSegments, kTriangles)), models.fuzzy_boxes...);
    Appearance::for_each_array(visit, models.appearance...);
    Rig::for_each_array(visit, models.poses.rig...);
    Skeleton::for_each_array(visit, models.skeleton...);
    visit(array_row("CBON", "cluster_bones", exactly(kClusters), ModelPart::kSkeleton),
          models.cluster_bones...);
    QuantizedPoses::for_each_array(visit, models.poses.quantized...);
    visit(array_row("POSE", "key_positions", exactly(kKeys, kVertices), ModelPart::kKeyPositions),
          models.poses.key_positions...);
  }

  std::uint32_t key_count() const { return static_cast<std::uint32_t>(key_times.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles.size()); }
  std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(clusters.size()); }
  std::uint32_t segment_count() const { return static_cast<std::uint32_t>(segments.size()); }
};

/// Makes `to` a view or a copy of `from`.
template <class To, class From>
void assign_model(To& to, const From& from) {
  to.vertex_count = from.vertex_count;
  to.rest_key = from.rest_key;
  to.holds_between_keys = from.holds_between_keys;
  to.bounds = from.bounds;
  to.rest_diagonal = from.rest_diagonal;
  to.poses.kind = from.poses.kind;
  kAssign(ModelArray{}, to.clips, from.clips);
  To::for_each_array(kAssign, to, from);
}

/// A model as spans.
struct ModelView : ModelLists<ConstSpan> {
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
struct ModelStorage : ModelLists<OwnedList, ScratchList> {
  /// Valid while this lives and is not changed.
  ModelView view() const;
};

/// The interval of `clip` (an index) that holds `seconds`; times outside the clip are clamped to
/// it. Of a model that does not hold between keys, the nearest key. Cost: O(log keys).
KeyInterval locate_time(const ModelView& model, std::uint32_t clip, double seconds);

/// A time brought into a clip of D seconds: in [0, D], 0 for a phase that is not finite.
double wrapped_time(double phase, double seconds, ClipWrap wrap);

/// Exactly at a key.
inline KeyInterval at_key(std::uint32_t key) { return {key, key, 0.0f}; }

/// Whether locate_time() or at_key() may give this.
bool has_time(const ModelView& model, const KeyInterval& time);

/// The segment whose boxes hold at a moment; at a key that two segments share, the earlier one.
/// Cost: O(log segments).
std::uint32_t segment_of(const ModelView& model, const KeyInterval& at);

/// World positions of a range of vertices at a key; `out` has one per vertex of the range. Always
/// the same bits, whichever ranges are asked for. Cost: O(range), and O(bones) for a rig.
void decode_pose(const ModelView& model, std::uint32_t key, VertexRange range,
                 std::span<Vec3f> out);

/// A box that holds the mesh at every time of a clip. Cost: O(keys of the clip).
Aabb clip_bounds(const ModelView& model, std::uint32_t clip);

/// Which clip a key belongs to. Cost: O(log clips).
std::uint32_t clip_of_key(const ModelView& model, std::uint32_t key);

}  // namespace mdk
