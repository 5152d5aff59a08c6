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
#include "common/motion/appearance.h"
#include "common/motion/pose_sequence.h"
#include "common/structures/kd_tree.h"

namespace mdk {

/// One cluster: triangles that move alike, in one local basis (GFW06 §3.1). 64 bytes, as the file
/// holds it. Clusters partition the triangles in order: each one's range starts where the last
/// ended.
struct Cluster {
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t first_node = 0, node_count = 0;  ///< its fuzzy kd-tree in kd_nodes
  std::uint32_t first_ref = 0, ref_count = 0;    ///< its leaves' references in kd_refs
  Aabb local_box;                                ///< holds every fuzzy box of the cluster
  std::uint32_t reserved[4] = {0, 0, 0, 0};
};
static_assert(sizeof(Cluster) == 64);

/// F keys, V vertices, T triangles, K clusters.
struct Model {
  std::uint32_t vertex_count = 0;
  std::uint32_t rest_key = 0;  ///< the pose the local bases were fitted to (GFW06 §3.3)
  Aabb bounds;                 ///< holds the mesh at every time
  double rest_diagonal = 0;    ///< of the rest pose's box: the unit of residuals in reports

  std::span<const Clip> clips;
  std::span<const double> key_times;     ///< F
  std::span<const Vec3f> key_positions;  ///< F * V, key-major, world space

  std::span<const Triangle> triangles;              ///< T, sorted by cluster
  std::span<const std::uint32_t> source_triangles;  ///< T: the triangle's number in the input

  std::span<const Cluster> clusters;           ///< K
  std::span<const Affine3f> local_from_world;  ///< F * K, key-major
  std::span<const Aabb> cluster_world_boxes;   ///< F * K, key-major
  std::span<const Aabb> fuzzy_boxes;           ///< T, in the local basis of its cluster
  std::span<const KdNode> kd_nodes;            ///< node links relative to the cluster's first node
  std::span<const std::uint32_t> kd_refs;      ///< triangle indices (absolute)

  std::span<const Material> materials;
  std::span<const std::uint32_t> triangle_materials;  ///< T
  std::span<const TexCoord> corner_texcoords;         ///< 0 or 3 T
  std::span<const std::uint32_t> corner_colors;       ///< 0 or 3 T
  std::span<const Texture> textures;
  std::span<const std::uint32_t> texels;

  std::uint32_t key_count() const { return static_cast<std::uint32_t>(key_times.size()); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles.size()); }
  std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(clusters.size()); }

  std::span<const Vec3f> key_pose(std::uint32_t key) const {
    return key_positions.subspan(static_cast<std::size_t>(key) * vertex_count, vertex_count);
  }
  /// Maps of all clusters at a key.
  std::span<const Affine3f> key_maps(std::uint32_t key) const {
    return local_from_world.subspan(static_cast<std::size_t>(key) * clusters.size(),
                                    clusters.size());
  }
  std::span<const Aabb> key_world_boxes(std::uint32_t key) const {
    return cluster_world_boxes.subspan(static_cast<std::size_t>(key) * clusters.size(),
                                       clusters.size());
  }
  KdTreeView fuzzy_tree(const Cluster& c) const {
    return {kd_nodes.subspan(c.first_node, c.node_count), kd_refs.subspan(c.first_ref, c.ref_count),
            c.local_box};
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
  std::vector<Vec3f> key_positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> source_triangles;
  std::vector<Cluster> clusters;
  std::vector<Affine3f> local_from_world;
  std::vector<Aabb> cluster_world_boxes;
  std::vector<Aabb> fuzzy_boxes;
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

/// A box that holds the mesh at every time of a clip. Cost: O(keys of the clip * clusters).
Aabb clip_bounds(const Model& model, std::uint32_t clip);

/// Which clip a key belongs to. Cost: O(log clips).
std::uint32_t clip_of_key(const Model& model, std::uint32_t key);

}  // namespace mdk
