#include "common/motion/rig.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <compare>
#include <cstring>
#include <numeric>

namespace mdk {
namespace {

template <class T>
std::span<const T> run_of(std::span<const T> items, std::span<const std::uint32_t> first,
                          std::size_t i) {
  return items.subspan(first[i], first[i + 1] - first[i]);
}

std::span<const BoneWeight> weights_of(const RigView& rig, std::size_t vertex) {
  return run_of(rig.bone_weights, rig.first_weight, vertex);
}

std::span<const MorphOffset> offsets_of(const RigView& rig, std::size_t vertex) {
  if (rig.first_offset.empty()) return {};
  return run_of(rig.morph_offsets, rig.first_offset, vertex);
}

Vec3f morphed(const RigView& rig, const RigPose& pose, std::size_t vertex) {
  Vec3f p = rig.base_positions[vertex];
  for (const MorphOffset& m : offsets_of(rig, vertex))
    p += m.offset * pose.target_weights[m.target];
  return p;
}

Vec3f moved(std::span<const BoneWeight> weights, std::span<const Affine3f> bones, const Vec3f& p) {
  Vec3f sum;
  for (const BoneWeight& w : weights) sum += bones[w.bone].point(p) * w.weight;
  return sum;
}

/// Bits whose equality is that of numbers: -0 counts as 0.
std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); }

std::strong_ordering order_of(const Vec3f& a, const Vec3f& b) {
  if (const auto x = bits_of(a.x) <=> bits_of(b.x); x != 0) return x;
  if (const auto y = bits_of(a.y) <=> bits_of(b.y); y != 0) return y;
  return bits_of(a.z) <=> bits_of(b.z);
}
std::strong_ordering order_of(const BoneWeight& a, const BoneWeight& b) {
  if (const auto bone = a.bone <=> b.bone; bone != 0) return bone;
  return bits_of(a.weight) <=> bits_of(b.weight);
}
std::strong_ordering order_of(const MorphOffset& a, const MorphOffset& b) {
  if (const auto target = a.target <=> b.target; target != 0) return target;
  return order_of(a.offset, b.offset);
}

template <class T>
std::strong_ordering order_of(std::span<const T> a, std::span<const T> b) {
  return std::lexicographical_compare_three_way(
      a.begin(), a.end(), b.begin(), b.end(),
      [](const T& x, const T& y) { return order_of(x, y); });
}

/// What vertices are computed from, and their groups, in an order of its own.
std::strong_ordering order_of(const RigView& rig, std::span<const std::uint64_t> groups,
                              std::uint32_t a, std::uint32_t b) {
  if (!groups.empty())
    if (const auto group = groups[a] <=> groups[b]; group != 0) return group;
  if (const auto base = order_of(rig.base_positions[a], rig.base_positions[b]); base != 0)
    return base;
  if (const auto weights = order_of(weights_of(rig, a), weights_of(rig, b)); weights != 0)
    return weights;
  return order_of(offsets_of(rig, a), offsets_of(rig, b));
}

/// Per item the lowest one that is alike. `order(a, b)`: 0 of items that are.
template <class Order>
std::vector<std::uint32_t> lowest_alike(std::size_t count, const Order& order) {
  std::vector<std::uint32_t> sorted(count), lowest(count);
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::ranges::sort(sorted, [&](std::uint32_t a, std::uint32_t b) {
    const auto c = order(a, b);
    return c != 0 ? c < 0 : a < b;
  });
  for (std::size_t i = 0; i < count; ++i) {
    const bool alike = i > 0 && order(sorted[i - 1], sorted[i]) == 0;
    lowest[sorted[i]] = alike ? lowest[sorted[i - 1]] : sorted[i];
  }
  return lowest;
}

/// Per bone the lowest one with the same maps at every key.
std::vector<std::uint32_t> lowest_alike_bones(std::span<const Affine3f> maps, std::size_t bones) {
  const std::size_t keys = bones == 0 ? 0 : maps.size() / bones;
  return lowest_alike(bones, [&](std::uint32_t a, std::uint32_t b) {
    for (std::size_t k = 0; k < keys; ++k)
      if (const int c = std::memcmp(&maps[k * bones + a], &maps[k * bones + b], sizeof(Affine3f)))
        return c;
    return 0;
  });
}

/// One weight per bone, in bone order, added to `out`.
void merge_weights(std::vector<BoneWeight>& weights, std::vector<BoneWeight>& out) {
  std::ranges::stable_sort(weights, {}, &BoneWeight::bone);
  const std::size_t first = out.size();
  for (std::size_t i = 0; i < weights.size();) {
    double sum = 0;
    const std::uint32_t bone = weights[i].bone;
    for (; i < weights.size() && weights[i].bone == bone; ++i)
      sum += static_cast<double>(weights[i].weight);
    out.push_back({bone, static_cast<float>(sum)});
  }
  // Shares of one whole that came together again are that whole, whatever their rounding was.
  constexpr float kRounding = 1e-6f;
  if (out.size() == first + 1 && std::abs(out.back().weight - 1.0f) <= kRounding)
    out.back().weight = 1.0f;
}

void merge_bone_weights(Rig& rig, std::span<const std::uint32_t> bone_of) {
  std::vector<BoneWeight> merged, weights;
  merged.reserve(rig.bone_weights.size());
  std::vector<std::uint32_t> first = {0};
  first.reserve(rig.first_weight.size());
  for (std::size_t i = 0; i < rig.base_positions.size(); ++i) {
    const auto run = run_of(std::span<const BoneWeight>(rig.bone_weights), rig.first_weight, i);
    weights.assign(run.begin(), run.end());
    for (BoneWeight& w : weights) w.bone = bone_of[w.bone];
    merge_weights(weights, merged);
    first.push_back(static_cast<std::uint32_t>(merged.size()));
  }
  rig.bone_weights = std::move(merged);
  rig.first_weight = std::move(first);
}

/// New numbers for the items that are used, in their old order.
struct Renumbering {
  std::vector<std::uint32_t> kept;  ///< old numbers
  std::vector<std::uint32_t> number;

  explicit Renumbering(const std::vector<char>& used) : number(used.size(), 0) {
    for (std::uint32_t i = 0; i < used.size(); ++i) {
      if (!used[i]) continue;
      number[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(i);
    }
  }
};

/// The columns `kept` of a key-major table.
template <class T>
std::vector<T> select_columns(std::span<const T> table, std::size_t width,
                              std::span<const std::uint32_t> kept, std::uint32_t keys) {
  std::vector<T> selected;
  selected.reserve(kept.size() * keys);
  for (std::size_t k = 0; k < keys; ++k)
    for (const std::uint32_t i : kept) selected.push_back(table[k * width + i]);
  return selected;
}

/// Returns the old numbers of those that are left.
std::vector<std::uint32_t> drop_unused_bones(Rig& rig, std::size_t bones, std::uint32_t keys) {
  std::vector<char> used(bones, 0);
  for (const BoneWeight& w : rig.bone_weights) used[w.bone] = 1;
  Renumbering renumbering(used);
  for (BoneWeight& w : rig.bone_weights) w.bone = renumbering.number[w.bone];
  rig.bone_maps =
      select_columns(std::span<const Affine3f>(rig.bone_maps), bones, renumbering.kept, keys);
  return std::move(renumbering.kept);
}

void drop_idle_targets(Rig& rig, std::size_t targets, std::uint32_t keys) {
  std::vector<char> weighted(targets, 0), used(targets, 0);
  for (std::size_t i = 0; i < rig.target_weights.size(); ++i)
    if (rig.target_weights[i] != 0) weighted[i % targets] = 1;
  for (const MorphOffset& m : rig.morph_offsets) used[m.target] = weighted[m.target];
  const Renumbering renumbering(used);
  std::vector<MorphOffset> offsets;
  std::vector<std::uint32_t> first = {0};
  for (std::size_t i = 0; i + 1 < rig.first_offset.size(); ++i) {
    for (std::size_t k = rig.first_offset[i]; k < rig.first_offset[i + 1]; ++k) {
      const MorphOffset& m = rig.morph_offsets[k];
      if (used[m.target]) offsets.push_back({renumbering.number[m.target], m.offset});
    }
    first.push_back(static_cast<std::uint32_t>(offsets.size()));
  }
  rig.first_offset = offsets.empty() ? std::vector<std::uint32_t>{} : std::move(first);
  rig.morph_offsets = std::move(offsets);
  rig.target_weights =
      select_columns(std::span<const float>(rig.target_weights), targets, renumbering.kept, keys);
}

}  // namespace

RigPose rig_pose(const RigView& rig, std::uint32_t key, std::uint32_t key_count) {
  const std::size_t bones = rig.bone_maps.size() / key_count;
  const std::size_t targets = rig.target_weights.size() / key_count;
  return {rig.bone_maps.subspan(key * bones, bones),
          rig.target_weights.subspan(key * targets, targets)};
}

void pose_vertices(const RigView& rig, const RigPose& pose, VertexRange range,
                   std::span<Vec3f> out) {
  for (std::size_t i = 0; i < range.size(); ++i) {
    const std::size_t vertex = range.begin + i;
    out[i] = moved(weights_of(rig, vertex), pose.bones, morphed(rig, pose, vertex));
  }
}

Rig select_vertices(const Rig& rig, std::span<const std::uint32_t> kept) {
  const RigView from = rig.view();
  Rig to;
  to.base_positions.reserve(kept.size());
  to.first_weight = {0};
  if (!rig.first_offset.empty()) to.first_offset = {0};
  for (const std::uint32_t v : kept) {
    to.base_positions.push_back(rig.base_positions[v]);
    const auto weights = weights_of(from, v);
    to.bone_weights.insert(to.bone_weights.end(), weights.begin(), weights.end());
    to.first_weight.push_back(static_cast<std::uint32_t>(to.bone_weights.size()));
    if (rig.first_offset.empty()) continue;
    const auto offsets = offsets_of(from, v);
    to.morph_offsets.insert(to.morph_offsets.end(), offsets.begin(), offsets.end());
    to.first_offset.push_back(static_cast<std::uint32_t>(to.morph_offsets.size()));
  }
  to.bone_maps = rig.bone_maps;
  to.target_weights = rig.target_weights;
  return to;
}

std::vector<std::uint32_t> simplify_rig(Rig& rig, std::uint32_t key_count, AlikeBones alike) {
  const std::size_t bones = rig.bone_maps.size() / key_count;
  const std::size_t targets = rig.target_weights.size() / key_count;
  std::vector<std::uint32_t> stands_for(bones);
  std::iota(stands_for.begin(), stands_for.end(), 0u);
  if (alike == AlikeBones::kJoin) stands_for = lowest_alike_bones(rig.bone_maps, bones);
  merge_bone_weights(rig, stands_for);
  drop_idle_targets(rig, targets, key_count);
  return drop_unused_bones(rig, bones, key_count);
}

std::vector<std::uint32_t> lowest_alike_vertices(const Rig& rig,
                                                 std::span<const std::uint64_t> groups) {
  const RigView view = rig.view();
  return lowest_alike(rig.base_positions.size(), [&](std::uint32_t a, std::uint32_t b) {
    return order_of(view, groups, a, b);
  });
}

Affine3d rotation(const Vec3d& turn) {
  const double angle = length(turn);
  if (!(angle > 0)) return {};
  const Vec3d u = turn * (1 / angle);
  const double c = std::cos(angle), s = std::sin(angle), t = 1 - c;
  return {{{c + t * u.x * u.x, t * u.x * u.y - s * u.z, t * u.x * u.z + s * u.y, 0},
           {t * u.x * u.y + s * u.z, c + t * u.y * u.y, t * u.y * u.z - s * u.x, 0},
           {t * u.x * u.z - s * u.y, t * u.y * u.z + s * u.x, c + t * u.z * u.z, 0}}};
}

std::vector<Affine3d> world_from_joints(const SkeletonView& skeleton, const SkeletonPose& pose) {
  std::vector<Affine3d> world(skeleton.joints.size());
  for (std::size_t j = 0; j < world.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const Affine3d local =
        to_double(joint.parent_from_joint) * rotation(pose.turns[j]) * scaling(joint.scale);
    world[j] = joint.parent == kNoParent ? local : world[joint.parent] * local;
  }
  return world;
}

std::vector<Affine3f> bone_maps(const SkeletonView& skeleton, const SkeletonPose& pose) {
  const std::vector<Affine3d> world = world_from_joints(skeleton, pose);
  std::vector<Affine3f> maps;
  maps.reserve(skeleton.bones.size());
  for (const BoneBinding& bone : skeleton.bones)
    maps.push_back(to_float(world[bone.joint] * to_double(bone.joint_from_base)));
  return maps;
}

std::uint32_t joint_past_limit(const SkeletonView& skeleton, const SkeletonPose& pose) {
  for (std::uint32_t j = 0; j < skeleton.joints.size(); ++j)
    if (!(length(pose.turns[j]) <= skeleton.joints[j].limit)) return j;
  return kNoParent;
}

}  // namespace mdk
