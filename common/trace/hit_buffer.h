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
  float t[kTilePixels];
  std::uint32_t triangle[kTilePixels];
  bool written = true;  ///< to be set by who writes a hit; false: no ray of the tile hits

  /// No ray hits. A tile that is clear is left alone: most of a picture stays background.
  void clear() {
    if (!written) return;
    written = false;
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      t[i] = std::numeric_limits<float>::infinity();
      triangle[i] = kNoHit;
    }
  }
};

/// A whole image of hits. Tiles at the right and lower edge reach past the image; what they hold
/// there has no meaning.
class HitBuffer {
 public:
  void resize(std::uint32_t width, std::uint32_t height) {
    width_ = width;
    height_ = height;
    tiles_x_ = (width + kTileSide - 1) / kTileSide;
    tiles_.resize(static_cast<std::size_t>(tiles_x_) * ((height + kTileSide - 1) / kTileSide));
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
  TileHits& tile(std::size_t i) { return tiles_[i]; }
  const TileHits& tile(std::size_t i) const { return tiles_[i]; }

  std::uint32_t triangle(std::uint32_t x, std::uint32_t y) const {
    return at(x, y).triangle[(y % kTileSide) * kTileSide + x % kTileSide];
  }
  float t(std::uint32_t x, std::uint32_t y) const {
    return at(x, y).t[(y % kTileSide) * kTileSide + x % kTileSide];
  }

 private:
  const TileHits& at(std::uint32_t x, std::uint32_t y) const {
    return tiles_[static_cast<std::size_t>(y / kTileSide) * tiles_x_ + x / kTileSide];
  }
  std::uint32_t width_ = 0, height_ = 0, tiles_x_ = 0;
  std::vector<TileHits> tiles_;
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
