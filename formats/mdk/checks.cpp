// Checks in an order in which each one may rely on those before it: counts first, then what indexes
// by them. Each returns the first fault as a sentence that begins with the name of an array, or
// nothing.
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>

#include "common/structures/kd_tree.h"
#include "formats/files/text.h"
#include "formats/mdk/mdk_file.h"

namespace mdk {
namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

/// The first of some faults, or nothing.
std::string first_of(std::initializer_list<std::string> faults) {
  for (const std::string& fault : faults)
    if (!fault.empty()) return fault;
  return {};
}

ArrayCounts counts_of(const ModelView& m) {
  const std::uint64_t keys = m.key_times.size(), runs = m.poses.quantized.first_vertex.size();
  ArrayCounts counts;
  counts.set(Count::kVertices, m.vertex_count);
  counts.set(Count::kKeys, keys);
  counts.set(Count::kTriangles, m.triangles.size());
  counts.set(Count::kCorners, 3 * std::uint64_t{m.triangles.size()});
  counts.set(Count::kClusters, m.clusters.size());
  counts.set(Count::kSegments, m.segments.size());
  counts.set(Count::kBones, keys == 0 ? 0 : m.poses.rig.bone_maps.size() / keys);
  counts.set(Count::kRuns, runs == 0 ? 0 : runs - 1);
  return counts;
}

/// Why a part of a model is not there, or null where it is.
const char* absence_of(ModelPart part, const ModelView& m) {
  constexpr const char* kOtherwise = "poses are stored in another way";
  const PoseKind kind = m.poses.kind;
  switch (part) {
    case ModelPart::kWhole:
      break;
    case ModelPart::kKeyPositions:
      return kind == PoseKind::kKeyPositions ? nullptr : kOtherwise;
    case ModelPart::kRig:
      return kind == PoseKind::kRig ? nullptr : kOtherwise;
    case ModelPart::kQuantized:
      return kind == PoseKind::kQuantized ? nullptr : kOtherwise;
    case ModelPart::kSkeleton:
      if (kind != PoseKind::kRig) return "poses do not come from a rig";
      return m.skeleton.joints.empty() ? "there are no joints" : nullptr;
  }
  return nullptr;
}

/// In the order of the file, so that products are taken of counts that are sound.
std::string check_counts(const ModelView& m) {
  const ArrayCounts counts = counts_of(m);
  std::string fault = first_of({range_fault("vertices", m.vertex_count, 1, kMaxCount),
                                range_fault("clips", m.clips.size(), 1, kMaxCount)});
  ModelView::for_each_array(
      [&](const ModelArray& row, const auto& array) {
        if (!fault.empty()) return;
        const char* const absence = absence_of(row.part, m);
        if (!absence)
          fault = count_fault(row, array.size(), counts);
        else if (!array.empty())
          fault = std::string(row.name) + ": there, though " + absence;
      },
      m);
  return fault;
}

bool is_number(float value) { return std::isfinite(value); }
bool is_number(const Vec3f& v) { return is_number(v.x) && is_number(v.y) && is_number(v.z); }
bool is_number(const BoneWeight& w) { return is_number(w.weight); }
bool is_number(const MorphOffset& m) { return is_number(m.offset); }
bool is_number(const Affine3f& map) {
  bool ok = true;
  for (const auto& row : map.m) {
    for (const float entry : row) ok &= std::isfinite(entry);
  }
  return ok;
}

template <class T>
std::string number_fault(const char* name, std::span<const T> items) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!is_number(items[i])) return std::string(name) + ": number " + number(i) + " is not finite";
  }
  return {};
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

std::string check_scalars(const ModelView& m) {
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

std::string check_clips(const ModelView& m) {
  std::uint64_t name_bytes = 0;
  for (std::size_t i = 0; i < m.clips.size(); ++i) {
    if (!is_utf8(m.clips[i].name))
      return "clips: clip " + number(i) + " has a name that is not UTF-8";
    name_bytes += m.clips[i].name.size();
  }
  if (name_bytes > kMaxLinks) return "clips: their names take more than 4 GiB";
  return clip_fault(m.clips, m.key_times);
}

std::string check_triangles(const ModelView& m) {
  for (std::size_t t = 0; t < m.source_triangles.size(); ++t) {
    if (m.source_triangles[t] >= m.triangles.size()) {
      return "source_triangles: triangle " + number(t) + " comes from one that does not exist";
    }
  }
  return triangle_fault(m.triangles, m.vertex_count);
}

std::string check_segments(const ModelView& m) {
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

std::string check_clusters(const ModelView& m) {
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

std::string check_tree_ranges(const ModelView& m) {
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

std::string check_trees(const ModelView& m) {
  for (std::size_t i = 0; i < m.fuzzy_trees.size(); ++i) {
    const Cluster& c = m.clusters[i % m.clusters.size()];
    const std::string fault = validate(m.tree_view(m.fuzzy_trees[i]), c.first_triangle,
                                       c.first_triangle + c.triangle_count);
    if (!fault.empty()) return "kd_nodes: tree " + number(i) + " is malformed: " + fault;
  }
  return {};
}

template <class Box>
std::string box_fault(const char* name, std::span<const Box> boxes, const char* kind) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!is_box(boxes[i])) return std::string(name) + ": number " + number(i) + " is not " + kind;
  }
  return {};
}

std::string check_boxes_and_maps(const ModelView& m) {
  for (std::size_t i = 0; i < m.local_from_world.size(); ++i) {
    if (!is_number(m.local_from_world[i]))
      return "local_from_world: map " + number(i) + " is not finite";
  }
  return first_of({box_fault("fuzzy_boxes", m.fuzzy_boxes, "a box"),
                   box_fault("key_boxes", m.key_boxes, "a finite box"),
                   box_fault("cluster_world_boxes", m.cluster_world_boxes, "a box")});
}

/// Whether `first` cuts a list of `size` into consecutive runs of at least `min` items.
std::string run_fault(const char* name, std::span<const std::uint32_t> first, std::uint64_t size,
                      std::uint32_t min) {
  const std::string where = std::string(name) + ": ";
  if (first.empty() || first.front() != 0 || first.back() != size)
    return where + "the runs do not cover their list";
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    if (first[i + 1] < first[i] || first[i + 1] - first[i] < min)
      return where + "run " + number(i) + " ends too early";
  }
  return {};
}

std::string check_rig_links(const RigView& rig, std::uint64_t keys) {
  if (std::string fault = run_fault("first_weight", rig.first_weight, rig.bone_weights.size(), 1);
      !fault.empty())
    return fault;
  const std::uint64_t bones = rig.bone_maps.size() / keys;
  for (std::size_t i = 0; i < rig.bone_weights.size(); ++i) {
    if (rig.bone_weights[i].bone >= bones)
      return "bone_weights: number " + number(i) + " names bone " +
             number(rig.bone_weights[i].bone) + " of " + number(bones);
  }
  if (rig.first_offset.empty()) return count_fault("morph_offsets", rig.morph_offsets.size(), 0);
  if (std::string fault = run_fault("first_offset", rig.first_offset, rig.morph_offsets.size(), 0);
      !fault.empty())
    return fault;
  const std::uint64_t targets = rig.target_weights.size() / keys;
  for (std::size_t i = 0; i < rig.morph_offsets.size(); ++i) {
    if (rig.morph_offsets[i].target >= targets)
      return "morph_offsets: number " + number(i) + " names target " +
             number(rig.morph_offsets[i].target) + " of " + number(targets);
  }
  return {};
}

std::string check_rig(const ModelView& m) {
  const RigView& rig = m.poses.rig;
  return first_of(
      {check_rig_links(rig, m.key_times.size()), number_fault("base_positions", rig.base_positions),
       number_fault("bone_weights", rig.bone_weights),
       number_fault("morph_offsets", rig.morph_offsets), number_fault("bone_maps", rig.bone_maps),
       number_fault("target_weights", rig.target_weights)});
}

std::string check_quantization_error(const QuantizedView& q) {
  const bool sound = std::isfinite(q.error[0].bound) && q.error[0].largest >= 0 &&
                     q.error[0].largest <= q.error[0].bound;
  return sound ? "" : "quantization_error: the largest error is not within its bound";
}

std::string check_quantized_block(const QuantizedBlock& block, std::uint64_t first_bit,
                                  std::size_t i) {
  const std::string name = "quantized_blocks: block " + number(i);
  for (const std::uint8_t bits : block.bits) {
    if (bits > kMaxCoordinateBits) return name + " has coordinates of more than 16 bits";
  }
  if (!is_number(block.step) || !is_number(block.world_from_local))
    return name + " has a number that is not finite";
  if (block.first_bit != first_bit) return name + " does not start where the last one ended";
  return {};
}

std::string check_quantized(const ModelView& m) {
  const QuantizedView& q = m.poses.quantized;
  if (std::string fault = first_of({check_quantization_error(q),
                                    run_fault("first_vertex", q.first_vertex, m.vertex_count, 1),
                                    number_fault("rest_positions", q.rest_positions)});
      !fault.empty())
    return fault;
  const std::uint64_t runs = q.first_vertex.size() - 1;
  const std::uint64_t room = 32 * std::uint64_t{q.words.size()};
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < q.blocks.size(); ++i) {
    if (std::string fault = check_quantized_block(q.blocks[i], bits, i); !fault.empty())
      return fault;
    const std::uint64_t vertices = q.first_vertex[i % runs + 1] - q.first_vertex[i % runs];
    bits = (bits + vertices * q.blocks[i].bits_per_vertex() + 31) / 32 * 32;
    if (bits > room) break;
  }
  return count_fault("quantized_words", q.words.size(), bits / 32 + 1);
}

std::string check_poses(const ModelView& m) {
  switch (m.poses.kind) {
    case PoseKind::kKeyPositions:
      return {};
    case PoseKind::kRig:
      return check_rig(m);
    case PoseKind::kQuantized:
      return check_quantized(m);
  }
  return "model: the kind of its poses is unknown";
}

std::string check_joints(const SkeletonView& s) {
  std::uint64_t next_name = 0;
  for (std::size_t j = 0; j < s.joints.size(); ++j) {
    const Joint& joint = s.joints[j];
    const std::string name = "joints: joint " + number(j);
    if (joint.parent != kNoParent && joint.parent >= j)
      return name + " does not stand after its parent";
    if (!(joint.limit >= 0 && joint.limit <= std::numbers::pi_v<float>))
      return name + " has a limit that is no angle from 0 to pi";
    if (joint.name_offset != next_name || joint.name_bytes > s.names.size() - next_name)
      return name + " has no name in joint_names";
    next_name += joint.name_bytes;
    if (!is_number(joint.parent_from_joint) || !is_number(joint.scale))
      return name + " has a rest transform that is not finite";
  }
  if (next_name != s.names.size()) return "joint_names: some belong to no joint";
  return {};
}

std::string check_skeleton(const ModelView& m) {
  const SkeletonView& s = m.skeleton;
  if (!s.joints.empty() && m.segments.size() != 1)
    return "segments: more than one, though the skeleton needs one";
  if (!s.joints.empty() && !m.holds_between_keys)
    return "model: its boxes hold at keys only, though there is a skeleton";
  if (const std::string fault = check_joints(s); !fault.empty()) return fault;
  for (std::size_t i = 0; i < s.bones.size(); ++i) {
    const std::string name = "bone_bindings: bone " + number(i);
    if (s.bones[i].joint >= s.joints.size()) return name + " hangs on a joint there is not";
    if (!is_number(s.bones[i].joint_from_base)) return name + " has a map that is not finite";
  }
  for (std::size_t c = 0; c < m.cluster_bones.size(); ++c) {
    const std::string name = "cluster_bones: cluster " + number(c);
    if (m.cluster_bones[c].bone >= s.bones.size()) return name + " follows a bone there is not";
    if (!is_number(m.cluster_bones[c].local_from_base))
      return name + " has a map that is not finite";
  }
  return {};
}

std::string check_appearance(const ModelView& m) {
  return appearance_fault(m.appearance, m.triangles.size());
}

}  // namespace

std::string find_inconsistency(const ModelView& model) {
  for (const auto check : {check_counts, check_scalars, check_clips, check_segments,
                           check_triangles, check_clusters, check_tree_ranges, check_trees,
                           check_boxes_and_maps, check_poses, check_skeleton, check_appearance}) {
    if (std::string fault = check(model); !fault.empty()) return fault;
  }
  return {};
}

}  // namespace mdk
