// Film: the picture in the making, tile by tile: linear light of one or more samples per pixel
// becomes sRGB bytes, on a background darker downwards.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vec3.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/film_kernel.h"

namespace mdk {

/// How many samples a pixel may have.
inline constexpr std::uint32_t kMaxSamples = 4096;

class Film {
 public:
  /// Begins a picture, `samples` of which will be put at each pixel; with one, pixels are ready at
  /// once. Memory: 4 bytes a pixel, and 12 more where there are several samples.
  void begin(std::uint32_t width, std::uint32_t height, std::uint32_t samples);

  /// One sample of each pixel of the tile with its upper left pixel at (left, top). Different tiles
  /// may be put by different threads.
  void put_tile(std::uint32_t left, std::uint32_t top, const TileColors& colors);
  /// Background only. Costs nothing where that is shown already: most of a picture stays so.
  void put_background(std::uint32_t left, std::uint32_t top);

  /// Averages the samples. To be called after the last one. Runs in parallel.
  void develop();

  /// sRGB RGBA, red lowest, row 0 on top.
  std::span<const std::uint32_t> pixels() const { return pixels_; }

 private:
  struct Place {
    std::size_t tile, first;      ///< its number, and its first pixel
    std::uint32_t columns, rows;  ///< inside the image
  };
  Place place(std::uint32_t left, std::uint32_t top) const;

  std::uint32_t width_ = 0, height_ = 0, samples_ = 0;
  std::vector<std::uint32_t> pixels_;
  std::vector<Vec3f> sums_;              ///< only of several samples
  std::vector<Vec3f> background_;        ///< linear, one per row
  std::vector<std::uint32_t> backdrop_;  ///< as pixels
  std::vector<std::uint8_t> is_blank_;   ///< per tile: shows the background and nothing else
};

}  // namespace mdk
