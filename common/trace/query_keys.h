// What single rays need of a model's keys: key poses, decoded when first asked for, and the
// clusters' boxes and maps, laid out for one ray against many clusters. All serve any moment
// between keys.
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
/// each key that is held. Vertices stand in an order of the caller's, so that those that are used
/// together stand together. Where not all keys fit, each has a place while it is held; which one
/// gives way is chosen by going round (clock).
class KeyPoses {
 public:
  /// Vertex i of a pose is vertex order[i] of the model.
  KeyPoses(const ModelView& model, std::vector<std::uint32_t> order, std::size_t max_bytes);

  /// Positions of all vertices at that time, until release(); behind the last one, 4 bytes may be
  /// read. Cost: O(1), but decoding where a key is not there. A thread may hold one time.
  VertexSource acquire(const KeyInterval& at) const {
    const Vec3f* from = nullptr;
    const Vec3f* to = nullptr;
    if (places_ == nullptr) {
      from = keep(at.key0);
      to = keep(at.key1);
    } else {
      hold_both(at, from, to);
    }
    return {from, to, at.key0 == at.key1 ? 0.0f : at.s};
  }
  void release(const KeyInterval& at) const {
    if (places_ != nullptr) let_go_both(at);
  }
  /// Where each vertex of the model stands in a pose; of one that no block uses, 0. Cost: O(1), the
  /// first time O(vertices).
  const std::uint32_t* places() const {
    std::call_once(places_known_, [&] {
      place_of_.assign(model_->vertex_count, 0);
      for (std::size_t i = 0; i < order_.size(); ++i)
        place_of_[order_[i]] = static_cast<std::uint32_t>(i);
    });
    return place_of_.data();
  }
  /// What is decoded now, and the order.
  std::size_t bytes() const {
    return decoded_.load(std::memory_order_relaxed) + order_.size() * sizeof(std::uint32_t);
  }

 private:
  /// Of a key that stays.
  struct Kept {
    std::atomic<const Vec3f*> ready = nullptr;
    std::once_flag once;
    std::vector<Vec3f> positions;
  };
  /// Of keys that come and go.
  struct Place {
    std::atomic<std::uint32_t> holders = 0;  ///< and kBusy while the key changes
    std::atomic<std::uint32_t> key = kNoKey;
    std::atomic<bool> was_used = false;
    std::vector<Vec3f> positions;
  };
  static constexpr std::uint32_t kBusy = 0x80000000u, kNoKey = 0xffffffffu;

  const Vec3f* keep(std::uint32_t key) const {
    const Vec3f* positions = kept_[key].ready.load(std::memory_order_acquire);
    return positions != nullptr ? positions : decode(key);
  }
  const Vec3f* decode(std::uint32_t key) const;
  void make_room(std::vector<Vec3f>& positions) const;
  void decode_into(std::uint32_t key, std::vector<Vec3f>& positions) const;
  const Vec3f* hold(std::uint32_t key) const;
  const Vec3f* hold_if_there(std::uint32_t key) const;
  void let_go(std::uint32_t key) const;
  void hold_both(const KeyInterval& at, const Vec3f*& from, const Vec3f*& to) const;
  void let_go_both(const KeyInterval& at) const;

  const ModelView* model_;
  std::vector<std::uint32_t> order_;
  mutable std::once_flag places_known_;
  mutable std::vector<std::uint32_t> place_of_;
  mutable std::atomic<std::size_t> decoded_ = 0;
  std::unique_ptr<Kept[]> kept_;  ///< by key; none where keys come and go

  std::size_t place_count_ = 0;
  std::unique_ptr<Place[]> places_;                             ///< none where all keys stay
  std::unique_ptr<std::atomic<std::uint32_t>[]> place_of_key_;  ///< or place_count_
  mutable std::mutex changing_;
  mutable std::size_t next_place_ = 0;
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
