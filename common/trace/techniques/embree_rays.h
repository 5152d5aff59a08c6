// PeerRays: Embree's single rays, to measure ours against. Everything of Embree stays in the .cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"
#include "mdk/ray_query.h"

namespace mdk {

/// A model in Embree: in motion, every key a time step, or at one moment.
class PeerRays {
 public:
  /// Where a time stands: the scene that holds it, and the time there.
  struct Time {
    std::uint32_t scene = 0;
    float time = 0;
  };

  virtual ~PeerRays() = default;
  virtual Time at(const KeyInterval& time) const = 0;
  /// As RayQuery's; the ray must have a direction. Safe to call from many threads at once.
  virtual QueryHit trace(const QueryRay& ray, const Time& time, RayAim aim) const = 0;
  /// Memory of hierarchies and vertices, and what building them took.
  virtual std::size_t bytes() const = 0;
  virtual double build_ms() const = 0;
};

enum class PeerMode { kRobust, kPlain };

/// With motion blur; with `moment`, still. Null where the program was built without Embree. Throws
/// Error (kOverLimit) where memory does not suffice. Runs in parallel.
std::unique_ptr<PeerRays> make_embree_rays(const ModelView& model, PeerMode mode,
                                           const std::optional<KeyInterval>& moment = {});

}  // namespace mdk
