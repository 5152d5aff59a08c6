// Blocks of triangles against one tile: what every walk does with the leaves it meets.
#include "common/trace/kernels/tile_image-inl.h"

#if defined(MDK_BLOCK_TESTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_BLOCK_TESTER_INL_H_
#undef MDK_BLOCK_TESTER_INL_H_
#else
#define MDK_BLOCK_TESTER_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Counts work, or compiles to nothing.
struct Counting {
  TraceCounters& counters;
  void nodes(std::uint64_t n) const { counters.node_visits += n; }
  void clusters(std::uint64_t n) const { counters.clusters_entered += n; }
  void setups(std::uint64_t n) const { counters.triangle_setups += n; }
  void tests(std::uint64_t n) const { counters.triangle_tests += n; }
};
struct NoCounting {
  void nodes(std::uint64_t) const {}
  void clusters(std::uint64_t) const {}
  void setups(std::uint64_t) const {}
  void tests(std::uint64_t) const {}
};

template <class Counter>
class BlockTester {
 public:
  BlockTester(const TileRays& tile, const Vec3f* positions, const Counter& counter)
      : tile_(tile), positions_(positions), counter_(counter), image_(tile) {}

  const TileImage& image() const { return image_; }
  const Counter& counter() const { return counter_; }

  /// A block no one keeps: only what may be hit in this tile is projected.
  void test(const TriangleBlock& block, ProjectedBlock& projected) {
    counter_.setups(block.count);
    Projector projector(block, *tile_.pixel_from_world, positions_, projected);
    projector.run([&](std::size_t i) { return image_.may_hit(projected, i); });
    finish(block, projected, projected.live);
  }

  /// A block that serves the whole frame.
  void test(const TriangleBlock& block, std::uint32_t number, ProjectionCache& cache,
            ProjectedBlock& spare) {
    const FloatTag d;
    const ProjectedBlock& projected = cache.get(number, spare, [&](ProjectedBlock& out) {
      Projector projector(block, *tile_.pixel_from_world, positions_, out);
      projector.run([&](std::size_t) { return hn::Eq(hn::Zero(d), hn::Zero(d)); });
    });
    counter_.setups(block.count);
    if (projected.live == 0) return;
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d))
      mask |= bits_of(image_.may_hit(projected, i)) << i;
    finish(block, projected, mask & projected.live);
  }

 private:
  void finish(const TriangleBlock& block, const ProjectedBlock& projected, std::uint32_t mask) {
    if ((mask & projected.behind) != 0) mask &= ~missed_by_sides(block, projected.behind);
    if (mask != 0) counter_.tests(image_.test(block, projected, mask));
  }

  /// Of the triangles in `behind`, those with all corners on the outer side of one of the tile's
  /// four planes: where a triangle reaches behind the eye, this stands for its bounds.
  std::uint32_t missed_by_sides(const TriangleBlock& block, std::uint32_t behind) const {
    const FloatTag d;
    std::uint32_t missed = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d)) {
      const Corners p = gather_corners(block, i, *tile_.pixel_from_world, positions_);
      const auto one_side = [&](FloatVec a, FloatVec b, FloatVec c, std::uint32_t first) {
        const auto offset = [&](FloatVec coordinate, FloatVec depth, std::uint32_t edge) {
          return hn::Sub(coordinate, hn::Mul(depth, hn::Set(d, static_cast<float>(edge))));
        };
        const std::uint32_t last = first + kTileSide;
        const auto below = hn::Max(hn::Max(offset(a, p.a.z, first), offset(b, p.b.z, first)),
                                   offset(c, p.c.z, first));
        const auto above = hn::Min(hn::Min(offset(a, p.a.z, last), offset(b, p.b.z, last)),
                                   offset(c, p.c.z, last));
        return hn::Or(hn::Lt(below, hn::Zero(d)), hn::Gt(above, hn::Zero(d)));
      };
      missed |= bits_of(hn::Or(one_side(p.a.x, p.b.x, p.c.x, tile_.x),
                               one_side(p.a.y, p.b.y, p.c.y, tile_.y)))
                << i;
    }
    return missed & behind;
  }

  const TileRays& tile_;
  const Vec3f* positions_;
  Counter counter_;
  TileImage image_;
};

/// Collects single triangles into blocks.
template <class Counter>
class TriangleBatch {
 public:
  TriangleBatch(BlockTester<Counter>& tester, const Triangle* triangles, ProjectedBlock& spare)
      : tester_(tester), triangles_(triangles), spare_(spare) {}

  void push(std::uint32_t triangle) {
    block_.push(triangle, triangles_[triangle]);
    if (block_.count == kBlockTriangles) flush();
  }
  void flush() {
    if (block_.count == 0) return;
    block_.pad();
    tester_.test(block_, spare_);
    block_.count = 0;
  }

 private:
  BlockTester<Counter>& tester_;
  const Triangle* triangles_;
  ProjectedBlock& spare_;
  TriangleBlock block_;
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
