// Scenes: many instances of models, each with a place, a clip and a time of its own.
#pragma once

#include <cstdint>
#include <limits>

#include "mdk/geometry.h"
#include "mdk/model.h"

namespace mdk {

/// What becomes of a path before its first key and after its last one.
enum class PathEnds : std::uint32_t {
  kHold = 0,  ///< the instance stays where the path begins or ends
  kHide = 1,  ///< it is not there
  kLoop = 2,  ///< the path is run through again and again
};

constexpr std::uint32_t kNoInstance = 0xFFFFFFFF;

/// What a ray hit in a scene: kNoInstance, kNoTriangle (both 0xFFFFFFFF) and an infinite t for
/// nothing.
struct SceneHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t instance = kNoInstance;
  std::uint32_t triangle = 0xFFFFFFFF;  ///< of the instance's model
  float bary1 = 0, bary2 = 0;           ///< barycentric coordinates of corners 1 and 2
  std::int64_t id = 0;                  ///< the user's number of the instance

  bool is_hit() const { return instance != kNoInstance; }
};

}  // namespace mdk
