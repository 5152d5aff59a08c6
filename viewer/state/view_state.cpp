#include "viewer/state/view_state.h"

#include <algorithm>
#include <utility>

#include "common/trace/technique.h"

namespace mdk {

void ViewSettings::step_technique(int by) {
  const auto count = static_cast<int>(technique_table().size());
  const int row = static_cast<int>(technique) + by;
  technique = static_cast<std::size_t>((row + count) % count);
}

void ViewSettings::next_shading() {
  const auto modes = shading_table();
  std::size_t row = 0;
  while (row < modes.size() && modes[row].mode != shading) ++row;
  shading = modes[(row + 1) % modes.size()].mode;
}

void ViewSettings::step_text_size(int by) {
  constexpr int kStep = 10;
  text_percent = std::clamp(text_percent + by * kStep, kLeastTextPercent, kMostTextPercent);
}

void ViewState::note_frame(FrameReport frame) {
  history.add({frame.technique, frame.stats.time_to_image_ms()});
  costs[frame.technique].frame = frame;
  last_frame = std::move(frame);
  second_frame.reset();
  difference.reset();
}

void ViewState::note_second_frame(FrameReport frame, const PictureDifference& found) {
  history.add({frame.technique, frame.stats.time_to_image_ms()});
  costs[frame.technique].frame = frame;
  second_frame = std::move(frame);
  difference = found;
}

void ViewState::note_work(const WorkReport& work) {
  costs[work.technique].work = work;
  last_work = work;
}

void ViewState::forget_frames() {
  last_frame.reset();
  second_frame.reset();
  difference.reset();
  last_work.reset();
  costs.clear();
  history.clear();
}

}  // namespace mdk
