// ShownPicture: the last finished frame as it is shown: alone or beside a second technique's, some
// of its triangles highlighted.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/trace/hit_buffer.h"
#include "viewer/picture/render_worker.h"
#include "viewer/state/settings.h"

namespace mdk {

/// Pixels made on the CPU: sRGB RGBA, width * height, row 0 on top.
struct Picture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
};

using PixelSpan = std::span<const std::uint32_t>;

/// Two pictures of the same view; sRGB RGBA, width * height each.
struct PicturePair {
  PixelSpan first, second;
  std::uint32_t width = 0, height = 0;
};

PictureDifference difference_of(const PicturePair& pair);

/// 2 width x height: the first at the left.
Picture side_by_side(const PicturePair& pair);

/// The first's columns up to `divider` (a part of the width, in [0, 1]), the second's from there.
Picture wipe(const PicturePair& pair, float divider);

/// Black where the two agree to the bit, over a faint trace of the first picture that shows where
/// one is; where they differ, a mark from dark red (by little) to white (by much), wide enough to
/// be seen where only few pixels differ.
Picture difference_picture(const PicturePair& pair);

/// The triangle at each pixel of `hits`, row 0 on top; kNoHit: none. Cost: O(pixels).
std::vector<std::uint32_t> triangles_of(const HitBuffer& hits);

/// What stands out, and how.
struct Highlight {
  std::uint32_t first_triangle = 0, triangle_count = 0;
  std::uint32_t color = 0;  ///< sRGB RGBA
};

/// A copy of the picture in which pixels of those triangles are tinted, and white where their area
/// ends. `triangles`: as triangles_of(), of rows `width` long; the picture has as many rows, each
/// of one or more such rows side by side.
Picture highlighted(const Picture& picture, std::span<const std::uint32_t> triangles,
                    std::uint32_t width, const Highlight& highlight);

class ShownPicture {
 public:
  void show(FinishedFrame frame, const CompareSettings& settings);

  /// Puts the frame's pictures together as is now chosen; whether that changed the picture. A frame
  /// that was not traced for what is chosen stays as it is until one comes that was.
  bool arrange(const CompareSettings& settings);

  void clear() { *this = {}; }

  /// Empty (width 0) before the first frame.
  const Picture& picture() const { return picture_; }
  /// The picture with some triangles made to stand out; as it is where it shows a difference, in
  /// which nothing else may stand out.
  Picture with(const Highlight& highlight) const;

 private:
  std::optional<FinishedFrame> frame_;
  Picture picture_;
  CompareSettings arranged_;
};

}  // namespace mdk
