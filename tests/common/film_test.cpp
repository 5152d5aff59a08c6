// From linear light to the bytes of a picture.
#include "common/trace/film.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "common/base/isa.h"
#include "common/trace/color.h"

namespace mdk {
namespace {

/// A tile's worth of colours.
class ColorTile {
 public:
  explicit ColorTile(const Vec3f& all) {
    for (std::uint32_t i = 0; i < kTilePixels; ++i) set(i, all);
  }
  void set(std::uint32_t i, const Vec3f& color) {
    red_[i] = color.x;
    green_[i] = color.y;
    blue_[i] = color.z;
  }
  Vec3f at(std::uint32_t i) const { return {red_[i], green_[i], blue_[i]}; }
  TileColors colors() const { return {red_, green_, blue_}; }

 private:
  alignas(64) float red_[kTilePixels], green_[kTilePixels], blue_[kTilePixels];
};

TEST(Film, AveragesSamplesInLinearLight) {
  Film film;
  film.begin(2, 1, 2);
  ColorTile bright({1, 0, 0.5f}), dark({0, 0, 0.5f});
  film.put_tile(0, 0, bright.colors());
  film.put_tile(0, 0, dark.colors());
  film.develop();
  EXPECT_EQ(film.pixels()[1], pack_srgb({0.5f, 0, 0.5f}));
}

TEST(Film, BytesAreThoseOfOneColorOnEveryInstructionSet) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> light(-0.1f, 1.1f);
  for (const std::string_view isa : available_isas()) {
    limit_isa(isa);
    Film film;
    film.begin(kTileSide, kTileSide, 1);
    ColorTile tile({});
    for (std::uint32_t i = 0; i < kTilePixels; ++i)
      tile.set(i, {light(random), light(random), light(random)});
    tile.set(0, {0, 1, std::numeric_limits<float>::quiet_NaN()});
    film.put_tile(0, 0, tile.colors());
    for (std::uint32_t i = 0; i < kTilePixels; ++i)
      ASSERT_EQ(film.pixels()[i], pack_srgb(tile.at(i))) << isa << " pixel " << i;
  }
  reset_isa();
}

TEST(Film, BackgroundComesBackWhereATileWas) {
  Film film, other;
  other.begin(20, 17, 1);
  for (std::uint32_t left : {0u, 16u})
    for (std::uint32_t top : {0u, 16u}) other.put_background(left, top);
  ColorTile tile({1, 1, 1});
  film.begin(20, 17, 1);
  film.put_tile(16, 16, tile.colors());
  EXPECT_EQ(film.pixels()[16 * 20 + 19], pack_srgb({1, 1, 1}));
  film.begin(20, 17, 1);
  for (std::uint32_t left : {0u, 16u})
    for (std::uint32_t top : {0u, 16u}) film.put_background(left, top);
  EXPECT_TRUE(std::ranges::equal(film.pixels(), other.pixels()));
}

TEST(Film, MissesOfATileShowTheBackgroundWithOneSampleAndWithSeveral) {
  std::uint32_t triangle[kTilePixels];
  for (std::uint32_t i = 0; i < kTilePixels; ++i) triangle[i] = i % 3 == 0 ? kNoHit : i;
  ColorTile tile({1, 0, 0});
  TileColors colors = tile.colors();
  colors.triangle = triangle;
  Film once, twice;
  once.begin(13, 16, 1);
  once.put_tile(0, 0, colors);
  twice.begin(13, 16, 2);
  twice.put_tile(0, 0, colors);
  twice.put_tile(0, 0, colors);
  twice.develop();
  EXPECT_TRUE(std::ranges::equal(once.pixels(), twice.pixels()));
  EXPECT_EQ(once.pixels()[1], pack_srgb({1, 0, 0}));
  EXPECT_NE(once.pixels()[3], once.pixels()[1]);
}

}  // namespace
}  // namespace mdk
