// PoseTable: some keys of a sequence as the fitting kernels like them: one array per coordinate,
// each pose centred on its own mean, lengths in a unit of the model's size. Centring costs nothing
// (an affine map carries any translation) and keeps float exact enough wherever the model walks.
//
// The few keys that stand for all are a farthest-point sample in pose space (Gonzalez 1985), which
// finds the extreme poses that uniform subsampling walks past.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/scratch.h"
#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/simd/point_kernels.h"

namespace mdk {

/// Points side by side, one array per coordinate, as the kernels take them.
struct PointArrays {
  ScratchList<float> x, y, z;  ///< of a long sequence, where its positions stand

  PointArrays() = default;
  explicit PointArrays(const ScratchSpace& scratch) : x(scratch), y(scratch), z(scratch) {}

  void resize(std::size_t size) {
    for (ScratchList<float>* a : {&x, &y, &z}) a->resize(size, 0.0f);
  }
  void set(std::size_t i, const Vec3f& p) {
    x[i] = p.x;
    y[i] = p.y;
    z[i] = p.z;
  }
  Vec3d point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  PointRow from(std::size_t i) const { return {x.data() + i, y.data() + i, z.data() + i}; }
  /// Some of them.
  PointArrays part(std::size_t begin, std::size_t count) const;
};

/// R rows (keys), V vertices. Entry (row, vertex) stands at row * V + vertex.
struct PoseTable : PointArrays {
  std::uint32_t vertex_count = 0;
  double unit = 1;                  ///< world length of one table unit, a power of two
  std::vector<std::uint32_t> keys;  ///< R: the key each row shows
  std::vector<Vec3d> centers;       ///< R: world position of each row's origin

  std::uint32_t row_count() const { return static_cast<std::uint32_t>(keys.size()); }
  std::size_t row_offset(std::uint32_t row) const {
    return static_cast<std::size_t>(row) * vertex_count;
  }
  Vec3d position(std::uint32_t row, std::uint32_t vertex) const {
    return point(row_offset(row) + vertex);
  }
};

/// What clustering looks at. Refers to its parts, which must outlive it.
struct MovingMesh {
  const PoseTable& poses;
  std::span<const Triangle> triangles;

  ClusterMembers members_of(const Assignment& assignment) const {
    return make_cluster_members(triangles, assignment, poses.vertex_count);
  }
};

/// Box of one pose; empty without vertices.
Aabbd pose_box(std::span<const Vec3f> pose);

/// Area of the box of each pose. Cost: O(vertices * keys).
std::vector<double> pose_box_areas(const PoseSequence& sequence);

/// The same of each row, table units. Cost: O(rows * vertices).
std::vector<double> row_box_areas(const PoseTable& table);

/// The power of two next above the largest extent of any pose (1 where all poses are points).
/// Cost: O(vertices * keys).
double pose_unit(const PoseSequence& sequence);

/// `count` keys, rising; all if there are no more, fewer where the other poses repeat these. The
/// distance of two poses is the squared distance of their vertices, each pose centred. Starts with
/// the key farthest from the mean pose. Looks at 2,048 vertices, evenly spread over the list.
/// Cost: O(keys * count * vertices looked at).
std::vector<std::uint32_t> sample_keys(const PoseSequence& sequence, std::size_t count);

/// Rows in the order of `keys`. Cost: O(rows * vertices).
PoseTable make_pose_table(const PoseSequence& sequence, std::span<const std::uint32_t> keys,
                          double unit);

/// A table of up to `count` sampled keys and of `also`.
PoseTable sample_poses(const PoseSequence& sequence, std::size_t count,
                       std::span<const std::uint32_t> also, double unit);

/// The chosen vertices of all rows, row by row.
PointArrays gather_vertices(const PoseTable& table, std::span<const std::uint32_t> vertices);

/// The row that shows `key`; there must be one.
std::uint32_t row_of_key(const PoseTable& table, std::uint32_t key);

/// A map from table coordinates of `row`, both sides in table units, as a map from the world with
/// lengths in world units on both sides; the origin on the far side stays where it is.
Affine3d world_map(const PoseTable& table, std::uint32_t row, const Affine3d& from_row);

}  // namespace mdk
