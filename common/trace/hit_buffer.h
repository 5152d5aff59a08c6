// HitBuffer: the closest hit of every pixel, tile by tile.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace mdk {

inline constexpr std::uint32_t kTileSide = 16;
inline constexpr std::uint32_t kTilePixels = kTileSide * kTileSide;
inline constexpr std::uint32_t kNoHit = 0xffffffffu;

/// One tile's closest hits; pixel (i, j) of the tile stands at j * kTileSide + i.
struct alignas(64) TileHits {
  float t[kTilePixels];  ///< infinite where nothing is hit
  std::uint32_t triangle[kTilePixels];
};

/// A whole image of hits. Tiles at the right and lower edge reach past the image; what they hold
/// there has no meaning.
class HitBuffer {
 public:
  /// Nothing is hit afterwards.
  void resize(std::uint32_t width, std::uint32_t height) {
    width_ = width;
    height_ = height;
    tiles_x_ = (width + kTileSide - 1) / kTileSide;
    tiles_.resize(static_cast<std::size_t>(tiles_x_) * ((height + kTileSide - 1) / kTileSide));
    is_hit_.assign(tiles_.size(), 0);
  }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  std::size_t tile_count() const { return tiles_.size(); }
  /// Upper left pixel of tile `i`.
  std::uint32_t tile_left(std::size_t i) const {
    return static_cast<std::uint32_t>(i % tiles_x_) * kTileSide;
  }
  std::uint32_t tile_top(std::size_t i) const {
    return static_cast<std::uint32_t>(i / tiles_x_) * kTileSide;
  }
  /// Whether a ray of tile `i` hits. Most of a picture is background, and its tiles are left alone:
  /// where none hits, the tile has no meaning.
  bool is_hit(std::size_t i) const { return is_hit_[i] != 0; }
  void set_hit(std::size_t i, bool is_hit) { is_hit_[i] = is_hit ? 1 : 0; }
  TileHits& tile(std::size_t i) { return tiles_[i]; }
  const TileHits& tile(std::size_t i) const { return tiles_[i]; }

  std::uint32_t triangle(std::uint32_t x, std::uint32_t y) const {
    const std::size_t i = tile_at(x, y);
    return is_hit(i) ? tiles_[i].triangle[pixel_at(x, y)] : kNoHit;
  }
  float t(std::uint32_t x, std::uint32_t y) const {
    const std::size_t i = tile_at(x, y);
    return is_hit(i) ? tiles_[i].t[pixel_at(x, y)] : std::numeric_limits<float>::infinity();
  }

 private:
  std::size_t tile_at(std::uint32_t x, std::uint32_t y) const {
    return static_cast<std::size_t>(y / kTileSide) * tiles_x_ + x / kTileSide;
  }
  static std::size_t pixel_at(std::uint32_t x, std::uint32_t y) {
    return (y % kTileSide) * kTileSide + x % kTileSide;
  }
  std::uint32_t width_ = 0, height_ = 0, tiles_x_ = 0;
  std::vector<TileHits> tiles_;
  std::vector<std::uint8_t> is_hit_;
};

/// When two hits count as the same.
enum class Agreement {
  kBitIdentical,  ///< same triangle, and t to the bit
  kSameDepth,     ///< same triangle, or t to 1e-5 relative: for another program's triangle test
};

/// Pixels whose hits are not the same. Both images have the same size.
std::uint64_t count_mismatches(const HitBuffer& a, const HitBuffer& b,
                               Agreement agreement = Agreement::kBitIdentical);

/// Pixels that hit something.
std::uint64_t count_hits(const HitBuffer& hits);

}  // namespace mdk
