#include "common/trace/film.h"

#include <algorithm>

#include "common/base/parallel.h"
#include "common/trace/color.h"

namespace mdk {

void Film::begin(std::uint32_t width, std::uint32_t height, std::uint32_t samples) {
  width_ = width;
  samples_ = samples;
  const std::size_t count = static_cast<std::size_t>(width) * height;
  pixels_.resize(count);
  sums_.clear();
  if (samples > 1) sums_.resize(count);
}

void Film::put_row(std::uint32_t x, std::uint32_t y, std::uint32_t count, const float* red,
                   const float* green, const float* blue) {
  const std::size_t first = static_cast<std::size_t>(y) * width_ + x;
  if (samples_ > 1) {
    for (std::size_t i = 0; i < count; ++i) sums_[first + i] += {red[i], green[i], blue[i]};
    return;
  }
  constexpr std::uint32_t kRun = 16;  // steps first, for a vector at a time; then the table
  const auto& srgb = srgb_table();
  alignas(64) std::int32_t r[kRun], g[kRun], b[kRun];
  for (std::uint32_t done = 0; done < count; done += kRun) {
    const std::uint32_t run = std::min(kRun, count - done);
    for (std::uint32_t i = 0; i < run; ++i) {
      r[i] = srgb_step(red[done + i]);
      g[i] = srgb_step(green[done + i]);
      b[i] = srgb_step(blue[done + i]);
    }
    const auto byte = [&](std::int32_t step) -> std::uint32_t {
      return srgb[static_cast<std::size_t>(step)];
    };
    for (std::uint32_t i = 0; i < run; ++i)
      pixels_[first + done + i] = byte(r[i]) | byte(g[i]) << 8 | byte(b[i]) << 16 | 0xff000000u;
  }
}

void Film::put_row(std::uint32_t x, std::uint32_t y, std::uint32_t count, const Vec3f& color) {
  const std::size_t first = static_cast<std::size_t>(y) * width_ + x;
  if (samples_ == 1) {
    std::fill_n(pixels_.begin() + static_cast<std::ptrdiff_t>(first), count, pack_srgb(color));
    return;
  }
  for (std::size_t i = 0; i < count; ++i) sums_[first + i] += color;
}

void Film::develop() {
  if (samples_ == 1) return;
  const float share = 1 / static_cast<float>(samples_);
  parallel_chunks(pixels_.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) pixels_[i] = pack_srgb(sums_[i] * share);
  });
}

}  // namespace mdk
