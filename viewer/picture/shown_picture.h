// ShownPicture: the last finished frame as it is shown: alone, or beside a second technique's.
#pragma once

#include <optional>

#include "viewer/picture/comparison.h"
#include "viewer/picture/highlight.h"
#include "viewer/picture/render_worker.h"

namespace mdk {

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
