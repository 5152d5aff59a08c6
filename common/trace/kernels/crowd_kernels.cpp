// Tiles of rays through instances, each in its own model's space.
#include "common/trace/kernels/crowd_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/crowd_kernels.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/ray_boxes-inl.h"
#include "common/trace/kernels/ray_test-inl.h"
#include "common/trace/kernels/tile_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace tiles {

/// The picture of a tile while instance after instance is traced into it. Hits so far stand in
/// `committed_`; for the instance at hand, a pixel of a lower instance has triangle 0 and one of a
/// higher one kNoHit, and its own triangles count from 1: so the triangle test's rule for ties is
/// that of instances, too.
class CrowdImage : public TileImage {
 public:
  explicit CrowdImage(const TileRays& tile) : TileImage(tile), tile_(tile) {}

  /// Whether what is no nearer than `nearest` is hidden in all pixels of `squares`.
  HWY_INLINE bool hides(std::uint32_t squares, float nearest) const {
    if (!begun_ || !(nearest > 0)) return false;
    const FloatTag d;
    const auto inverse = hn::Set(d, (1 + 0x1p-20f) / nearest);
    std::uint32_t hidden = 0;
    for (std::size_t s = 0; s < kSquares; s += hn::Lanes(d))
      hidden |= mask_bits(d, hn::Gt(hn::Load(d, far_ + s), inverse)) << s;
    return (squares & ~hidden) == 0;
  }

  /// The depth past which nothing matters any more in `squares`.
  float farthest_in(std::uint32_t squares) const {
    float least = std::numeric_limits<float>::infinity();
    for (; squares != 0; squares &= squares - 1)
      least = std::min(least, far_[__builtin_ctz(squares)]);
    return 1.0f / least;
  }
  /// Of a pixel, counted from the tile's corner.
  float inverse_depth(std::uint32_t x, std::uint32_t y) const { return inverse_depth_[at(x, y)]; }

  void begin_instance(const InstanceRays& rays, std::uint32_t squares) {
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> du;
    left_ = static_cast<float>(tile_.x) + 0.5f - rays.shift_x;
    top_ = static_cast<float>(tile_.y) + 0.5f - rays.shift_y;
    if (!begun_) {
      for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d))
        hn::Store(hn::Set(du, kNoHit), du, instance_ + i);
      begin();
    } else {
      set_places();
    }
    number_ = rays.instance;
    touched_ = 0;
    const auto own = hn::Set(du, number_);
    for (; squares != 0; squares &= squares - 1) {
      const std::size_t first = static_cast<std::size_t>(__builtin_ctz(squares)) * kSquarePixels;
      for (std::size_t k = 0; k < kSquarePixels; k += hn::Lanes(d)) {
        const auto other = hn::Load(du, instance_ + first + k);
        hn::Store(hn::IfThenElse(hn::Lt(other, own), hn::Zero(du), hn::Set(du, kNoHit)), du,
                  triangle_ + first + k);
      }
    }
  }
  void end_instance() {
    const hn::RebindToUnsigned<FloatTag> du;
    for (; touched_ != 0; touched_ &= touched_ - 1) {
      const std::size_t first = static_cast<std::size_t>(__builtin_ctz(touched_)) * kSquarePixels;
      for (std::size_t k = 0; k < kSquarePixels; k += hn::Lanes(du)) {
        const auto number = hn::Load(du, triangle_ + first + k);
        const auto old = hn::Or(hn::Eq(number, hn::Zero(du)), hn::Eq(number, hn::Set(du, kNoHit)));
        std::uint32_t *triangle = committed_ + first + k, *instance = instance_ + first + k;
        hn::Store(hn::IfThenElse(old, hn::Load(du, triangle), hn::Sub(number, hn::Set(du, 1))), du,
                  triangle);
        hn::Store(hn::IfThenElse(old, hn::Load(du, instance), hn::Set(du, number_)), du, instance);
      }
    }
  }

  /// The closest hits of one pixel with the triangles in `mask`; (x, y) is its centre as the
  /// instance counts.
  void test_pixel(const std::uint32_t* triangles, const ProjectedBlock& projected,
                  std::uint32_t mask, float x, float y) {
    const FloatTag d;
    changed_ = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d)) {
      const std::uint32_t lanes = mask >> i & ((1u << hn::Lanes(d)) - 1);
      if (lanes != 0) test_pixel_each(triangles, projected, i, lanes, hn::Set(d, x), hn::Set(d, y));
    }
    if (changed_ != 0) update_far();
  }

  void store(TileHits& hits, TileInstances& instances) {
    for (std::size_t i = 0; i < kTilePixels; ++i)
      triangle_[i] = instance_[i] == kNoHit ? kNoHit : committed_[i];
    TileImage::store(hits);
    for (std::uint32_t y = 0; y < kTileSide; ++y)
      for (std::uint32_t x = 0; x < kTileSide; ++x)
        instances.instance[y * kTileSide + x] = instance_[at(x, y)];
  }

 private:
  static std::size_t at(std::uint32_t x, std::uint32_t y) {
    return (y / kSquareSide * 4 + x / kSquareSide) * kSquarePixels + y % kSquareSide * kSquareSide +
           x % kSquareSide;
  }

  const TileRays& tile_;
  std::uint32_t number_ = 0;
  alignas(64) std::uint32_t instance_[kTilePixels];
  alignas(64) std::uint32_t committed_[kTilePixels];
};

/// Pixels of a tile, counted from its corner, ends included.
struct PixelRange {
  int first_x, last_x, first_y, last_y;

  bool empty() const { return first_x > last_x || first_y > last_y; }
  int count() const { return (last_x - first_x + 1) * (last_y - first_y + 1); }
  /// The 4x4 squares it touches.
  std::uint32_t squares() const {
    const auto run = [](int first, int last) { return (2u << last / 4) - (1u << first / 4); };
    std::uint32_t rows = 0;
    for (int row = first_y / 4; row <= last_y / 4; ++row) rows |= run(first_x, last_x) << 4 * row;
    return rows;
  }
};

/// Corners of a block's triangles from its vertices, which are posed and projected once.
class BlockCorners {
 public:
  BlockCorners(const RayBlock& block, const PixelFromWorld& map, const VertexSource& vertices)
      : block_(block) {
    const FloatTag d;
    for (std::size_t part = 0; part < rays::Sixteen::kParts; ++part) {
      const Points p =
          to_pixel_space(map, rays::pose(d, block.vertex + part * hn::Lanes(d), vertices));
      x_.set(part, p.x);
      y_.set(part, p.y);
      z_.set(part, p.z);
    }
  }
  HWY_INLINE Corners operator()(std::size_t first) const {
    return {corner(0, first), corner(1, first), corner(2, first)};
  }

 private:
  HWY_INLINE Points corner(std::size_t k, std::size_t first) const {
    const hn::RebindToSigned<FloatTag> di;
    const hn::Rebind<std::uint8_t, FloatTag> db;
    const auto place = hn::PromoteTo(di, hn::LoadU(db, block_.corner[k] + first));
    return {x_.pick(place), y_.pick(place), z_.pick(place)};
  }

  const RayBlock& block_;
  rays::Sixteen x_, y_, z_;
};

/// The numbers of triangles as CrowdImage counts them.
struct TrianglesFromOne {
  alignas(64) std::uint32_t number[kBlockTriangles];

  explicit TrianglesFromOne(const std::uint32_t* triangles) {
    const hn::RebindToUnsigned<FloatTag> du;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(du))
      hn::Store(hn::Add(hn::LoadU(du, triangles + i), hn::Set(du, 1)), du, number + i);
  }
};

/// Calls leaf(c) for the clusters that may be met, near ones first: enter(node, order) and
/// is_past(order) as walk-inl.h has it, of a node of the model's hierarchy over clusters.
template <class Enter, class IsPast, class Leaf>
HWY_INLINE void walk_clusters(const RayModel& model, const Enter& enter, const IsPast& is_past,
                              const Leaf& leaf) {
  constexpr std::size_t kMaxTopDepth = 9;  // 16^8 clusters
  WaitingChild stack[kTopWidth * kMaxTopDepth];
  std::size_t size = 0;
  const auto open = [&](std::uint32_t node) {
    alignas(64) float order[kTopWidth];
    const TopLinks& links = model.top_links[node];
    const std::size_t bottom = size;
    for (std::uint32_t entered = enter(node, order) & ((1u << links.count) - 1); entered != 0;
         entered &= entered - 1) {
      const auto c = static_cast<std::size_t>(__builtin_ctz(entered));
      const WaitingChild child{order[c], links.child[c]};
      std::size_t place = size++;
      for (; place > bottom && stack[place - 1].order < child.order; --place)
        stack[place] = stack[place - 1];
      stack[place] = child;
    }
  };
  for (std::uint32_t i = 1; i <= model.top_roots; ++i) open(model.top_nodes - i);
  while (size > 0) {
    const WaitingChild next = stack[--size];
    if (is_past(next.order)) continue;
    if (next.child.is_leaf()) {
      leaf(next.child.index());
    } else {
      open(next.child.index());
    }
  }
}

/// Planes of the boxes of a node of that hierarchy, at an instance's time.
class NodeAtTime {
 public:
  NodeAtTime(const InstanceRays& instance, std::uint32_t node) : s_(instance.at.s) {
    const RayModel& model = *instance.model;
    const TopBoxes* boxes = model.top_boxes + node;
    from_ = boxes + std::size_t{model.top_nodes} * instance.at.key0;
    to_ = boxes + std::size_t{model.top_nodes} * instance.at.key1;
  }
  template <class D>
  HWY_INLINE hn::Vec<D> row(D d, std::size_t r, std::size_t first) const {
    const auto a = hn::Load(d, from_->bounds[r] + first), b = hn::Load(d, to_->bounds[r] + first);
    return hn::Add(a, hn::Mul(hn::Sub(b, a), hn::Set(d, s_)));
  }

 private:
  const TopBoxes *from_, *to_;
  float s_;
};

HWY_INLINE FourFloats four_floats(const Vec3d& v) {
  return to_float(FourDoubles::load(std::array{v.x, v.y, v.z, 0.0}.data()));
}

/// One pixel's line through an instance.
template <class Counter>
class PixelLine {
 public:
  PixelLine(const InstanceRays& instance, CrowdImage& image, CrowdScratch& scratch, std::uint32_t x,
            std::uint32_t y, float place_x, float place_y, const Counter& counter)
      : instance_(instance),
        image_(image),
        scratch_(scratch),
        column_(x),
        row_(y),
        x_(place_x),
        y_(place_y),
        reach_(instance.line_reach.of(instance.longest_edge)),
        counter_(counter) {
    set_limit();
  }

  void trace() {
    const RayModel& model = *instance_.model;
    const KeyInterval& at = instance_.at;
    const Vec3d origin = to_double(instance_.rays.origin),
                direction = to_double(instance_.rays.corner) +
                            to_double(instance_.rays.du) * static_cast<double>(x_) +
                            to_double(instance_.rays.dv) * static_cast<double>(y_);
    const float longest_reach = reach_;
    const FourFloats slack = FourFloats::all(instance_.line_slack);
    const FourFloats rounding = FourFloats::all(0x1p-19f);
    const FourFloats from = four_floats(origin), along = four_floats(direction);
    const rays::BoxRay world(from, along,
                             slack + (abs(from) + FourFloats::load(instance_.size)) * rounding, 0);
    if (!world.enters(FourFloats::load(instance_.lo), FourFloats::load(instance_.hi), hit_.t))
      return;
    const FloatTag d;
    const rays::LaneRay<FloatTag> lanes(d, world);
    const RayTree* const trees = model.trees + std::size_t{instance_.segment} * model.clusters;
    const Vec3d from_center = origin - to_double(model.center);
    const auto map_into = [&](std::uint32_t c) {
      const std::size_t a = at.key0 * std::size_t{model.clusters} + c,
                        b = at.key1 * std::size_t{model.clusters} + c;
      const std::uint8_t needed = at.key0 == at.key1 ? kRegularKey : kRegularInterval;
      if ((model.map_kinds[a] & needed) == 0)
        return rays::map_irregular(
            interpolate(model.local_from_world[a], model.local_from_world[b], at.s), direction,
            origin);
      rays::MappedRay ray =
          rays::map_ray(model.key_maps[a], model.key_maps[b], at.s, direction, from_center);
      ray.origin = ray.origin + four_floats(to_double(model.local_centers[c]));
      return ray;
    };
    walk_clusters(
        model,
        [&](std::uint32_t node, float* order) {
          const NodeAtTime boxes(instance_, node);
          counter_.nodes(model.top_links[node].count);
          std::uint32_t entered = 0;
          for (std::size_t i = 0; i < kTopWidth; i += hn::Lanes(d))
            entered |= lanes.enter(d, hit_.t, order + i, [&](std::uint32_t row) {
              return boxes.row(d, row, i);
            }) << i;
          return entered;
        },
        [&](float order) { return order > nearest_ + longest_reach; },
        [&](std::uint32_t c) {
          counter_.clusters(1);
          reach_ = instance_.line_reach.of(std::max(instance_.edges[0][c], instance_.edges[1][c]));
          hit_.t = nearest_ + reach_;
          const rays::MappedRay mapped = map_into(c);
          const RayTree& tree = trees[c];
          rays::BoxRay local(mapped.origin, mapped.direction,
                             mapped.stretch * slack +
                                 (abs(mapped.origin) + FourFloats::load(tree.size)) * rounding,
                             0);
          if (HWY_UNLIKELY(mapped.is_extreme)) local.enter_all();
          rays::RayInTree in_tree(local, tree.nodes.data(), tree.blocks, RayAim::kClosest, hit_);
          walk_bvh(tree.nodes, in_tree, [&](std::uint32_t number) {
            const RayBlock* block = tree.blocks + number;
            test(*block);
            while (block->has_next) test(*++block);
          });
        });
  }

 private:
  void test(const RayBlock& block) {
    const FloatTag d;
    counter_.candidates(block.count);
    const ProjectedBlock& p = projected(block);
    if (p.live == 0) return;
    const auto x = hn::Set(d, x_), y = hn::Set(d, y_), best = hn::Set(d, best_);
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d)) {
      const auto in_x =
          hn::And(hn::Le(hn::Load(d, p.first_x + i), x), hn::Ge(hn::Load(d, p.last_x + i), x));
      const auto in_y =
          hn::And(hn::Le(hn::Load(d, p.first_y + i), y), hn::Ge(hn::Load(d, p.last_y + i), y));
      const auto seen = hn::Ge(hn::Load(d, p.max_inverse_depth + i), best);
      mask |= mask_bits(d, hn::And(hn::And(in_x, in_y), seen)) << i;
    }
    mask &= p.live;
    if (mask == 0) return;
    counter_.tests(static_cast<std::uint64_t>(__builtin_popcount(mask)));
    image_.test_pixel(TrianglesFromOne(block.triangle).number, p, mask, x_, y_);
    set_limit();
  }

  /// A block is seen by the lines of several pixels, one after another.
  const ProjectedBlock& projected(const RayBlock& block) {
    const std::size_t place =
        reinterpret_cast<std::uintptr_t>(&block) / sizeof(RayBlock) % CrowdScratch::kBlocks;
    CrowdScratch::Entry& entry = scratch_.entries[place];
    ProjectedBlock& p = scratch_.projected[place];
    if (entry.block == &block && entry.entered == scratch_.entered) return p;
    entry = {&block, scratch_.entered};
    const FloatTag d;
    const BlockCorners corners(block, instance_.pixel_from_model, instance_.vertices);
    Projector projector(block.count, corners, instance_.pixel_from_model.margin, p);
    projector.run([&](std::size_t) { return hn::Eq(hn::Zero(d), hn::Zero(d)); });
    return p;
  }

  void set_limit() {
    best_ = image_.inverse_depth(column_, row_);
    nearest_ = (1 + 0x1p-20f) / best_;
    hit_.t = nearest_ + reach_;
  }

  const InstanceRays& instance_;
  CrowdImage& image_;
  CrowdScratch& scratch_;
  std::uint32_t column_, row_;
  float x_, y_;
  float best_, nearest_, reach_;
  RayHit hit_;  ///< of it only t is in use: how far boxes matter
  Counter counter_;
};

/// A tile, or the part of it that an instance may be seen in, against the instance's blocks.
template <class Counter>
class InstanceTester {
 public:
  InstanceTester(const InstanceRays& instance, CrowdImage& image, std::uint32_t squares,
                 const TileEdges& part, const TileEdges& tile, const Counter& counter)
      : instance_(instance),
        image_(image),
        squares_(squares),
        part_(part),
        tile_(tile),
        counter_(counter),
        farthest_(image.farthest_in(squares)) {}

  const TileEdges& edges() const { return part_; }
  float farthest() const { return farthest_; }
  const Counter& counter() const { return counter_; }

  void test(const RayBlock& block) {
    counter_.candidates(block.count);
    const BlockCorners corners(block, instance_.pixel_from_model, instance_.vertices);
    Projector projector(block.count, corners, instance_.pixel_from_model.margin, projected_);
    projector.run([&](std::size_t i) { return image_.may_hit(projected_, i); });
    std::uint32_t mask = projected_.live;
    if ((mask & projected_.behind) != 0)
      mask &= ~missed_by_sides(tile_, corners, projected_.behind);
    if (mask == 0) return;
    counter_.tests(image_.test(TrianglesFromOne(block.triangle).number, projected_, mask));
    farthest_ = image_.farthest_in(squares_);
  }

 private:
  const InstanceRays& instance_;
  CrowdImage& image_;
  std::uint32_t squares_;
  TileEdges part_, tile_;
  Counter counter_;
  float farthest_;
  ProjectedBlock projected_;
};

/// A tile on its way through a scene.
template <class Counter>
class CrowdTile {
 public:
  CrowdTile(const TileRays& tile, const CrowdView& view, InstanceSource& source,
            CrowdScratch& scratch, const Counter& counter, CrowdCounters* counters)
      : tile_(tile),
        view_(view),
        source_(source),
        scratch_(scratch),
        counter_(counter),
        counters_(counters),
        image_(tile),
        left_(static_cast<float>(tile.x)),
        top_(static_cast<float>(tile.y)) {}

  void trace() {
    for (const CrowdView::Tree& tree : view_.trees) {
      TileInScene rays(*this, tree.forms);
      walk_bvh(tree.nodes, rays, [&](std::uint32_t number) { enter(number); });
    }
  }
  CrowdImage& image() { return image_; }

  // For TileInTree, of the hierarchy over instances.
  TileEdges edges() const { return edges_of(tile_); }
  float farthest() const { return image_.farthest(); }
  const Counter& counter() const { return counter_; }

 private:
  /// The tile in the hierarchy over instances: of leaves, only those that hold the centre of a
  /// pixel that is not hidden are entered.
  class TileInScene {
   public:
    TileInScene(CrowdTile& tile, const FrustumForms& forms) : tile_(tile), rays_(forms, tile) {}
    HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&depth)[kBvhWidth]) const {
      std::uint32_t entered = rays_.enter(node, depth), leaves = 0;
      for (std::uint32_t rest = entered; rest != 0; rest &= rest - 1) {
        const auto c = static_cast<std::uint32_t>(__builtin_ctz(rest));
        leaves |= static_cast<std::uint32_t>(node.child[c].is_leaf()) << c;
      }
      if (leaves == 0) return entered;
      entered &= ~leaves | tile_.holding_pixels(node);
      for (std::uint32_t rest = entered & leaves; rest != 0; rest &= rest - 1)
        hwy::Prefetch(tile_.view_.instances + node.child[__builtin_ctz(rest)].index());
      return entered;
    }
    bool is_past(float depth) const { return rays_.is_past(depth); }
    static constexpr bool finished() { return false; }

   private:
    CrowdTile& tile_;
    TileInTree<CrowdTile> rays_;
  };

  /// Which of a node's boxes hold the centre of a pixel of the tile, by the bounds of their
  /// corners' images; all that reach behind the eye.
  std::uint32_t holding_pixels(const WideBvhNode& node) const {
    const hn::CappedTag<float, kBvhWidth> d;
    using V = hn::Vec<decltype(d)>;
    std::uint32_t holding = 0;
    for (std::size_t i = 0; i < kBvhWidth; i += hn::Lanes(d)) {
      V lo[3], hi[3];
      V reach = hn::Zero(d);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto origin = hn::Set(d, view_.pixel_from_world.origin[axis]);
        lo[axis] = hn::Sub(hn::Load(d, node.bounds[2 * axis] + i), origin);
        hi[axis] = hn::Sub(hn::Load(d, node.bounds[2 * axis + 1] + i), origin);
        reach = hn::Add(reach, hn::Max(hn::Abs(lo[axis]), hn::Abs(hi[axis])));
      }
      const auto slack = hn::Mul(reach, hn::Set(d, view_.slack));
      V part[3][3][2];  // of a row of the map, an axis, a side
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto low = hn::Sub(lo[axis], slack), high = hn::Add(hi[axis], slack);
        for (std::size_t row = 0; row < 3; ++row) {
          const auto m = hn::Set(d, view_.pixel_from_world.m[row][axis]);
          part[row][axis][0] = hn::Mul(m, low);
          part[row][axis][1] = hn::Mul(m, high);
        }
      }
      const auto infinite = hn::Set(d, std::numeric_limits<float>::infinity());
      V first_x = infinite, last_x = hn::Neg(infinite), first_y = infinite,
        last_y = hn::Neg(infinite), nearest = infinite;
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const auto row = [&](std::size_t r) {
          return hn::Add(hn::Add(part[r][0][corner & 1], part[r][1][corner >> 1 & 1]),
                         part[r][2][corner >> 2]);
        };
        const auto z = row(2), inverse = hn::Div(hn::Set(d, 1.0f), z);
        const auto x = hn::Mul(row(0), inverse), y = hn::Mul(row(1), inverse);
        nearest = hn::Min(nearest, z);
        first_x = hn::Min(first_x, x);
        last_x = hn::Max(last_x, x);
        first_y = hn::Min(first_y, y);
        last_y = hn::Max(last_y, y);
      }
      // Products and sums round by 2^-21 of `reach` times a row; kMargin is what hits lie off.
      const auto inverse = hn::Div(hn::Mul(reach, hn::Set(d, 0x1p-20f)), nearest);
      const auto pad_x = hn::MulAdd(inverse, hn::Set(d, row_size(0)), hn::Set(d, kPixelPad)),
                 pad_y = hn::MulAdd(inverse, hn::Set(d, row_size(1)), hn::Set(d, kPixelPad));
      const auto overlaps = [&](V first, V last, V pad, float begin) {
        const auto from =
            hn::Max(hn::Ceil(hn::Sub(hn::Sub(first, pad), hn::Set(d, begin + 0.5f))), hn::Zero(d));
        const auto to = hn::Min(hn::Floor(hn::Sub(hn::Add(last, pad), hn::Set(d, begin + 0.5f))),
                                hn::Set(d, float{kTileSide - 1}));
        return hn::Le(from, to);
      };
      const auto seen =
          hn::And(overlaps(first_x, last_x, pad_x, left_), overlaps(first_y, last_y, pad_y, top_));
      const auto behind = hn::Not(hn::Gt(nearest, hn::Mul(reach, hn::Set(d, 0x1p-10f))));
      holding |= mask_bits(d, hn::Or(seen, behind)) << i;
    }
    return holding;
  }
  float row_size(std::size_t row) const {
    const float* m = view_.pixel_from_world.m[row];
    return std::abs(m[0]) + std::abs(m[1]) + std::abs(m[2]);
  }

  void enter(std::uint32_t number) {
    const InstanceRays* const instance = source_.enter(number);
    if (instance == nullptr) return;
    const ScreenBox& screen = instance->screen;
    const auto first = [](float edge, float begin) {
      return static_cast<int>(std::clamp(edge - begin, 0.0f, float{kTileSide}));
    };
    const auto last = [](float edge, float begin, float end) {
      return static_cast<int>(std::floor(
          std::max(std::min({edge - begin, float{kTileSide - 1}, end - begin - 1}), -1.0f)));
    };
    const PixelRange pixels{first(screen.first_x, left_ + 0.5f),
                            last(screen.last_x, left_ + 0.5f, view_.columns + 0.5f),
                            first(screen.first_y, top_ + 0.5f),
                            last(screen.last_y, top_ + 0.5f, view_.rows + 0.5f)};
    if (pixels.empty()) return;
    const std::uint32_t squares = pixels.squares();
    if (image_.hides(squares, screen.nearest)) return;
    if (counters_ != nullptr) ++counters_->instances_entered;
    image_.begin_instance(*instance, squares);
    ++scratch_.entered;
    if (instance->has_lines) {
      trace_lines(*instance, pixels);
    } else {
      trace_part(*instance, pixels, squares);
    }
    image_.end_instance();
  }

  void trace_lines(const InstanceRays& instance, const PixelRange& pixels) {
    const float nearest_inverse = (1 + 0x1p-20f) / instance.screen.nearest;
    const float left = left_ - instance.shift_x + 0.5f, top = top_ - instance.shift_y + 0.5f;
    for (int y = pixels.first_y; y <= pixels.last_y; ++y)
      for (int x = pixels.first_x; x <= pixels.last_x; ++x) {
        const auto column = static_cast<std::uint32_t>(x), row = static_cast<std::uint32_t>(y);
        if (image_.inverse_depth(column, row) > nearest_inverse) continue;
        if (counters_ != nullptr) ++counters_->lines;
        const float place_x = left + static_cast<float>(x), place_y = top + static_cast<float>(y);
        PixelLine<Counter>(instance, image_, scratch_, column, row, place_x, place_y, counter_)
            .trace();
      }
  }

  void trace_part(const InstanceRays& instance, const PixelRange& pixels, std::uint32_t squares) {
    const float left = left_ - instance.shift_x, top = top_ - instance.shift_y;
    const TileEdges part{
        left + static_cast<float>(pixels.first_x), left + static_cast<float>(pixels.last_x + 1),
        top + static_cast<float>(pixels.first_y), top + static_cast<float>(pixels.last_y + 1)};
    const TileEdges tile{left, left + kTileSide, top, top + kTileSide};
    using Tester = InstanceTester<Counter>;
    Tester tester(instance, image_, squares, part, tile, counter_);
    const RayModel& model = *instance.model;
    const RayTree* trees = model.trees + std::size_t{instance.segment} * model.clusters;
    const TileInTree<Tester> rays(source_.model_forms(), tester);
    walk_clusters(
        model,
        [&](std::uint32_t node, float(&order)[kTopWidth]) {
          const FloatTag d;
          const NodeAtTime boxes(instance, node);
          alignas(64) float bounds[6][kTopWidth];
          for (std::size_t row = 0; row < 6; ++row)
            for (std::size_t i = 0; i < kTopWidth; i += hn::Lanes(d))
              hn::Store(boxes.row(d, row, i), d, bounds[row] + i);
          counter_.nodes(model.top_links[node].count);
          return rays.enter(bounds, order);
        },
        [&](float order) { return rays.is_past(order); },
        [&](std::uint32_t c) {
          counter_.clusters(1);
          const TileInTree<Tester> local(source_.cluster_forms(c), tester);
          walk_bvh(trees[c].nodes, local, [&](std::uint32_t number) {
            const RayBlock* block = trees[c].blocks + number;
            tester.test(*block);
            while (block->has_next) tester.test(*++block);
          });
        });
  }

  static constexpr float kPixelPad = 2 * kBoundsMargin;

  const TileRays& tile_;
  const CrowdView& view_;
  InstanceSource& source_;
  CrowdScratch& scratch_;
  Counter counter_;
  CrowdCounters* counters_;
  CrowdImage image_;
  float left_, top_;  ///< of the tile
};

bool TraceCrowdTile(const TileRays& tile, const CrowdView& view, InstanceSource& source,
                    CrowdScratch& scratch, TileHits& hits, TileInstances& instances,
                    CrowdCounters* counters) {
  const auto with = [&](const auto& counter) {
    CrowdTile traced(tile, view, source, scratch, counter, counters);
    traced.trace();
    if (traced.image().empty()) return false;
    traced.image().store(hits, instances);
    return true;
  };
  return counters == nullptr ? with(NoCounting{}) : with(Counting{counters->work});
}

bool TraceCrowdBrute(const TileRays& tile, std::span<const BruteInstance> all, TileHits& hits,
                     TileInstances& instances) {
  CrowdImage image(tile);
  ProjectedBlock projected;
  for (const BruteInstance& instance : all) {
    image.begin_instance(instance.rays, 0xffff);
    const float left = static_cast<float>(tile.x) - instance.rays.shift_x,
                top = static_cast<float>(tile.y) - instance.rays.shift_y;
    const TileEdges edges{left, left + kTileSide, top, top + kTileSide};
    for (const TriangleBlock& block : instance.blocks) {
      const IndexedCorners corners{block, instance.rays.pixel_from_model, instance.positions};
      Projector projector(block.count, corners, instance.rays.pixel_from_model.margin, projected);
      projector.run([&](std::size_t i) { return image.may_hit(projected, i); });
      std::uint32_t mask = projected.live;
      if ((mask & projected.behind) != 0)
        mask &= ~missed_by_sides(edges, corners, projected.behind);
      if (mask != 0) image.test(TrianglesFromOne(block.triangle).number, projected, mask);
    }
    image.end_instance();
  }
  if (image.empty()) return false;
  image.store(hits, instances);
  return true;
}

}  // namespace tiles
using tiles::TraceCrowdBrute, tiles::TraceCrowdTile;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(TraceCrowdTile);
HWY_EXPORT(TraceCrowdBrute);

bool trace_crowd_tile(const TileRays& tile, const CrowdView& view, InstanceSource& source,
                      CrowdScratch& scratch, TileHits& hits, TileInstances& instances,
                      CrowdCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(TraceCrowdTile)(tile, view, source, scratch, hits, instances,
                                              counters);
}

bool trace_crowd_brute(const TileRays& tile, std::span<const BruteInstance> all, TileHits& hits,
                       TileInstances& instances) {
  return HWY_DYNAMIC_DISPATCH(TraceCrowdBrute)(tile, all, hits, instances);
}

}  // namespace mdk
#endif  // HWY_ONCE
