// Checks in an order in which each one may rely on those before it: sizes first, then what indexes
// by them. Each returns the first fault as a sentence, or nothing.
#include "formats/model_check.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "common/structures/kd_tree.h"
#include "formats/check_text.h"
#include "formats/pose_check.h"
#include "formats/skeleton_check.h"
#include "formats/utf8_text.h"

namespace mdk {
namespace {

constexpr std::uint64_t kMaxCount = (std::uint64_t{1} << 30) - 1;  // so that 3 T fits 32 bits
constexpr std::uint64_t kMaxLinks = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kMaxTextureSide = 1u << 24;

std::string range_fault(const char* name, std::uint64_t count, std::uint64_t least,
                        std::uint64_t most) {
  if (least <= count && count <= most) return {};
  return std::string(name) + ": " + number(count) + " of them, where " + number(least) + " to " +
         number(most) + " can be";
}

bool is_box(const Aabb& b) {
  constexpr float kMax = std::numeric_limits<float>::max();
  bool ok = true;  // no early exit: this runs over all boxes
  for (int axis = 0; axis < 3; ++axis) {
    ok &= -kMax <= b.lo[axis] && b.lo[axis] <= b.hi[axis] && b.hi[axis] <= kMax;
  }
  return ok;
}

/// In a frame that is a finite box it lies as one, too.
bool is_box(const QuantizedBox& b) {
  return b.lo[0] <= b.hi[0] && b.lo[1] <= b.hi[1] && b.lo[2] <= b.hi[2];
}

std::string check_counts(const Model& m) {
  const std::uint64_t keys = m.key_times.size();
  const std::uint64_t triangles = m.triangles.size(), clusters = m.clusters.size();
  const std::uint64_t segments = m.segments.size();
  const std::string ranges[] = {
      range_fault("vertices", m.vertex_count, 1, kMaxCount),
      range_fault("key_times", keys, 1, kMaxCount),
      range_fault("triangles", triangles, 1, kMaxCount),
      range_fault("clusters", clusters, 1, kMaxCount),
      range_fault("segments", segments, 1, keys),
      range_fault("clips", m.clips.size(), 1, kMaxCount),
      range_fault("materials", m.materials.size(), 1, kMaxCount),
      range_fault("textures", m.textures.size(), 0, kMaxCount),
      range_fault("kd_nodes", m.kd_nodes.size(), 1, kMaxLinks),
      range_fault("kd_refs", m.kd_refs.size(), 0, kMaxLinks),
  };
  for (const std::string& fault : ranges) {
    if (!fault.empty()) return fault;
  }
  const auto per_corner = [&](std::size_t count) { return count == 0 ? 0 : 3 * triangles; };
  const std::string sizes[] = {
      count_fault("source_triangles", m.source_triangles.size(), triangles),
      count_fault("local_from_world", m.local_from_world.size(), keys * clusters),
      count_fault("key_boxes", m.key_boxes.size(), keys),
      count_fault("cluster_world_boxes", m.cluster_world_boxes.size(), keys * clusters),
      count_fault("fuzzy_trees", m.fuzzy_trees.size(), segments * clusters),
      count_fault("fuzzy_boxes", m.fuzzy_boxes.size(), segments * triangles),
      count_fault("triangle_materials", m.triangle_materials.size(), triangles),
      count_fault("corner_texcoords", m.corner_texcoords.size(),
                  per_corner(m.corner_texcoords.size())),
      count_fault("corner_colors", m.corner_colors.size(), per_corner(m.corner_colors.size())),
  };
  for (const std::string& fault : sizes) {
    if (!fault.empty()) return fault;
  }
  return {};
}

std::string check_scalars(const Model& m) {
  if (m.rest_key >= m.key_count()) {
    return "model: rest key " + number(m.rest_key) + " is not one of its " + number(m.key_count()) +
           " keys";
  }
  if (!std::isfinite(m.rest_diagonal) || m.rest_diagonal < 0) {
    return "model: the rest diagonal is not a length";
  }
  if (!is_box(m.bounds)) return "model: the bounds are not a finite box";
  return {};
}

std::string check_clips(const Model& m) {
  std::uint64_t next_key = 0, name_bytes = 0;
  for (std::size_t i = 0; i < m.clips.size(); ++i) {
    const Clip& clip = m.clips[i];
    const std::string name = "clips: clip " + number(i);
    if (!is_utf8(clip.name)) return name + " has a name that is not UTF-8";
    name_bytes += clip.name.size();
    if (name_bytes > kMaxLinks) return "clips: their names take more than 4 GiB";
    if (clip.first_key != next_key || clip.key_count == 0) {
      return name + " does not start where the last one ended, or is empty";
    }
    next_key += clip.key_count;
    if (next_key > m.key_times.size()) return name + " reaches past the last key";
    const auto times = m.key_times.subspan(clip.first_key, clip.key_count);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const bool in_order = k == 0 ? times[k] >= 0 : times[k] > times[k - 1];
      if (!std::isfinite(times[k]) || !in_order) {
        return "key_times: key " + number(clip.first_key + k) +
               " has a time that is not finite, negative, or not after the one before";
      }
    }
  }
  if (next_key != m.key_times.size()) return "clips: they do not cover every key";
  return {};
}

std::string check_triangles(const Model& m) {
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    for (const std::uint32_t vertex : m.triangles[t].v) {
      if (vertex >= m.vertex_count) {
        return "triangles: triangle " + number(t) + " names vertex " + number(vertex) + " of " +
               number(m.vertex_count);
      }
    }
  }
  for (std::size_t t = 0; t < m.source_triangles.size(); ++t) {
    if (m.source_triangles[t] >= m.triangles.size()) {
      return "source_triangles: triangle " + number(t) + " comes from one that does not exist";
    }
  }
  return {};
}

std::string check_segments(const Model& m) {
  std::uint64_t next_first = 0;
  for (std::size_t i = 0; i < m.segments.size(); ++i) {
    const Segment& segment = m.segments[i];
    const std::string name = "segments: segment " + number(i);
    if (segment.first_key != next_first) return name + " does not start where the last one ended";
    const bool on = i == 0 ? segment.last_key >= segment.first_key
                           : segment.last_key > m.segments[i - 1].last_key;
    if (!on) return name + " does not reach past the last one's end";
    if (segment.last_key >= m.key_times.size()) return name + " reaches past the last key";
    const Clip& clip = m.clips[clip_of_key(m, segment.last_key)];
    const bool ends_clip = segment.last_key + 1 == clip.first_key + clip.key_count;
    next_first = segment.last_key + (ends_clip ? 1 : 0);
  }
  if (next_first != m.key_times.size()) return "segments: they do not cover every key";
  return {};
}

/// A list that others cut into consecutive runs.
struct Partition {
  const char* what;
  std::uint64_t size;
  std::uint64_t next = 0;

  std::string take(std::uint64_t first, std::uint64_t count) {
    if (first != next) return std::string(what) + " do not start where the last one's ended";
    if (count > size - next) return std::string(what) + " reach past the end of their list";
    next += count;
    return {};
  }
};

std::string check_clusters(const Model& m) {
  Partition triangles{"triangles", m.triangles.size()};
  for (std::size_t i = 0; i < m.clusters.size(); ++i) {
    const Cluster& c = m.clusters[i];
    const std::string name = "clusters: cluster " + number(i);
    if (c.triangle_count == 0) return name + " has no triangles";
    if (const std::string fault = triangles.take(c.first_triangle, c.triangle_count);
        !fault.empty()) {
      return name + ": its " + fault;
    }
  }
  if (triangles.next != triangles.size) return "clusters: some triangles are in none";
  return {};
}

std::string check_tree_ranges(const Model& m) {
  Partition nodes{"nodes", m.kd_nodes.size()};
  Partition refs{"references", m.kd_refs.size()};
  for (std::size_t i = 0; i < m.fuzzy_trees.size(); ++i) {
    const FuzzyTree& tree = m.fuzzy_trees[i];
    const std::string name = "fuzzy_trees: tree " + number(i);
    if (tree.node_count == 0) return name + " is empty";
    if (!is_box(tree.local_box)) return name + " has a local box that is not a finite box";
    for (const std::string& fault : {nodes.take(tree.first_node, tree.node_count),
                                     refs.take(tree.first_ref, tree.ref_count)}) {
      if (!fault.empty()) return name + ": its " + fault;
    }
  }
  for (const Partition& list : {nodes, refs}) {
    if (list.next != list.size) {
      return "fuzzy_trees: some " + std::string(list.what) + " are in none";
    }
  }
  return {};
}

std::string check_trees(const Model& m) {
  for (std::size_t i = 0; i < m.fuzzy_trees.size(); ++i) {
    const Cluster& c = m.clusters[i % m.clusters.size()];
    if (!is_well_formed(m.tree_view(m.fuzzy_trees[i]), c.first_triangle,
                        c.first_triangle + c.triangle_count)) {
      return "kd_nodes: tree " + number(i) + " is malformed";
    }
  }
  return {};
}

std::string check_boxes_and_maps(const Model& m) {
  for (std::size_t i = 0; i < m.fuzzy_boxes.size(); ++i) {
    if (!is_box(m.fuzzy_boxes[i])) return "fuzzy_boxes: number " + number(i) + " is not a box";
  }
  for (std::size_t i = 0; i < m.key_boxes.size(); ++i) {
    if (!is_box(m.key_boxes[i])) return "key_boxes: number " + number(i) + " is not a finite box";
  }
  for (std::size_t i = 0; i < m.cluster_world_boxes.size(); ++i) {
    if (!is_box(m.cluster_world_boxes[i])) {
      return "cluster_world_boxes: number " + number(i) + " is not a box";
    }
  }
  for (std::size_t i = 0; i < m.local_from_world.size(); ++i) {
    if (!is_finite(m.local_from_world[i])) {
      return "local_from_world: map " + number(i) + " is not finite";
    }
  }
  return {};
}

bool is_wrap(TextureWrap wrap) {
  return wrap == TextureWrap::kRepeat || wrap == TextureWrap::kClamp ||
         wrap == TextureWrap::kMirror;
}

std::string check_materials(const Model& m) {
  for (std::size_t i = 0; i < m.materials.size(); ++i) {
    const Material& material = m.materials[i];
    const std::string name = "materials: material " + number(i);
    for (const float channel : material.base_color) {
      if (!(channel >= 0 && channel <= 1)) return name + " has a colour outside [0, 1]";
    }
    if (material.texture != kNoTexture && material.texture >= m.textures.size()) {
      return name + " names texture " + number(material.texture) + " of " +
             number(m.textures.size());
    }
    if ((material.flags & ~std::uint32_t{kMaterialKnownFlags}) != 0) {
      return name + " has unknown flags";
    }
    if (!is_wrap(material.wrap_u) || !is_wrap(material.wrap_v))
      return name + " has an unknown wrap";
  }
  for (std::size_t t = 0; t < m.triangle_materials.size(); ++t) {
    if (m.triangle_materials[t] >= m.materials.size()) {
      return "triangle_materials: triangle " + number(t) + " names material " +
             number(m.triangle_materials[t]) + " of " + number(m.materials.size());
    }
  }
  return {};
}

std::string check_textures(const Model& m) {
  for (std::size_t i = 0; i < m.textures.size(); ++i) {
    const Texture& texture = m.textures[i];
    const std::string name = "textures: texture " + number(i);
    if (texture.width == 0 || texture.width > kMaxTextureSide || texture.height == 0 ||
        texture.height > kMaxTextureSide) {
      return name + " has an impossible size";
    }
    const std::uint64_t texels = std::uint64_t{texture.width} * texture.height;
    if (texels > m.texels.size() || texture.first_texel > m.texels.size() - texels) {
      return name + " reaches past the last texel";
    }
  }
  return {};
}

}  // namespace

std::string find_inconsistency(const Model& model) {
  for (const auto check :
       {check_counts, check_scalars, check_clips, check_segments, check_triangles, check_clusters,
        check_tree_ranges, check_trees, check_boxes_and_maps, check_poses, check_skeleton,
        check_materials, check_textures}) {
    if (std::string fault = check(model); !fault.empty()) return fault;
  }
  return {};
}

}  // namespace mdk
