// PoseSource: what a model's key poses are computed from, as spans; PoseStorage owns the same. A
// model has one kind of source, and its decoded key poses are *the* poses: boxes bound them,
// between two keys vertices move on straight lines (common/motion/posed_mesh.h). Decoding gives the
// same bits on every machine.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vec3.h"
#include "common/motion/quantized_poses.h"
#include "common/motion/rig.h"

namespace mdk {

enum class PoseKind : std::uint32_t {
  kKeyPositions = 0,  ///< every vertex at every key
  kRig = 1,           ///< bones and morph targets
  kQuantized = 2,     ///< key positions with few bits, not quite what was read
};

/// F keys, V vertices. Lists of other kinds than `kind` are empty.
struct PoseSource {
  PoseKind kind = PoseKind::kKeyPositions;
  std::span<const Vec3f> key_positions;  ///< F * V, key-major, world space
  RigView rig;
  QuantizedView quantized;
};

struct PoseStorage {
  PoseKind kind = PoseKind::kKeyPositions;
  std::vector<Vec3f> key_positions;
  Rig rig;
  QuantizedPoses quantized;

  /// Valid while this lives and is not changed.
  PoseSource view() const { return {kind, key_positions, rig.view(), quantized.view()}; }
};

}  // namespace mdk
