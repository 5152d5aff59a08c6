#include "viewer/picture/comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace mdk {
namespace {

constexpr std::uint32_t kOpaque = 0xff000000u;
constexpr std::uint64_t kFewPixels = 2000;  // are marked wider than they are
constexpr int kMarkReach = 2;
constexpr std::uint32_t kAmplification = 16;

/// The largest step of a colour channel.
std::uint32_t channel_step(std::uint32_t a, std::uint32_t b) {
  int largest = 0;
  for (int shift = 0; shift < 24; shift += 8)
    largest = std::max(largest, std::abs(static_cast<int>(a >> shift & 255u) -
                                         static_cast<int>(b >> shift & 255u)));
  return static_cast<std::uint32_t>(largest);
}

std::uint32_t faint(std::uint32_t pixel) {
  const std::uint32_t sum = (pixel & 255u) + (pixel >> 8 & 255u) + (pixel >> 16 & 255u);
  const std::uint32_t grey = sum / 18;
  return grey | grey << 8 | grey << 16 | kOpaque;
}

std::uint32_t mark(std::uint32_t step) {
  const std::uint32_t heat = std::min(765u, 160 + step * kAmplification);
  const std::array<std::uint32_t, 3> rgb = {std::min(heat, 255u),
                                            heat > 255 ? std::min(heat - 255, 255u) : 0,
                                            heat > 510 ? heat - 510 : 0};
  return rgb[0] | rgb[1] << 8 | rgb[2] << 16 | kOpaque;
}

Picture blank(std::uint32_t width, std::uint32_t height) {
  return {width, height, std::vector<std::uint32_t>(static_cast<std::size_t>(width) * height)};
}

}  // namespace

PictureDifference difference_of(const PicturePair& pair) {
  PictureDifference difference;
  for (std::size_t i = 0; i < pair.first.size(); ++i) {
    if (pair.first[i] == pair.second[i]) continue;
    ++difference.pixels;
    difference.largest = std::max(difference.largest, channel_step(pair.first[i], pair.second[i]));
  }
  return difference;
}

Picture side_by_side(const PicturePair& pair) {
  Picture picture = blank(2 * pair.width, pair.height);
  auto out = picture.pixels.begin();
  for (std::uint32_t y = 0; y < pair.height; ++y)
    for (const PixelSpan& half : {pair.first, pair.second}) {
      const PixelSpan row = half.subspan(static_cast<std::size_t>(y) * pair.width, pair.width);
      out = std::copy(row.begin(), row.end(), out);
    }
  return picture;
}

Picture wipe(const PicturePair& pair, float divider) {
  Picture picture = blank(pair.width, pair.height);
  const auto column = static_cast<std::ptrdiff_t>(
      std::lround(std::clamp(divider, 0.0f, 1.0f) * static_cast<float>(pair.width)));
  for (std::uint32_t y = 0; y < pair.height; ++y) {
    const auto start = static_cast<std::ptrdiff_t>(y) * pair.width;
    const auto out = picture.pixels.begin() + start;
    std::copy_n(pair.first.begin() + start, column, out);
    std::copy_n(pair.second.begin() + start + column, pair.width - column, out + column);
  }
  return picture;
}

Picture difference_picture(const PicturePair& pair) {
  Picture picture = blank(pair.width, pair.height);
  std::transform(pair.first.begin(), pair.first.end(), picture.pixels.begin(), faint);
  const int reach = difference_of(pair).pixels <= kFewPixels ? kMarkReach : 0;
  const auto width = static_cast<int>(pair.width), height = static_cast<int>(pair.height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<std::size_t>(y) * pair.width + static_cast<std::size_t>(x);
      if (pair.first[i] == pair.second[i]) continue;
      const std::uint32_t color = mark(channel_step(pair.first[i], pair.second[i]));
      for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u)
          picture.pixels[static_cast<std::size_t>(v) * pair.width + static_cast<std::size_t>(u)] =
              color;
    }
  return picture;
}

}  // namespace mdk
