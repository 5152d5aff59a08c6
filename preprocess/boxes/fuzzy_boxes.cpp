#include "preprocess/boxes/fuzzy_boxes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/math/affine3.h"

namespace mdk {
namespace {

constexpr std::uint32_t kSlotsPerChunk = 512;

/// Half a unit in the last place, relative; a little more, so that second-order terms are covered.
constexpr double kFloatRounding = 0x1.01p-24;
/// Rounding of the maps' interpolation and of these computations, relative to |A| |v|; generous,
/// since it is nothing beside float's.
constexpr double kDoubleRounding = 0x1p-30;
constexpr double kSmallest = std::numeric_limits<float>::denorm_min();

/// Largest error of one coordinate of a vertex that is interpolated in float.
double lerp_error(double v0, double v1) {
  return kFloatRounding * (2 * std::abs(v1 - v0) + std::max(std::abs(v0), std::abs(v1))) +
         2 * kSmallest;
}

Vec3d lerp_error(const Vec3d& v0, const Vec3d& v1) {
  return {lerp_error(v0.x, v1.x), lerp_error(v0.y, v1.y), lerp_error(v0.z, v1.z)};
}

Vec3d largest_sizes(const Vec3d& a, const Vec3d& b) {
  return {std::max(std::abs(a.x), std::abs(b.x)), std::max(std::abs(a.y), std::abs(b.y)),
          std::max(std::abs(a.z), std::abs(b.z))};
}

/// |A| of the entrywise larger of two maps.
Affine3d largest_entries(const Affine3d& a, const Affine3d& b) {
  Affine3d r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) r.m[i][j] = std::max(std::abs(a.m[i][j]), std::abs(b.m[i][j]));
  return r;
}

void extend_padded(Aabbd& box, const Vec3d& p, const Vec3d& pad) {
  box.extend(p - pad);
  box.extend(p + pad);
}

/// |entries| of the linear part of `a`, kept where they are larger than before.
void raise_sizes(Affine3d& sizes, const Affine3d& a, double factor) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      sizes.m[i][j] = std::max(sizes.m[i][j], std::abs(a.m[i][j]) * factor);
}

Affine3d zero_map() {
  Affine3d a;
  for (auto& row : a.m) std::fill(row, row + 4, 0.0);
  return a;
}

/// a + b f, entry by entry
void add_scaled(Affine3d& a, const Affine3d& b, double f) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) a.m[i][j] += b.m[i][j] * f;
}

/// u -> (det(u, y, z), det(x, u, z), det(x, y, u)) for u = v - origin, where in each determinant
/// the two remaining columns come one from `a` and one from `b`, both ways added.
Affine3d cramer_map(const Affine3d& a, const Affine3d& b, const Vec3d& origin) {
  Affine3d r;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Vec3d row = cross(a.column(j), b.column(k)) + cross(b.column(j), a.column(k));
    r.m[i][0] = row.x;
    r.m[i][1] = row.y;
    r.m[i][2] = row.z;
    r.m[i][3] = -dot(row, origin);
  }
  return r;
}

/// The four control points of a piece of an interval as functions of a vertex's positions at the
/// piece's ends: from0[i] v0 + from1[i] v1.
struct ControlMaps {
  Affine3d from0[4], from1[4];
  Affine3d sizes = zero_map();  ///< no entry of any map in between is larger

  /// The inverse of mix(x0, x1, s), s in [0, 1].
  static ControlMaps of_inverse(const Affine3d& x0, const Affine3d& x1) {
    const DeterminantBounds bounds(x0, x1);
    const Vec3d o0 = x0.column(3), o1 = x1.column(3);
    ControlMaps maps;
    maps.clear();
    add_scaled(maps.from0[0], cramer_map(x0, x0, o0), 0.5 / bounds.d[0]);
    add_scaled(maps.from0[1], cramer_map(x0, x1, o0), 1 / (3 * bounds.d[1]));
    add_scaled(maps.from1[1], cramer_map(x0, x0, o1), 0.5 / (3 * bounds.d[1]));
    add_scaled(maps.from0[2], cramer_map(x1, x1, o0), 0.5 / (3 * bounds.d[2]));
    add_scaled(maps.from1[2], cramer_map(x0, x1, o1), 1 / (3 * bounds.d[2]));
    add_scaled(maps.from1[3], cramer_map(x1, x1, o1), 0.5 / bounds.d[3]);
    // The inverse is the adjugate over the determinant; both lie in the hull of their coefficients.
    const double least = std::min(std::abs(bounds.min()), std::abs(bounds.max()));
    for (const Vec3d& o : {o0, o1}) {
      raise_sizes(maps.sizes, cramer_map(x0, x0, o), 0.5 / least);
      raise_sizes(maps.sizes, cramer_map(x0, x1, o), 0.5 / least);
      raise_sizes(maps.sizes, cramer_map(x1, x1, o), 0.5 / least);
    }
    return maps;
  }

  /// A curve that is quadratic: its middle control point, q = 2 p(1/2) - (p(0) + p(1)) / 2, follows
  /// from the map half-way, and (p(0) + 2 q) / 3, (2 q + p(1)) / 3 are those of the same curve as a
  /// cubic.
  static ControlMaps of_quadratic(const AffinePath& path) {
    const Affine3d half = path.at(0.5f);
    ControlMaps maps;
    maps.clear();
    add_scaled(maps.from0[0], path.from(), 1);
    add_scaled(maps.from0[1], half, 2.0 / 3);
    add_scaled(maps.from1[1], half, 2.0 / 3);
    add_scaled(maps.from1[1], path.to(), -1.0 / 3);
    add_scaled(maps.from0[2], half, 2.0 / 3);
    add_scaled(maps.from0[2], path.from(), -1.0 / 3);
    add_scaled(maps.from1[2], half, 2.0 / 3);
    add_scaled(maps.from1[3], path.to(), 1);
    for (const Affine3d& a : {path.from(), half, path.to()}) raise_sizes(maps.sizes, a, 1);
    return maps;
  }

 private:
  void clear() {
    for (int i = 0; i < 4; ++i) from0[i] = from1[i] = zero_map();
  }
};

/// Boxes of some vertices of one cluster, grown key by key.
class SlotBoxes {
 public:
  SlotBoxes(std::span<const std::uint32_t> vertices, std::span<Aabbd> boxes)
      : vertices_(vertices), boxes_(boxes) {}

  /// The positions at one key, which are exact but for the rounding of doubles.
  void add_key(std::span<const Vec3f> pose, const Affine3d& map) {
    const Affine3d sizes = largest_entries(map, map);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const Vec3d v = to_double(pose[vertices_[i]]);
      extend_padded(boxes_[i], map.point(v), sizes.point(largest_sizes(v, v)) * kDoubleRounding);
    }
  }

  /// All times from one key to the next.
  void add_interval(std::span<const Vec3f> pose0, std::span<const Vec3f> pose1,
                    const AffinePath& path) {
    const int pieces = path.rational_pieces();
    if (pieces == 0) add_piece(pose0, pose1, {0, 1}, ControlMaps::of_quadratic(path));
    for (int i = 0; i < pieces; ++i) {
      const double begin = static_cast<double>(i) / pieces,
                   end = static_cast<double>(i + 1) / pieces;
      add_piece(pose0, pose1, {begin, end},
                ControlMaps::of_inverse(mix(path.inverse_from(), path.inverse_to(), begin),
                                        mix(path.inverse_from(), path.inverse_to(), end)));
    }
  }

 private:
  struct Piece {
    double begin, end;  ///< of the interval, in [0, 1]
  };

  void add_piece(std::span<const Vec3f> pose0, std::span<const Vec3f> pose1, const Piece& piece,
                 const ControlMaps& maps) {
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      const Vec3d v0 = to_double(pose0[vertices_[i]]), v1 = to_double(pose1[vertices_[i]]);
      const Vec3d pad = maps.sizes.vector(lerp_error(v0, v1)) +
                        maps.sizes.point(largest_sizes(v0, v1)) * kDoubleRounding;
      const Vec3d begin = v0 + (v1 - v0) * piece.begin, end = v0 + (v1 - v0) * piece.end;
      for (int k = 0; k < 4; ++k)
        extend_padded(boxes_[i], maps.from0[k].point(begin) + maps.from1[k].point(end), pad);
    }
  }

  std::span<const std::uint32_t> vertices_;
  std::span<Aabbd> boxes_;
};

/// Runs of slots that lie in one cluster each.
struct SlotRun {
  std::uint32_t cluster, begin, end;
};

std::vector<SlotRun> split_slots(const ClusterMembers& members) {
  std::vector<SlotRun> runs;
  for (std::uint32_t c = 0; c < members.cluster_count(); ++c)
    for (std::uint32_t s = members.vertex_begin[c]; s < members.vertex_begin[c + 1];
         s += kSlotsPerChunk)
      runs.push_back({c, s, std::min(s + kSlotsPerChunk, members.vertex_begin[c + 1])});
  return runs;
}

/// What the boxes of one segment are made from.
struct Motion {
  const PoseSequence& sequence;
  std::span<const Affine3f> local_from_world;
  std::size_t clusters;
  std::vector<Clip> clips;  ///< the parts of the clips that lie in the segment
  BetweenKeys between;
};

std::vector<Clip> clips_within(std::span<const Clip> clips, const Segment& keys) {
  std::vector<Clip> parts;
  for (const Clip& clip : clips) {
    const std::uint32_t first = std::max(clip.first_key, keys.first_key);
    const std::uint32_t last = std::min(clip.first_key + clip.key_count - 1, keys.last_key);
    if (first <= last) parts.push_back({{}, first, last - first + 1});
  }
  return parts;
}

void fill_run(const Motion& motion, const SlotRun& run, SlotBoxes boxes) {
  const PoseSequence& sequence = motion.sequence;
  const auto map_at = [&](std::uint32_t key) -> const Affine3f& {
    return motion.local_from_world[key * motion.clusters + run.cluster];
  };
  for (const Clip& clip : motion.clips) {
    boxes.add_key(sequence.pose(clip.first_key), to_double(map_at(clip.first_key)));
    for (std::uint32_t key = clip.first_key + 1; key < clip.first_key + clip.key_count; ++key) {
      if (motion.between == BetweenKeys::kBound)
        boxes.add_interval(sequence.pose(key - 1), sequence.pose(key),
                           AffinePath(map_at(key - 1), map_at(key)));
      else
        boxes.add_key(sequence.pose(key), to_double(map_at(key)));
    }
  }
}

/// Box of a triangle from those of its vertices, which stand from slot `first` on.
Aabbd box_of_corners(std::span<const Aabbd> vertices, std::span<const std::uint32_t> slots,
                     std::uint32_t first) {
  Aabbd box;
  for (const std::uint32_t slot : slots) box.extend(vertices[slot - first]);
  return box;
}

/// Box of a cluster's vertices at one key and the largest rounding errors of the interval that ends
/// there (nothing at a clip's first key).
struct WorldExtent {
  Aabbd box;
  Vec3d error;
};

WorldExtent world_extent(const PoseSequence& sequence, std::span<const std::uint32_t> vertices,
                         std::uint32_t key, std::uint32_t previous) {
  const std::span<const Vec3f> now = sequence.pose(key), before = sequence.pose(previous);
  WorldExtent extent;
  for (const std::uint32_t v : vertices) {
    const Vec3d p = to_double(now[v]);
    extent.box.extend(p);
    if (previous != key)
      extent.error = largest_sizes(extent.error, lerp_error(to_double(before[v]), p));
  }
  return extent;
}

}  // namespace

std::vector<Aabb> fuzzy_boxes(const PoseSequence& sequence, const ClusterMembers& members,
                              std::span<const Affine3f> local_from_world, const Segment& keys,
                              BetweenKeys between) {
  const Motion motion{sequence, local_from_world, members.cluster_count(),
                      clips_within(sequence.clips, keys), between};
  std::vector<Aabbd> slots(members.vertices.size());
  const std::vector<SlotRun> runs = split_slots(members);
  parallel_chunks(runs.size(), 1, [&](std::size_t i, std::size_t) {
    const std::size_t count = runs[i].end - runs[i].begin;
    fill_run(motion, runs[i],
             {std::span(members.vertices).subspan(runs[i].begin, count),
              std::span(slots).subspan(runs[i].begin, count)});
  });
  std::vector<Aabb> boxes(members.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    boxes[t] =
        round_outward(box_of_corners(slots, std::span(members.corner_slots).subspan(3 * t, 3), 0));
  return boxes;
}

std::vector<Aabb> pose_space_boxes(const PoseSpace& space, const ClusterMembers& members,
                                   std::span<const ClusterBone> bones) {
  std::vector<Aabb> boxes(members.triangles.size());
  parallel_chunks(bones.size(), 1, [&](std::size_t c, std::size_t) {
    BoneSpace seen(space, bones[c].bone);
    if (!seen.is_usable())
      throw Error(ErrorCode::kBadInput,
                  "bone " + std::to_string(bones[c].bone) +
                      " is flat or a point at rest, so nothing can be bounded in its basis: "
                      "repair its scale, or bake with --sampling cycle");
    std::vector<Aabbd> vertices;
    for (const std::uint32_t v : members.vertices_of(c))
      vertices.push_back(seen.vertex_box(v, to_double(bones[c].local_from_base)));
    const std::span<const std::uint32_t> slots = members.corner_slots_of(c);
    for (std::size_t i = 0; i < slots.size(); i += 3)
      boxes[members.triangle_begin[c] + i / 3] =
          round_outward(box_of_corners(vertices, slots.subspan(i, 3), members.vertex_begin[c]));
  });
  return boxes;
}

std::vector<Aabb> cluster_world_boxes(const PoseSequence& sequence, const ClusterMembers& members) {
  const std::size_t clusters = members.cluster_count(), keys = sequence.key_count();
  std::vector<WorldExtent> extents(keys * clusters);
  std::vector<std::uint32_t> previous(keys, 0);
  for (std::uint32_t key = 0; key < keys; ++key) previous[key] = key == 0 ? 0 : key - 1;
  for (const Clip& clip : sequence.clips) previous[clip.first_key] = clip.first_key;

  parallel_chunks(keys, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t key = begin; key < end; ++key)
      for (std::size_t c = 0; c < clusters; ++c)
        extents[key * clusters + c] = world_extent(sequence, members.vertices_of(c),
                                                   static_cast<std::uint32_t>(key), previous[key]);
  });

  std::vector<Aabb> boxes(extents.size());
  for (std::size_t key = 0; key < keys; ++key)
    for (std::size_t c = 0; c < clusters; ++c) {
      const WorldExtent& here = extents[key * clusters + c];
      Vec3d error = here.error;
      if (key + 1 < keys && previous[key + 1] == key)
        error = largest_sizes(error, extents[(key + 1) * clusters + c].error);
      // Once for the vertices; twice for the box's own interpolation, since its bound may come from
      // one vertex and its change from another.
      const Vec3d pad = error * (3 + 0x1p-10);
      boxes[key * clusters + c] = round_outward({here.box.lo - pad, here.box.hi + pad});
    }
  return boxes;
}

}  // namespace mdk
