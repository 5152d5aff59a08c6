// PoseSequence: one fixed triangle list and key poses of its vertices (docs/method.md, words).
// What readers make and what the decomposition takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/math/vec3.h"
#include "common/motion/appearance.h"
#include "common/motion/rig.h"
#include "common/motion/skeleton.h"

namespace mdk {

struct Triangle {
  std::uint32_t v[3] = {0, 0, 0};  ///< vertex indices, counter-clockwise seen from outside

  bool operator==(const Triangle&) const = default;
};

/// A run of keys that are played together. Poses are interpolated between the keys of one clip,
/// never from one clip to the next.
struct Clip {
  std::string name;
  std::uint32_t first_key = 0;
  std::uint32_t key_count = 0;  ///< at least one

  bool operator==(const Clip&) const = default;
};

struct PoseSequence {
  std::uint32_t vertex_count = 0;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> triangle_meshes;  ///< per triangle, the mesh of the source it is of,
                                               ///< from 0 without gaps; empty where there is one
  std::vector<Clip> clips;                     ///< contiguous, in key order, covering every key
  std::vector<double> key_times;  ///< per key: seconds from its clip's start, rising within a clip
  std::vector<Vec3f> positions;   ///< key-major: vertex i at key k stands at k * vertex_count + i
  std::optional<Rig> rig;         ///< what the positions were decoded from, bit for bit
  std::optional<Skeleton> skeleton;  ///< what the rig's bones hang on
  Appearance appearance;

  std::uint32_t key_count() const { return static_cast<std::uint32_t>(key_times.size()); }
  std::span<const Vec3f> pose(std::uint32_t key) const {
    return {positions.data() + static_cast<std::size_t>(key) * vertex_count, vertex_count};
  }
  std::span<Vec3f> pose(std::uint32_t key) {
    return {positions.data() + static_cast<std::size_t>(key) * vertex_count, vertex_count};
  }
};

/// Drops vertices no triangle uses and joins vertices that have the same path through all keys and
/// the same `smoothing_group`; keeps the order of first use. Triangles keep their corners' order,
/// so corner attributes stay valid. `smoothing_groups`: one per vertex, or empty for "all alike".
/// With a rig, the same path is one computed from the same numbers, and positions may still be
/// missing. Cost: O(vertices * keys), with a rig O(vertices log vertices).
void weld_vertices(PoseSequence& sequence, std::span<const std::uint64_t> smoothing_groups);

/// Keeps the vertices `kept`, in that order, and renumbers the triangles, all of whose corners must
/// be kept. No vertex may stand in `kept` twice. Cost: O(kept * keys).
void select_vertices(PoseSequence& sequence, std::span<const std::uint32_t> kept);

/// Decodes the positions of a sequence that has a rig.
void decode_positions(PoseSequence& sequence);

/// Throws std::logic_error where the parts do not fit together (a reader's bug, never a user's).
void check_consistency(const PoseSequence& sequence);

}  // namespace mdk
