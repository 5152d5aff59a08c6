// Film: the picture in the making: linear light of one or more samples per pixel becomes sRGB
// bytes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/vec3.h"

namespace mdk {

/// Most samples a pixel may have.
inline constexpr std::uint32_t kMostSamples = 4096;

class Film {
 public:
  /// Begins a picture, `samples` of which will be put at each pixel; with one, pixels are ready at
  /// once. Memory: 4 bytes a pixel, and 12 more where there are several samples.
  void begin(std::uint32_t width, std::uint32_t height, std::uint32_t samples);

  std::uint32_t samples() const { return samples_; }

  /// One sample of `count` pixels from (x, y) rightwards, linear RGB. Different pixels may be put
  /// by different threads.
  void put_row(std::uint32_t x, std::uint32_t y, std::uint32_t count, const float* red,
               const float* green, const float* blue);
  /// The same colour for all of them.
  void put_row(std::uint32_t x, std::uint32_t y, std::uint32_t count, const Vec3f& color);

  /// Averages the samples. To be called after the last one. Runs in parallel.
  void develop();

  /// sRGB RGBA, red lowest, row 0 on top.
  std::span<const std::uint32_t> pixels() const { return pixels_; }

 private:
  std::uint32_t width_ = 0, samples_ = 1;
  std::vector<std::uint32_t> pixels_;
  std::vector<Vec3f> sums_;  ///< only of several samples
};

}  // namespace mdk
