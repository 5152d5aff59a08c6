// App: the viewer's loop. Events change the ViewState; a picture of it is asked of the worker; the
// window is drawn when something is new, and sleeps when nothing is.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/stopwatch.h"
#include "viewer/app/document.h"
#include "viewer/app/scheduler.h"
#include "viewer/app/session.h"
#include "viewer/options.h"
#include "viewer/panel/panel.h"
#include "viewer/picture/export.h"
#include "viewer/picture/shown_picture.h"
#include "viewer/window/fonts.h"
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

  void begin_first_picture();
  void open_window();
  void name_window();
  void wake();
  void remember() const;

  void update_document();
  void apply_options();
  void show_error(const Error& error);
  void show_notice(const std::string& sentence);
  /// Shows the sentence that `work` returns, or the error it ends with.
  template <class Work>
  void show_outcome(const Work& work);
  void expire_notice();

  void pass_time();
  void handle_events();
  void execute(const Action& action);
  void dismiss();
  void toggle_file_menu();
  void open(const std::vector<std::string>& paths);
  void reset_view();
  void export_sequence();
  void show_export();
  std::string render_command_of_picture() const;  // empty without a file
  void copy_render_command();
  void save_picture();
  void save(const Picture& picture);
  Picture window_picture() const;

  void show_finished_frame();
  void upload_picture();
  void settle();
  void finish();

  WindowSize window_size() const;
  WindowShape shape() const;
  float ui_scale() const;
  Layout layout() const;
  PixelRect picture_pixels() const;
  PictureSpace picture_space() const;
  double picture_aspect() const;
  double seconds_to_wait() const;
  bool draw_is_due() const;
  void draw();
  void follow_display();

  bool scripted() const { return options_.quit_after > 0; }

  Stopwatch since_start_;
  ViewerOptions options_;
  std::string session_path_;  ///< empty: nothing is kept
  SavedSession saved_;
  WindowShape expected_shape_;  ///< while there is no window
  FontBook fonts_;
  std::optional<Window> window_;  // before the threads below, which wake it
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
  bool quit_ = false, save_window_ = false, options_applied_ = false;

  ShownPicture shown_;
  std::optional<std::uint32_t> highlighted_;  ///< cluster, in what was uploaded last
  std::uint64_t frames_shown_ = 0, window_draws_ = 0;
  double first_picture_ms_ = 0;  ///< from the program's start; 0: none yet
  double open_ms_ = 0;           ///< from asking for the file to its first picture; 0: none yet

  // Last, as their threads wake the window to their end.
  Document document_;
  SequenceExport export_;
  Scheduler scheduler_;
};

}  // namespace mdk
