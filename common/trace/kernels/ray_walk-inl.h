// A ray on its way through a model: into its box at the ray's time, through the clusters' boxes,
// sixteen at once, into a cluster's basis and down its hierarchy, to blocks of triangles. What is
// done with a block differs: single rays and the lines of pixels of a scene's pictures share the
// way.
//
//     blocks.limit()      nothing that begins farther along the ray matters any more
//     blocks.finished()   nothing matters any more at all
//     blocks.test(block)  a block whose triangles the ray may hit
#include <algorithm>
#include <cmath>

#include "common/trace/kernels/ray_kernels.h"
#include "common/trace/kernels/walk-inl.h"

#if defined(MDK_RAY_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_RAY_WALK_INL_H_
#undef MDK_RAY_WALK_INL_H_
#else
#define MDK_RAY_WALK_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace rays {

// --- boxes ---

/// A ray against boxes of one basis, as make_box_ray() has it, its numbers in every lane: per axis
/// the plane that it meets first, and last.
template <class D>
class LaneRay {
 public:
  HWY_INLINE LaneRay(D d, const BoxRay& ray) : t_begin_(hn::Set(d, ray.t_begin)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool rises = ray.inverse[axis] >= 0;
      near_row_[axis] = static_cast<std::uint32_t>(2 * axis + (rises ? 0 : 1));
      near_[axis] = hn::Set(d, rises ? ray.origin_for_low[axis] : ray.origin_for_high[axis]);
      far_[axis] = hn::Set(d, rises ? ray.origin_for_high[axis] : ray.origin_for_low[axis]);
      inverse_[axis] = hn::Set(d, ray.inverse[axis]);
    }
  }

  /// Bits of the boxes entered before t_max; where, into `order`. row(i) is a vector of planes.
  template <class Row>
  HWY_INLINE std::uint32_t enter(D d, float t_max, float* order, const Row& row) const {
    auto near = t_begin_, far = hn::Set(d, t_max);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      near = hn::Max(near, hn::Mul(hn::Sub(row(near_row_[axis]), near_[axis]), inverse_[axis]));
      far = hn::Min(far, hn::Mul(hn::Sub(row(near_row_[axis] ^ 1u), far_[axis]), inverse_[axis]));
    }
    hn::Store(near, d, order);
    return mask_bits(d, hn::Le(near, far));
  }

 private:
  hn::Vec<D> near_[3], far_[3], inverse_[3], t_begin_;
  std::uint32_t near_row_[3];
};

/// A ray on its way down one cluster's tree (walk-inl.h).
template <class Blocks>
class RayInTree {
 public:
  HWY_INLINE RayInTree(const BoxRay& ray, const Blocks& blocks)
      : ray_(Tag(), ray), blocks_(blocks) {}

  HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&order)[kBvhWidth]) const {
    const Tag d;
    std::uint32_t entered = 0;
    for (std::size_t first = 0; first < kBvhWidth; first += hn::Lanes(d))
      entered |= ray_.enter(d, blocks_.limit(), order + first, [&](std::uint32_t row) {
        return hn::Load(d, node.bounds[row] + first);
      }) << first;
    return entered & ((1u << node.count) - 1);
  }
  bool is_past(float order) const { return order > blocks_.limit(); }
  bool finished() const { return blocks_.finished(); }

 private:
  using Tag = hn::CappedTag<float, kBvhWidth>;
  LaneRay<Tag> ray_;
  const Blocks& blocks_;
};

// --- blocks ---

/// Sixteen numbers, of which lanes pick some.
class Sixteen {
 public:
  static constexpr std::size_t kParts = 16 / hn::MaxLanes(FloatTag());

  HWY_INLINE void set(std::size_t part, FloatVec values) {
    if constexpr (kParts <= 2) {
      part_[part] = values;
    } else {
      hn::Store(values, FloatTag(), stored_ + part * hn::Lanes(FloatTag()));
    }
  }
  using Indices = hn::Vec<hn::RebindToSigned<FloatTag>>;
  HWY_INLINE FloatVec pick(Indices index) const {
    const FloatTag d;
    const hn::RebindToSigned<FloatTag> di;
    if constexpr (kParts == 1) {
      return hn::TableLookupLanes(part_[0], hn::IndicesFromVec(d, index));
    } else if constexpr (kParts == 2) {
      const auto seven = hn::Set(di, 7);
      const auto place = hn::IndicesFromVec(d, hn::And(index, seven));
      return hn::IfThenElse(hn::RebindMask(d, hn::Gt(index, seven)),
                            hn::TableLookupLanes(part_[1], place),
                            hn::TableLookupLanes(part_[0], place));
    } else {
      return hn::GatherIndex(d, stored_, index);
    }
  }

 private:
  FloatVec part_[kParts <= 2 ? kParts : 1];  // in use where a vector can look them up
  alignas(64) float stored_[kParts <= 2 ? 1 : 16];
};

#if HWY_TARGET != HWY_SCALAR
/// Four vertices at the source's time; a lane more than a vertex has is read.
HWY_INLINE Points<hn::FixedTag<float, 4>> pose_four(const std::uint32_t* vertex,
                                                    const VertexSource& source) {
  const hn::FixedTag<float, 4> d;
  const auto s = hn::Set(d, source.s);
  hn::Vec<hn::FixedTag<float, 4>> row[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto from = hn::LoadU(d, &source.from[vertex[i]].x);
    const auto to = hn::LoadU(d, &source.to[vertex[i]].x);
    row[i] = hn::Add(from, hn::Mul(hn::Sub(to, from), s));
  }
  const auto xy02 = hn::InterleaveLower(d, row[0], row[2]),
             xy13 = hn::InterleaveLower(d, row[1], row[3]),
             z02 = hn::InterleaveUpper(d, row[0], row[2]),
             z13 = hn::InterleaveUpper(d, row[1], row[3]);
  return {hn::InterleaveLower(d, xy02, xy13), hn::InterleaveUpper(d, xy02, xy13),
          hn::InterleaveLower(d, z02, z13)};
}
#endif

/// As many vertices as a vector holds.
template <class D>
HWY_INLINE Points<D> pose(D d, const std::uint32_t* vertex, const VertexSource& source) {
#if HWY_TARGET == HWY_SCALAR
  const Vec3f p = source.position(vertex[0]);
  return {hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z)};
#else
  if constexpr (hn::MaxLanes(d) == 4) {
    return pose_four(vertex, source);
  } else {
    const hn::Half<D> half;
    const auto low = pose(half, vertex, source),
               high = pose(half, vertex + hn::Lanes(half), source);
    return {hn::Combine(d, high.x, low.x), hn::Combine(d, high.y, low.y),
            hn::Combine(d, high.z, low.z)};
  }
#endif
}

/// A ray by the inverse of `from` + s (`to` - `from`). `stretch`: no less than what the inverse
/// makes of a box of half side 1, along each axis, but for rounding.
struct MappedRay {
  alignas(16) float origin[4], direction[4], stretch[4];
};

/// With rows X, Y, Z of the map's linear part, its inverse has the columns Y x Z, Z x X and X x Y,
/// over X . (Y x Z). A column's components stand in the order z, x, y.
HWY_INLINE MappedRay map_ray(const KeyMap& from, const KeyMap& to, double s, const Vec3d& direction,
                             const Vec3d& origin) {
  MappedRay ray;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  const hn::FixedTag<double, 4> d;
  const hn::FixedTag<float, 4> df;
  const hn::FixedTag<std::int64_t, 4> di;
  alignas(32) static constexpr std::int64_t kTurn[4] = {1, 2, 0, 3};
  const auto turn_indices = hn::IndicesFromVec(d, hn::Load(di, kTurn));
  const auto last_index = hn::IndicesFromVec(d, hn::Set(di, 3));
  const auto turned = [&](auto v) { return hn::TableLookupLanes(v, turn_indices); };
  const auto row = [&](int j) {
    const auto a = hn::PromoteTo(d, hn::LoadU(df, from.m[j])),
               b = hn::PromoteTo(d, hn::LoadU(df, to.m[j]));
    return hn::Add(a, hn::Mul(hn::Sub(b, a), hn::Set(d, s)));
  };
  const auto x = row(0), y = row(1), z = row(2);
  const auto tx = turned(x), ty = turned(y), tz = turned(z);
  const auto cx = hn::Sub(hn::Mul(y, tz), hn::Mul(ty, z)),
             cy = hn::Sub(hn::Mul(z, tx), hn::Mul(tz, x)),
             cz = hn::Sub(hn::Mul(x, ty), hn::Mul(tx, y));
  // The last lane of a column is 0: there stand the same two numbers.
  const auto scale = hn::Div(hn::Set(d, 1.0), hn::SumOfLanes(d, hn::Mul(cx, turned(tx))));
  const auto part = [&](auto column, double component, auto r) {
    return hn::Mul(column, hn::Sub(hn::Set(d, component), hn::TableLookupLanes(r, last_index)));
  };
  const auto o = hn::Mul(
      hn::Add(hn::Add(part(cx, origin.x, x), part(cy, origin.y, y)), part(cz, origin.z, z)), scale);
  const auto v = hn::Mul(
      hn::Add(hn::Add(hn::Mul(cx, hn::Set(d, direction.x)), hn::Mul(cy, hn::Set(d, direction.y))),
              hn::Mul(cz, hn::Set(d, direction.z))),
      scale);
  const auto stretch =
      hn::Mul(hn::Add(hn::Add(hn::Abs(cx), hn::Abs(cy)), hn::Abs(cz)), hn::Abs(scale));
  hn::Store(hn::DemoteTo(df, turned(o)), df, ray.origin);
  hn::Store(hn::DemoteTo(df, turned(v)), df, ray.direction);
  hn::Store(hn::DemoteTo(df, turned(stretch)), df, ray.stretch);
#else
  double m[3][4], column[3][3];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i)
      m[j][i] = from.m[j][i] + (static_cast<double>(to.m[j][i]) - from.m[j][i]) * s;
  for (int j = 0; j < 3; ++j) {
    const double *u = m[(j + 1) % 3], *v = m[(j + 2) % 3];
    for (int k = 0; k < 3; ++k)
      column[j][k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
  }
  const double scale =
      1 / (m[0][0] * column[0][0] + m[0][1] * column[0][1] + m[0][2] * column[0][2]);
  const double o[3] = {origin.x - m[0][3], origin.y - m[1][3], origin.z - m[2][3]};
  for (int k = 0; k < 3; ++k) {
    const double cx = column[0][k], cy = column[1][k], cz = column[2][k];
    ray.origin[k] = static_cast<float>((cx * o[0] + cy * o[1] + cz * o[2]) * scale);
    ray.direction[k] =
        static_cast<float>((cx * direction.x + cy * direction.y + cz * direction.z) * scale);
    ray.stretch[k] =
        static_cast<float>((std::abs(cx) + std::abs(cy) + std::abs(cz)) * std::abs(scale));
  }
#endif
  return ray;
}

/// A ray at a time. `slack`: what boxes must give way by in the model, for the triangle test's
/// sake; no less than 1.25 * 2^-19 of the ray's reach.
template <class Blocks>
class RayWalk {
 public:
  RayWalk(const RayModel& model, const WorldRay& ray, const KeyInterval& at, float slack,
          Blocks& blocks)
      : model_(model), ray_(ray), at_(at), slack_(slack), blocks_(blocks) {
    for (std::size_t k = 0; k < 3; ++k) {
      origin_[k] = static_cast<float>(ray.origin[k]);
      direction_[k] = static_cast<float>(ray.direction[k]);
    }
  }

  /// Prepares the ray for the world's boxes; whether it enters the model's at its time.
  bool enter_model() {
    const Aabb &from = model_.key_boxes[at_.key0], &to = model_.key_boxes[at_.key1];
    float near = std::min(0.0f, ray_.t_min), far = blocks_.limit();
    world_.t_begin = near;
    for (std::size_t k = 0; k < 3; ++k) {
      const float d = direction_[k];
      const float inverse = 1 / (std::abs(d) < kShortest ? std::copysign(kShortest, d) : d);
      const float lo = from.lo[k] + (to.lo[k] - from.lo[k]) * at_.s;
      const float hi = from.hi[k] + (to.hi[k] - from.hi[k]) * at_.s;
      // No box of this time reaches farther.
      const float size = std::abs(origin_[k]) + std::max(std::abs(lo), std::abs(hi));
      const float slack = slack_ + size * 0x1p-19f;
      world_.inverse[k] = inverse;
      world_.origin_for_low[k] = origin_[k] + slack;
      world_.origin_for_high[k] = origin_[k] - slack;
      const float a = (lo - world_.origin_for_low[k]) * inverse,
                  b = (hi - world_.origin_for_high[k]) * inverse;
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far;
  }

  /// To be called where it enters the model.
  void walk(std::uint32_t segment) {
    trees_ = model_.trees + std::size_t{segment} * model_.clusters;
    using Tag = hn::CappedTag<float, kTopWidth>;
    const Tag d;
    const LaneRay<Tag> ray(d, world_);
    const std::size_t nodes = model_.top_nodes;
    const TopBoxes* from = model_.top_boxes + nodes * at_.key0;
    const TopBoxes* to = model_.top_boxes + nodes * at_.key1;
    const auto s = hn::Set(d, at_.s);
    WaitingChild stack[kTopWidth * kMaxTopDepth];
    std::size_t size = 0;
    const auto open = [&](std::uint32_t node) {
      alignas(64) float order[kTopWidth];
      std::uint32_t entered = 0;
      for (std::size_t first = 0; first < kTopWidth; first += hn::Lanes(d))
        entered |= ray.enter(d, blocks_.limit(), order + first, [&](std::uint32_t row) {
          const auto a = hn::Load(d, from[node].bounds[row] + first);
          const auto b = hn::Load(d, to[node].bounds[row] + first);
          return hn::Add(a, hn::Mul(hn::Sub(b, a), s));
        }) << first;
      const TopLinks& links = model_.top_links[node];
      entered &= (1u << links.count) - 1;
      const std::size_t bottom = size;
      for (; entered != 0; entered &= entered - 1) {
        const auto c = static_cast<std::size_t>(__builtin_ctz(entered));
        const WaitingChild child{order[c], links.child[c]};
        std::size_t place = size++;
        for (; place > bottom && stack[place - 1].order < child.order; --place)
          stack[place] = stack[place - 1];
        stack[place] = child;
      }
    };
    for (std::uint32_t i = 1; i <= model_.top_roots; ++i) open(model_.top_nodes - i);
    while (size > 0) {
      const WaitingChild next = stack[--size];
      if (next.order > blocks_.limit()) continue;
      if (!next.child.is_leaf()) {
        open(next.child.index());
        continue;
      }
      enter_cluster(next.child.index());
      if (blocks_.finished()) return;
    }
  }

 private:
  void enter_cluster(std::uint32_t c) {
    const RayTree& tree = trees_[c];
    BoxRay local;
    set_local(c, tree.bounds, local);
    RayInTree<Blocks> ray(local, blocks_);
    walk_bvh(tree.nodes, ray, [&](std::uint32_t block) {
      const RayBlock* b = tree.blocks + block;
      blocks_.test(*b);
      while (b->has_next) blocks_.test(*++b);
    });
  }

  /// The ray in the cluster's basis.
  void set_local(std::uint32_t c, const Aabb& bounds, BoxRay& local) const {
    const std::size_t clusters = model_.clusters;
    const std::size_t a = at_.key0 * clusters + c, b = at_.key1 * clusters + c;
    const std::uint8_t needed = at_.key0 == at_.key1 ? kRegularKey : kRegularInterval;
    if ((model_.map_kinds[a] & needed) == 0) {
      local = make_box_ray(
          ray_, interpolate(model_.local_from_world[a], model_.local_from_world[b], at_.s), bounds,
          static_cast<double>(slack_));
      return;
    }
    const MappedRay mapped = map_ray(model_.key_maps[a], model_.key_maps[b], at_.s, ray_.direction,
                                     ray_.origin - to_double(model_.center));
    for (std::size_t k = 0; k < 3; ++k) {
      const float o = mapped.origin[k] + model_.local_centers[c][k], d = mapped.direction[k];
      const float size = std::abs(o) + std::max(std::abs(bounds.lo[k]), std::abs(bounds.hi[k]));
      const float slack = mapped.stretch[k] * slack_ + size * 0x1p-19f;
      local.origin_for_low[k] = o + slack;
      local.origin_for_high[k] = o - slack;
      local.inverse[k] = 1 / (std::abs(d) < kShortest ? std::copysign(kShortest, d) : d);
    }
    local.t_begin = world_.t_begin;
  }

  static constexpr float kShortest = 1e-30f;
  static constexpr std::size_t kMaxTopDepth = 9;  // 16^8 clusters

  const RayModel& model_;
  const WorldRay& ray_;
  const KeyInterval& at_;
  const float slack_;
  Blocks& blocks_;
  const RayTree* trees_ = nullptr;
  float origin_[3], direction_[3];
  BoxRay world_;
};

}  // namespace rays
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
