#include "common/trace/hit_buffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdk {
namespace {

HitBuffer make_hits(std::uint32_t width, std::uint32_t height) {
  HitBuffer hits;
  hits.resize(width, height);
  return hits;
}

/// As of a frame whose every tile was looked into, and showed nothing.
HitBuffer make_misses(std::uint32_t width, std::uint32_t height) {
  HitBuffer hits = make_hits(width, height);
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    TileHits& tile = hits.tile(i);
    hits.set_hit(i, true);
    std::fill_n(tile.triangle, kTilePixels, kNoHit);
    std::fill_n(tile.t, kTilePixels, std::numeric_limits<float>::infinity());
  }
  return hits;
}

TEST(HitBuffer, CountsPixelsOfTheImageAndNotThoseOfTilesPastItsEdge) {
  HitBuffer hits = make_hits(35, 19);
  ASSERT_EQ(hits.tile_count(), 6u);
  EXPECT_EQ(count_hits(hits), 0u);
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    hits.set_hit(i, true);
    for (std::uint32_t& triangle : hits.tile(i).triangle) triangle = 3;
  }
  EXPECT_EQ(count_hits(hits), 35u * 19u);
}

TEST(HitBuffer, TilesWithoutHitsHaveNoMeaning) {
  HitBuffer hits = make_hits(20, 20);
  hits.set_hit(1, true);
  hits.tile(1).triangle[0] = 5;
  hits.tile(1).t[0] = 2;
  EXPECT_EQ(hits.triangle(16, 0), 5u);
  hits.set_hit(1, false);
  EXPECT_EQ(hits.triangle(16, 0), kNoHit);
  EXPECT_EQ(hits.t(16, 0), std::numeric_limits<float>::infinity());
}

TEST(HitBuffer, MismatchIsAnotherTriangleOrAnotherBitOfDepth) {
  HitBuffer a = make_misses(20, 20), b = make_misses(20, 20);
  EXPECT_EQ(count_mismatches(a, b), 0u);
  a.tile(0).triangle[5] = b.tile(0).triangle[5] = 7;
  a.tile(0).t[5] = 1.0f;
  b.tile(0).t[5] = std::nextafter(1.0f, 2.0f);
  EXPECT_EQ(count_mismatches(a, b), 1u);
  b.tile(0).t[5] = 1.0f;
  b.tile(0).triangle[5] = 8;
  EXPECT_EQ(count_mismatches(a, b), 1u);
  a.tile(3).triangle[kTilePixels - 1] = 1;  // pixel (31, 31): outside the image
  EXPECT_EQ(count_mismatches(a, b), 1u);
  EXPECT_EQ(a.triangle(5, 0), 7u);
}

TEST(HitBuffer, APeerMayNameTheOtherTriangleAtTheSameDepthButNotMissIt) {
  HitBuffer a = make_misses(16, 16), b = make_misses(16, 16);
  const auto mismatches = [&] { return count_mismatches(a, b, Agreement::kSameDepth); };
  a.tile(0).triangle[5] = 7;
  a.tile(0).t[5] = 2.0f;
  EXPECT_EQ(mismatches(), 1u);
  b.tile(0).triangle[5] = 8;
  b.tile(0).t[5] = 2.00001f;
  EXPECT_EQ(mismatches(), 0u);
  EXPECT_EQ(count_mismatches(a, b), 1u);
  b.tile(0).t[5] = 2.0001f;
  EXPECT_EQ(mismatches(), 1u);
  b.tile(0).triangle[5] = 7;  // the same triangle, seen edge-on
  EXPECT_EQ(mismatches(), 0u);
}

}  // namespace
}  // namespace mdk
