// The .mds file's bytes as types: its records (docs/scene-file.md). Which section holds which array
// is said with the arrays (common/scene/scene.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/motion/arrays.h"
#include "common/scene/scene.h"
#include "formats/files/sections.h"

namespace mdk::layout {

struct SceneRecord {
  std::uint32_t model_count = 0, instance_count = 0;
  double first_time = 0, last_time = 0;
  std::uint32_t reserved[10] = {};
};
static_assert(sizeof(SceneRecord) == 64);

struct ModelFileRecord {
  std::uint32_t name_offset = 0, name_bytes = 0;
  std::uint64_t content = 0;
};
static_assert(sizeof(ModelFileRecord) == 16);

static_assert(offsetof(SceneInstance, start) == 48 && offsetof(SceneInstance, speed) == 56 &&
              offsetof(SceneInstance, bits) == 60);
static_assert(offsetof(SceneLabel, mask) == 8 && offsetof(SceneLabel, tint) == 12 &&
              offsetof(SceneLabel, path) == 16);
static_assert(sizeof(ScenePath) == 12 && sizeof(SceneRole) == 8);
static_assert(offsetof(PathKey, translation) == 8 && offsetof(PathKey, rotation) == 20 &&
              offsetof(PathKey, scale) == 36);

inline constexpr std::uint32_t kScene = fourcc("SCNE");
inline constexpr std::uint32_t kModelFiles = fourcc("MFIL");
inline constexpr std::uint32_t kModelNames = fourcc("MNAM");

extern const FileFormat kMdsFormat;

}  // namespace mdk::layout
