// App: how a run begins and ends: what is recalled and remembered, printed and written.
#include <algorithm>
#include <filesystem>
#include <iostream>

#include "formats/image_writer.h"
#include "viewer/app.h"
#include "viewer/state_report.h"

namespace mdk {

void App::recall() {
  state_.settings = saved_.settings;
  state_.panel = saved_.panel;
  state_.recent_files = saved_.recent;
  state_.export_settings.films_possible = can_export_films();
}

void App::remember() const {
  if (session_path_.empty() || !window_) return;
  const auto side = [](float length) {
    return std::clamp(static_cast<std::uint32_t>(length), kMinWindowSide, kMaxImageSide);
  };
  SavedSession session;
  const WindowShape shape = window_->shape();
  session.window = WindowSize{side(shape.width), side(shape.height)};
  session.settings = state_.settings;
  session.loop = state_.file ? state_.playback.loop() : saved_.loop;
  session.speed = state_.file ? state_.playback.speed() : saved_.speed;
  session.panel = state_.panel;
  session.recent = state_.recent_files;
  write_session(session, session_path_);
}

void App::play_random_event() {
  if (hand_->done())
    quit_ = true;
  else
    window_->play(hand_->next(widgets_, window_->shape().width, window_->shape().height));
}

// What a random hand may drop on the window.
std::vector<std::string> App::what_lies_here() {
  std::vector<std::string> files;
  std::error_code failure;
  const auto here = std::filesystem::current_path(failure);
  for (std::filesystem::directory_iterator at(here, failure), end; !failure && at != end;
       at.increment(failure))
    files.push_back(at->path().string());
  files.push_back((here / "missing.mdk").string());
  std::ranges::sort(files);
  return files;
}

void App::finish() {
  remember();
  if (!options_.screenshot.empty() || options_.print_state) settle();
  if (!options_.screenshot.empty()) {
    for (int i = 0; i < kSettlingDraws; ++i) draw();  // the last frame's figures, settled
    const Picture picture = window_->read_pixels();
    write_png(options_.screenshot, picture.width, picture.height, picture.pixels);
  }
  if (options_.print_state) {
    if (scripted()) draw();  // so that the widgets told of are those of the last frame
    std::cout << state_json(state_, {frames_shown_, window_draws_, window_->shape().width,
                                     window_->shape().height, widgets_, first_picture_ms_, open_ms_,
                                     render_command_of_picture()})
              << std::endl;
  }
}

}  // namespace mdk
