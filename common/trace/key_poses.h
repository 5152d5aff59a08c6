// KeyPoses: key poses of a model, each decoded when it is first asked for, and then kept.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

/// Safe to use from many threads at once; the model must outlive it. Memory: 12 bytes a vertex for
/// each key that was asked for; none where the model holds key positions, which are used in place.
class KeyPoses {
 public:
  explicit KeyPoses(const Model& model);

  /// Positions of all vertices at a key. Cost: O(1), but decoding the first time.
  const Vec3f* at(std::uint32_t key) const;

  std::size_t bytes() const;

 private:
  struct Slot {
    std::once_flag once;
    std::vector<Vec3f> positions;
  };

  const Model* model_;
  std::unique_ptr<Slot[]> slots_;  ///< by key; none where nothing is decoded
};

}  // namespace mdk
