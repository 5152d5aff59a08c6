// What single rays need of a model's keys: key poses, decoded when first asked for, and the clusters'
// boxes and maps, laid out for one ray against many clusters. All serve any moment between keys.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

/// Safe to use from many threads at once; the model must outlive it. Memory: 12 bytes a vertex for
/// each key that was asked for; where the model holds key positions, they are used in place, but
/// for the last key.
class KeyPoses {
 public:
  explicit KeyPoses(const ModelView& model);

  /// Positions of all vertices at a key; behind the last one, 4 bytes may be read. Cost: O(1), but
  /// decoding the first time.
  const Vec3f* key(std::uint32_t key) const {
    const Vec3f* positions = slots_[key].ready.load(std::memory_order_acquire);
    return positions != nullptr ? positions : decode(key);
  }
  /// What was decoded so far.
  std::size_t bytes() const { return decoded_.load(std::memory_order_relaxed); }

 private:
  struct Slot {
    std::atomic<const Vec3f*> ready = nullptr;
    std::once_flag once;
    std::vector<Vec3f> positions;
  };

  const Vec3f* decode(std::uint32_t key) const;

  const ModelView* model_;
  mutable std::atomic<std::size_t> decoded_ = 0;
  std::unique_ptr<Slot[]> slots_;  ///< by key
};

/// A hierarchy over the clusters' world boxes, with their boxes at every key: clusters that lie
/// near each other stand together, sixteen a node. Between keys a box is interpolated, which holds
/// the cluster but for rounding.
class TopTree {
 public:
  /// Cost: O(F K), and 24 bytes for each, K rounded up to sixteen.
  explicit TopTree(const ModelView& model);

  std::uint32_t nodes() const { return static_cast<std::uint32_t>(links_.size()); }
  std::uint32_t roots() const { return roots_; }
  const TopBoxes* boxes() const { return boxes_.data(); }
  const TopLinks* links() const { return links_.data(); }
  std::size_t bytes() const {
    return boxes_.size() * sizeof(TopBoxes) + links_.size() * sizeof(TopLinks);
  }

 private:
  std::uint32_t roots_ = 0;
  std::vector<TopLinks> links_;
  std::vector<TopBoxes> boxes_;
};

/// The clusters' maps at every key, as RayModel has them.
class KeyMaps {
 public:
  /// `local_bounds`: of each cluster, in its basis, at all times. Cost: O(F K).
  KeyMaps(const ModelView& model, const std::vector<Aabb>& local_bounds);

  const KeyMap* maps() const { return maps_.data(); }
  const std::uint8_t* kinds() const { return kinds_.data(); }
  const Vec3f* centers() const { return centers_.data(); }
  std::size_t bytes() const {
    return maps_.size() * sizeof(KeyMap) + kinds_.size() + centers_.size() * sizeof(Vec3f);
  }

 private:
  std::vector<KeyMap> maps_;
  std::vector<std::uint8_t> kinds_;
  std::vector<Vec3f> centers_;
};

}  // namespace mdk
