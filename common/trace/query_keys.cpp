#include "common/trace/query_keys.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <thread>
#include <utility>

#include "common/base/parallel.h"

namespace mdk {

KeyPoses::KeyPoses(const ModelView& model, std::vector<std::uint32_t> order, std::size_t max_bytes)
    : model_(&model), order_(std::move(order)) {
  const std::uint32_t keys = model.key_count();
  const std::size_t most = max_bytes / ((order_.size() + 1) * sizeof(Vec3f));
  if (most >= keys) {
    kept_ = std::make_unique<Kept[]>(keys);
    return;
  }
  place_count_ = std::max(most, 2 * static_cast<std::size_t>(thread_count()));
  places_ = std::make_unique<Place[]>(place_count_);
  place_of_key_ = std::make_unique<std::atomic<std::uint32_t>[]>(keys);
  for (std::uint32_t key = 0; key < keys; ++key)
    place_of_key_[key] = static_cast<std::uint32_t>(place_count_);
}

void KeyPoses::make_room(std::vector<Vec3f>& positions) const {
  if (!positions.empty()) return;
  positions.resize(order_.size() + 1);
  decoded_.fetch_add(positions.size() * sizeof(Vec3f), std::memory_order_relaxed);
}

void KeyPoses::decode_into(std::uint32_t key, std::vector<Vec3f>& positions) const {
  const bool has_positions = model_->poses.kind == PoseKind::kKeyPositions;
  std::vector<Vec3f> decoded(has_positions ? 0 : model_->vertex_count);
  const Vec3f* all = decoded.data();
  if (has_positions) {
    all = model_->poses.key_positions.data() + std::size_t{key} * model_->vertex_count;
  } else {
    decode_pose(*model_, key, {0, model_->vertex_count}, decoded);
  }
  for (std::size_t i = 0; i < order_.size(); ++i) positions[i] = all[order_[i]];
}

const Vec3f* KeyPoses::decode(std::uint32_t key) const {
  Kept& kept = kept_[key];
  // In one thread: a parallel loop in here might pick up a ray that waits for this very key.
  std::call_once(kept.once, [&] {
    make_room(kept.positions);
    decode_into(key, kept.positions);
    kept.ready.store(kept.positions.data(), std::memory_order_release);
  });
  return kept.positions.data();
}

/// Null where the key has no place, or is about to lose it.
const Vec3f* KeyPoses::hold_if_there(std::uint32_t key) const {
  const std::uint32_t at = place_of_key_[key].load(std::memory_order_acquire);
  if (at == place_count_) return nullptr;
  Place& place = places_[at];
  const std::uint32_t holders = place.holders.fetch_add(1, std::memory_order_acq_rel);
  if ((holders & kBusy) == 0 && place.key.load(std::memory_order_acquire) == key) {
    place.was_used.store(true, std::memory_order_relaxed);
    return place.positions.data();
  }
  place.holders.fetch_sub(1, std::memory_order_acq_rel);
  return nullptr;
}

/// Null where every place is held.
const Vec3f* KeyPoses::hold(std::uint32_t key) const {
  if (const Vec3f* positions = hold_if_there(key)) return positions;
  const std::lock_guard lock(changing_);
  if (const Vec3f* positions = hold_if_there(key)) return positions;
  for (std::size_t turn = 0; turn < 2 * place_count_; ++turn) {
    const std::size_t at = next_place_;
    next_place_ = (next_place_ + 1) % place_count_;
    Place& place = places_[at];
    make_room(place.positions);
    std::uint32_t none = 0;
    if (place.was_used.exchange(false, std::memory_order_relaxed) ||
        !place.holders.compare_exchange_strong(none, kBusy, std::memory_order_acq_rel))
      continue;
    const std::uint32_t old = place.key.exchange(kNoKey);
    if (old != kNoKey)
      place_of_key_[old].store(static_cast<std::uint32_t>(place_count_), std::memory_order_release);
    decode_into(key, place.positions);
    place.key.store(key, std::memory_order_release);
    place_of_key_[key].store(static_cast<std::uint32_t>(at), std::memory_order_release);
    place.was_used.store(true, std::memory_order_relaxed);
    place.holders.fetch_sub(kBusy - 1, std::memory_order_acq_rel);  // held once, by the caller
    return place.positions.data();
  }
  return nullptr;
}

void KeyPoses::let_go(std::uint32_t key) const {
  // It keeps its place while it is held.
  places_[place_of_key_[key].load(std::memory_order_acquire)].holders.fetch_sub(
      1, std::memory_order_acq_rel);
}

void KeyPoses::hold_both(const KeyInterval& at, const Vec3f*& from, const Vec3f*& to) const {
  for (;;) {
    from = hold(at.key0);
    to = at.key1 == at.key0 ? from : from == nullptr ? nullptr : hold(at.key1);
    if (to != nullptr) return;
    // Whoever waits holds nothing, so that others can go on.
    if (from != nullptr) let_go(at.key0);
    std::this_thread::yield();
  }
}

void KeyPoses::let_go_both(const KeyInterval& at) const {
  let_go(at.key0);
  if (at.key1 != at.key0) let_go(at.key1);
}

namespace {

/// Puts boxes that lie near each other side by side, so that runs of sixteen are compact.
void sort_by_place(std::span<std::uint32_t> boxes, std::span<const Vec3d> centers) {
  if (boxes.size() <= kTopWidth) return;
  Aabbd around;
  for (const std::uint32_t box : boxes) around.extend(centers[box]);
  const Vec3d e = around.extent();
  const std::size_t axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  const std::size_t runs = (boxes.size() + kTopWidth - 1) / kTopWidth;
  const std::size_t half = (runs + 1) / 2 * kTopWidth;
  std::nth_element(boxes.begin(), boxes.begin() + static_cast<std::ptrdiff_t>(half), boxes.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double at_a = centers[a][axis], at_b = centers[b][axis];
                     return at_a < at_b || (at_a == at_b && a < b);
                   });
  sort_by_place(boxes.first(half), centers);
  sort_by_place(boxes.subspan(half), centers);
}

void set_column(TopBoxes& boxes, std::size_t column, const Aabb& box) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    boxes.bounds[2 * axis][column] = box.lo[axis];
    boxes.bounds[2 * axis + 1][column] = box.hi[axis];
  }
}

Aabb union_of(const TopBoxes& boxes, std::uint32_t count) {
  Aabb all;
  for (std::uint32_t c = 0; c < count; ++c)
    all.extend(Aabb{{boxes.bounds[0][c], boxes.bounds[2][c], boxes.bounds[4][c]},
                    {boxes.bounds[1][c], boxes.bounds[3][c], boxes.bounds[5][c]}});
  return all;
}

}  // namespace

TopTree::TopTree(const ModelView& model) {
  std::vector<std::uint32_t> order;
  std::vector<Vec3d> centers(model.cluster_count());
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    if (model.clusters[c].triangle_count > 0) order.push_back(c);
    for (std::uint32_t key = 0; key < model.key_count(); ++key) {
      const Aabb box = model.world_box(key, c);
      centers[c] += to_double(box.lo) + to_double(box.hi);
    }
  }
  sort_by_place(order, centers);
  // Level by level: what is below a node stands in a run of sixteen.
  std::vector<WideBvhChild> level;
  for (const std::uint32_t c : order) level.push_back(WideBvhChild::leaf(c));
  do {
    std::vector<WideBvhChild> above;
    for (std::size_t first = 0; first < level.size(); first += kTopWidth) {
      TopLinks& links = links_.emplace_back();
      links.count = static_cast<std::uint32_t>(std::min(kTopWidth, level.size() - first));
      for (std::size_t c = 0; c < kTopWidth; ++c)
        links.child[c] = level[first + (c < links.count ? c : 0)];
      above.push_back(WideBvhChild::inner(nodes() - 1));
    }
    level = std::move(above);
    roots_ = static_cast<std::uint32_t>(level.size());
  } while (level.size() > 2);  // two roots cost no more than one above them

  boxes_.resize(std::size_t{nodes()} * model.key_count());
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    TopBoxes* const boxes = &boxes_[std::size_t{nodes()} * key];
    for (std::uint32_t n = 0; n < nodes(); ++n) {
      for (std::uint32_t c = 0; c < kTopWidth; ++c) {
        const WideBvhChild child = links_[n].child[c];
        set_column(boxes[n], c,
                   child.is_leaf() ? model.world_box(key, child.index())
                                   : union_of(boxes[child.index()], links_[child.index()].count));
      }
    }
  }
}

KeyMaps::KeyMaps(const ModelView& model, const std::vector<Aabb>& local_bounds)
    : maps_(model.local_from_world.size()), kinds_(model.local_from_world.size()) {
  const std::size_t clusters = model.cluster_count();
  for (const Aabb& bounds : local_bounds)
    centers_.push_back(bounds.empty() ? Vec3f{} : bounds.center());
  const Vec3d center = to_double(model.bounds.center());
  const double allowed = static_cast<double>(diagonal(model.bounds)) * 0x1p-22;

  // Sets the map of a key, and tells whether it is regular there.
  const auto set_map = [&](std::size_t at, std::size_t c) {
    const Affine3d local = to_double(model.local_from_world[at]);
    if (!(std::abs(local.determinant()) > 0)) return false;
    const Affine3d world = inverse(local);
    const Vec3d origin = to_double(centers_[c]);
    const Vec3d shift = world.point(origin) - center;
    const Vec3d reach = to_double(local_bounds[c].extent()) * 0.5;
    bool regular = true;
    double squares = 0, inverse_squares = 0;
    for (int j = 0; j < 3; ++j) {
      const double* row = world.m[j];
      for (int i = 0; i < 3; ++i) {
        maps_[at].m[j][i] = static_cast<float>(row[i]);
        squares += row[i] * row[i];
        inverse_squares += local.m[j][i] * local.m[j][i];
      }
      const double shift_j = shift[static_cast<std::size_t>(j)];
      maps_[at].m[j][3] = static_cast<float>(shift_j);
      // What rounding moves a point of the cluster by, in the world.
      const double moved = (std::abs(row[0]) * reach.x + std::abs(row[1]) * reach.y +
                            std::abs(row[2]) * reach.z + std::abs(shift_j)) *
                           0x1p-24;
      regular = regular && moved <= allowed;
    }
    constexpr double kLargest = 1e24, kMaxCondition = 1e8;  // of squares
    return regular && squares < kLargest && inverse_squares < kLargest &&
           squares * inverse_squares <= kMaxCondition;
  };
  parallel_chunks(model.key_count(), 1, [&](std::size_t key, std::size_t) {
    for (std::size_t c = 0; c < clusters; ++c)
      if (model.clusters[c].triangle_count > 0 && set_map(key * clusters + c, c))
        kinds_[key * clusters + c] = kRegularKey;
  });
  parallel_chunks(model.key_count() - 1, 1, [&](std::size_t key, std::size_t) {
    for (std::size_t c = 0; c < clusters; ++c) {
      const std::size_t at = key * clusters + c, next = at + clusters;
      if ((kinds_[at] & kRegularKey) != 0 && (kinds_[next] & kRegularKey) != 0 &&
          AffinePath(model.local_from_world[at], model.local_from_world[next]).rational_pieces() >
              0)
        kinds_[at] |= kRegularInterval;
    }
  });
}

}  // namespace mdk
