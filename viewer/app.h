// App: the viewer's loop. Events change the ViewState; a picture of it is asked of the worker; the
// window is drawn when something is new, and sleeps when nothing is.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/stopwatch.h"
#include "viewer/options.h"
#include "viewer/panel/side_panel.h"
#include "viewer/panel/style.h"
#include "viewer/picture/cost_survey.h"
#include "viewer/picture/render_worker.h"
#include "viewer/picture/request_policy.h"
#include "viewer/picture/resolution.h"
#include "viewer/picture/sequence_export.h"
#include "viewer/picture/shown_picture.h"
#include "viewer/random_hand.h"
#include "viewer/saved_session.h"
#include "viewer/scene/scene_loader.h"
#include "viewer/state/view_state.h"
#include "viewer/window/font_book.h"
#include "viewer/window/texture_blit.h"
#include "viewer/window/window.h"

namespace mdk {

class App {
 public:
  /// Opens the window and the file. A file that cannot be opened is said in the window; throws
  /// Error (kIo) where there can be no window.
  explicit App(const ViewerOptions& options);

  /// Until the user quits, or --quit-after. Returns the exit status: 0, or for a scripted run that
  /// of the error that still stands. Throws Error (kIo) where the screenshot cannot be written.
  int run();

 private:
  static constexpr int kSettlingDraws = 3;  ///< ImGui needs a few to settle after an event

  WindowSize window_size() const;
  void begin_first_picture();
  void open_window();
  void name_window();
  void wake();
  void follow_display();

  void show_loaded_scene();
  void look_for_changes();
  void apply_options();
  void show_error(const Error& error);
  void show_notice(const std::string& sentence);

  void open(const std::vector<std::string>& paths);
  void export_sequence();
  void show_export();
  void keep_baked();
  void recall();
  void remember() const;
  void play_random_event();
  static std::vector<std::string> what_lies_here();

  void pass_time(double seconds);
  void handle_events();
  void execute(const Action& action);
  void reset_view();

  void show_finished_frame();
  void upload_picture();
  void update_shown_rate();
  void expire_notice();

  RenderJob wanted_job() const;
  RenderJob job_at_divisor(std::uint32_t divisor) const;
  enum class Repeat { kNever, kAsChosen };
  bool request_picture(Repeat repeat);  // whether there was one to ask for
  void settle();
  void survey_costs();

  WindowShape shape() const;
  float ui_scale() const;
  Layout layout() const;
  PixelRect picture_pixels() const;
  double picture_aspect() const;
  double seconds_to_wait() const;
  bool draw_is_due() const;
  void draw();
  std::string render_command_of_picture() const;  // empty without a file
  void copy_render_command();
  void save_picture();
  void save_window();
  void save(const Picture& picture);

  bool scripted() const { return options_.quit_after > 0; }
  void finish();

  Stopwatch since_start_;
  ViewerOptions options_;
  std::string session_path_;  ///< empty: nothing is kept
  SavedSession saved_;
  WindowShape expected_shape_;  ///< while there is no window
  FontBook fonts_;
  std::optional<Window> window_;  // before the loader and the worker, who wake it
  std::optional<TextureBlit> blit_;
  std::atomic<bool> can_wake_ = false;
  Theme theme_;
  ViewState state_;
  WidgetMap widgets_;
  ErrorCode error_code_ = ErrorCode::kInternal;  ///< of state_.error, where one stands

  Stopwatch clock_;             ///< since the window opened
  Stopwatch since_asked_;       ///< for the file that is shown or on its way
  double last_event_time_ = 0;  ///< when time was last let pass
  double last_draw_time_ = -1;
  double notice_until_ = 0;
  int redraws_ = 1;  ///< still to be drawn
  Motion motion_ = Motion::kStill;
  double last_look_time_ = 0;  ///< at the files on disk
  bool quit_ = false, save_window_ = false, options_applied_ = false;

  RequestPolicy requests_;
  CostSurvey survey_;
  bool costs_wait_ = true;         ///< there may be something to measure, once nobody acts
  std::size_t costs_drawn_ = 0;    ///< known moments of the technique at the last drawing of them
  double last_activity_time_ = 0;  ///< of the user
  double full_picture_ms_ = 0;     ///< the last frame's time, scaled to full resolution
  ShownPicture shown_;
  std::optional<std::uint32_t> highlighted_;  ///< cluster, in what was uploaded last
  std::deque<double> shown_times_;
  std::uint64_t frames_shown_ = 0, window_draws_ = 0;

  std::optional<RandomHand> hand_;
  double first_picture_ms_ = 0;  ///< from the program's start; 0: none yet
  double open_ms_ = 0;           ///< from asking for the file to its first picture; 0: none yet
  SceneLoader loader_;
  SequenceExport export_;
  RenderWorker
      worker_;  ///< last, with the loader: they go first, while the window still can be woken
};

}  // namespace mdk
