// Scheduler: what the worker traces next: the picture of the state, as coarse as it has to be while
// the user drags, or a measurement for the cost curves while the user rests.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include "viewer/picture/requests.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Whether a person uses the window, or a script waits for its pictures.
enum class RunMode { kInteractive, kScripted };

/// Pixels for pictures in the window, those of both techniques where two are side by side.
struct PictureSpace {
  std::uint32_t width = 0, height = 0;
};

class Scheduler {
 public:
  /// `state` must outlive it. `on_finished` is called from the worker's thread when take_finished()
  /// has something.
  Scheduler(ViewState& state, RunMode mode, std::function<void()> on_finished)
      : state_(state), mode_(mode), worker_(std::move(on_finished)) {}

  bool busy() const { return worker_.busy(); }
  /// Whether the last picture could not be made.
  bool failed() const { return requests_.failed(); }
  /// The user did something: measuring stops for a while.
  void note_activity(double now);
  void set_motion(Motion motion) { motion_ = motion; }
  Motion motion() const { return motion_; }
  /// Another file is open.
  void start_again();

  /// The picture of the state of an open file, as coarse as it is traced now, or else at full
  /// resolution.
  RenderJob current_job(const PictureSpace& space) const;
  RenderJob full_job(const PictureSpace& space) const { return job(space, 1); }

  /// Whether a picture that has not changed is traced again where the settings say so.
  enum class Repeat { kNever, kAsChosen };
  /// Asks the worker for the picture of the state, where that is due; whether it was.
  bool request_picture(const PictureSpace& space, double now, Repeat repeat);

  /// A frame of the open file to be shown, or whose error is; its costs are in the state.
  std::optional<FinishedFrame> take_finished(const PictureSpace& space, double now);

  /// How many pictures were shown in the last second goes into the state. Whether they stopped.
  bool update_rate(double now);

  /// Asks the worker for a measurement where it is idle and the user rests; call it when all is
  /// drawn. Whether a curve has grown enough to be drawn.
  bool survey(const PictureSpace& space, double now);
  /// Whether there may be something to measure once the user rests.
  bool has_to_survey() const { return has_to_survey_; }

 private:
  RenderJob job(const PictureSpace& space, std::uint32_t divisor) const;

  ViewState& state_;
  const RunMode mode_;
  Motion motion_ = Motion::kStill;
  double full_picture_ms_ = 0;  ///< the last frame's time, scaled to full resolution
  RequestPolicy requests_;
  CostSurvey survey_;
  bool has_to_survey_ = true;
  std::size_t known_drawn_ = 0;  ///< moments of the technique's curve at its last drawing
  double curve_drawn_ = 0;       ///< when
  double last_activity_ = 0;
  std::deque<double> shown_times_;
  RenderWorker worker_;
};

}  // namespace mdk
