// PoseTable: some keys of a sequence as the fitting kernels like them: one array per coordinate,
// each pose centred on its own mean, lengths in a unit of the model's size. Centring costs nothing
// (an affine map carries any translation) and keeps float exact enough wherever the model walks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

/// R rows (keys), V vertices. Entry (row, vertex) stands at row * V + vertex.
struct PoseTable {
  std::uint32_t vertex_count = 0;
  double unit = 1;                  ///< world length of one table unit, a power of two
  std::vector<std::uint32_t> keys;  ///< R: the key each row shows
  std::vector<Vec3d> centers;       ///< R: world position of each row's origin
  std::vector<float> x, y, z;       ///< R * V

  std::uint32_t row_count() const { return static_cast<std::uint32_t>(keys.size()); }
  std::size_t row_offset(std::uint32_t row) const {
    return static_cast<std::size_t>(row) * vertex_count;
  }
  Vec3d position(std::uint32_t row, std::uint32_t vertex) const {
    const std::size_t i = row_offset(row) + vertex;
    return {x[i], y[i], z[i]};
  }
};

/// The power of two next above the largest extent of any pose (1 where all poses are points).
/// Cost: O(vertices * keys).
double pose_unit(const PoseSequence& sequence);

/// Rows in the order of `keys`. Cost: O(rows * vertices).
PoseTable make_pose_table(const PoseSequence& sequence, std::span<const std::uint32_t> keys,
                          double unit);

/// The row that shows `key`; there must be one.
std::uint32_t row_of_key(const PoseTable& table, std::uint32_t key);

/// A map from table coordinates of `row`, both sides in table units, as a map from the world with
/// lengths in world units on both sides; the origin on the far side stays where it is.
Affine3d world_map(const PoseTable& table, std::uint32_t row, const Affine3d& from_row);

}  // namespace mdk
