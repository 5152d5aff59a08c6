#include "viewer/picture/shown_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "common/base/error.h"

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

constexpr std::uint32_t kWhite = 0xffffffffu;

/// Half of each channel from either.
std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
  return (a & b) + (((a ^ b) & 0xfefefefeu) >> 1);
}

Picture arranged(const FinishedFrame& frame, const CompareSettings& settings) {
  const std::uint32_t width = frame.job.request.width, height = frame.job.request.height;
  if (!frame.second) return {width, height, frame.pixels};
  const PicturePair pair{frame.pixels, frame.second->pixels, width, height};
  switch (settings.mode) {
    case CompareMode::kOff:
      break;
    case CompareMode::kSideBySide:
      return side_by_side(pair);
    case CompareMode::kWipe:
      return wipe(pair, settings.divider);
    case CompareMode::kDifference:
      return difference_picture(pair);
  }
  return {width, height, frame.pixels};
}

/// Whether the pictures of both modes have the same size.
bool same_size(CompareMode a, CompareMode b) {
  return (a == CompareMode::kSideBySide) == (b == CompareMode::kSideBySide);
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

std::vector<std::uint32_t> triangles_of(const HitBuffer& hits) {
  const std::uint32_t width = hits.width(), height = hits.height();
  std::vector<std::uint32_t> triangles(static_cast<std::size_t>(width) * height, kNoHit);
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    if (!hits.is_hit(i)) continue;
    const std::uint32_t left = hits.tile_left(i), top = hits.tile_top(i);
    const std::uint32_t columns = std::min(kTileSide, width - left);
    const std::uint32_t rows = std::min(kTileSide, height - top);
    for (std::uint32_t y = 0; y < rows; ++y)
      std::copy_n(hits.tile(i).triangle + y * kTileSide, columns,
                  triangles.begin() + static_cast<std::ptrdiff_t>(top + y) * width + left);
  }
  return triangles;
}

Picture highlighted(const Picture& picture, std::span<const std::uint32_t> triangles,
                    std::uint32_t width, const Highlight& highlight) {
  const std::size_t row = width;
  if (width == 0 || picture.width % width != 0 || triangles.size() != row * picture.height)
    throw Error(ErrorCode::kInternal, "the triangles of another picture are to be highlighted");
  const auto inside = [&](std::size_t i) {
    return triangles[i] - highlight.first_triangle < highlight.triangle_count;
  };
  const std::uint32_t tint = middle(highlight.color, kWhite);
  Picture marked = picture;
  for (std::uint32_t y = 0; y < picture.height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t i = row * y + x;
      if (!inside(i)) continue;
      const bool ends = (x > 0 && !inside(i - 1)) || (x + 1 < width && !inside(i + 1)) ||
                        (y > 0 && !inside(i - row)) || (y + 1 < picture.height && !inside(i + row));
      for (std::size_t at = static_cast<std::size_t>(picture.width) * y + x;
           at < static_cast<std::size_t>(picture.width) * (y + 1); at += row)
        marked.pixels[at] = ends ? kWhite : middle(picture.pixels[at], tint);
    }
  return marked;
}

void ShownPicture::show(FinishedFrame frame, const CompareSettings& settings) {
  picture_ = arranged(frame, settings);
  arranged_ = settings;
  frame_ = std::move(frame);
}

bool ShownPicture::arrange(const CompareSettings& settings) {
  const bool same = settings.mode == arranged_.mode &&
                    (settings.mode != CompareMode::kWipe || settings.divider == arranged_.divider);
  if (!frame_ || !frame_->second || same || !same_size(settings.mode, arranged_.mode)) return false;
  picture_ = arranged(*frame_, settings);
  arranged_ = settings;
  return true;
}

Picture ShownPicture::with(const Highlight& highlight) const {
  if (!frame_ || arranged_.mode == CompareMode::kDifference) return picture_;
  return highlighted(picture_, frame_->triangles, frame_->job.request.width, highlight);
}

}  // namespace mdk
