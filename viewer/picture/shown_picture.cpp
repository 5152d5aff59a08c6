#include "viewer/picture/shown_picture.h"

#include <utility>

namespace mdk {
namespace {

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
bool same_room(CompareMode a, CompareMode b) {
  return (a == CompareMode::kSideBySide) == (b == CompareMode::kSideBySide);
}

}  // namespace

void ShownPicture::show(FinishedFrame frame, const CompareSettings& settings) {
  picture_ = arranged(frame, settings);
  arranged_ = settings;
  frame_ = std::move(frame);
}

bool ShownPicture::arrange(const CompareSettings& settings) {
  const bool same = settings.mode == arranged_.mode &&
                    (settings.mode != CompareMode::kWipe || settings.divider == arranged_.divider);
  if (!frame_ || !frame_->second || same || !same_room(settings.mode, arranged_.mode)) return false;
  picture_ = arranged(*frame_, settings);
  arranged_ = settings;
  return true;
}

Picture ShownPicture::with(const Highlight& highlight) const {
  if (!frame_ || arranged_.mode == CompareMode::kDifference) return picture_;
  return highlighted(picture_, frame_->triangles, frame_->job.request.width, highlight);
}

}  // namespace mdk
