#include "common/trace/film.h"

#include <algorithm>

#include "common/base/parallel.h"
#include "common/trace/color.h"

namespace mdk {
namespace {

constexpr Vec3f kBackgroundTop{0.060f, 0.068f, 0.082f};
constexpr Vec3f kBackgroundBottom{0.016f, 0.018f, 0.022f};

constexpr std::uint32_t tiles_along(std::uint32_t side) {
  return (side + kTileSide - 1) / kTileSide;
}

}  // namespace

void Film::begin(std::uint32_t width, std::uint32_t height, std::uint32_t samples) {
  const std::size_t count = static_cast<std::size_t>(width) * height;
  if (samples > 1) sums_.assign(count, Vec3f{});
  if (width == width_ && height == height_ && samples == samples_ && samples == 1) return;
  width_ = width;
  height_ = height;
  samples_ = samples;
  pixels_.resize(count);
  if (samples == 1) sums_.clear();
  background_.resize(height);
  backdrop_.resize(height);
  for (std::uint32_t y = 0; y < height; ++y) {
    const float down = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    background_[y] = kBackgroundTop * (1 - down) + kBackgroundBottom * down;
    backdrop_[y] = pack_srgb(background_[y]);
  }
  is_blank_.assign(std::size_t{tiles_along(width)} * tiles_along(height), 0);
}

Film::Place Film::place(std::uint32_t left, std::uint32_t top) const {
  return {.tile = std::size_t{top / kTileSide} * tiles_along(width_) + left / kTileSide,
          .first = static_cast<std::size_t>(top) * width_ + left,
          .columns = std::min(kTileSide, width_ - left),
          .rows = std::min(kTileSide, height_ - top)};
}

void Film::put_tile(std::uint32_t left, std::uint32_t top, const TileColors& colors) {
  const Place at = place(left, top);
  if (samples_ == 1) {
    is_blank_[at.tile] = 0;
    develop_tile(colors, backdrop_.data() + top, at.columns, at.rows, pixels_.data() + at.first,
                 width_);
    return;
  }
  for (std::uint32_t row = 0; row < at.rows; ++row)
    for (std::uint32_t column = 0; column < at.columns; ++column) {
      const std::uint32_t i = row * kTileSide + column;
      const bool is_miss = colors.triangle != nullptr && colors.triangle[i] == kNoHit;
      sums_[at.first + std::size_t{row} * width_ + column] +=
          is_miss ? background_[top + row] : Vec3f{colors.red[i], colors.green[i], colors.blue[i]};
    }
}

void Film::put_background(std::uint32_t left, std::uint32_t top) {
  const Place at = place(left, top);
  if (samples_ == 1 && is_blank_[at.tile] != 0) return;
  is_blank_[at.tile] = 1;
  for (std::uint32_t row = 0; row < at.rows; ++row) {
    const auto first = static_cast<std::ptrdiff_t>(at.first + std::size_t{row} * width_);
    if (samples_ == 1) {
      std::fill_n(pixels_.begin() + first, at.columns, backdrop_[top + row]);
    } else {
      const Vec3f& color = background_[top + row];
      for (std::uint32_t column = 0; column < at.columns; ++column)
        sums_[static_cast<std::size_t>(first) + column] += color;
    }
  }
}

void Film::develop() {
  if (samples_ == 1) return;
  const float share = 1 / static_cast<float>(samples_);
  parallel_chunks(pixels_.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) pixels_[i] = pack_srgb(sums_[i] * share);
  });
}

}  // namespace mdk
