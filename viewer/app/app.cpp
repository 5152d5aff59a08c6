#include "viewer/app/app.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include "common/trace/color.h"
#include "formats/files/image_writer.h"
#include "viewer/app/state_report.h"

namespace mdk {
namespace {

constexpr double kDrawSeconds = 1.0 / 60;     // never drawn more often
constexpr double kPlayingSeconds = 1.0 / 30;  // the play head moves although the picture is late
constexpr double kIdleSeconds = 1.0;
constexpr double kNoticeSeconds = 4;
constexpr double kTurntableSeconds = 14;  // once round
constexpr double kMappingSeconds = 0.02;  // a file that takes longer comes after the window

}  // namespace

App::App(const ViewerOptions& options)
    : options_(options),
      session_path_(session_path(options)),
      saved_(read_session(session_path_)),
      fonts_(static_cast<float>(saved_.settings.text_percent) / 100),
      document_(state_, [this] { wake(); }),
      export_([this] { wake(); }),
      scheduler_(state_, scripted() ? RunMode::kScripted : RunMode::kInteractive,
                 [this] { wake(); }) {
  recall(saved_, state_);
  state_.export_settings.films_possible = can_export_films();
  if (!options_.technique.empty()) state_.settings.technique = technique_row(options_.technique);
  if (options_.shading) state_.settings.shading = *options_.shading;
  if (options_.colors) state_.settings.colors = *options_.colors;
  state_.settings.samples = options_.samples;
  state_.settings.occlusion_rays = options_.occlusion_rays;
  state_.tab = options_.tab;
  state_.compare.mode = options_.compare;
  state_.compare.against =
      options_.against.empty() ? default_against() : technique_row(options_.against);
  if (!options_.file.empty()) begin_first_picture();
  open_window();
}

// To open a window takes longer than to map a file and trace a picture of it: a worker does that
// meanwhile, in the size that the window will have.
void App::begin_first_picture() {
  const WindowSize size = window_size();
  expected_shape_ = {static_cast<float>(size.width), static_cast<float>(size.height)};
  open({options_.file});
  document_.wait(kMappingSeconds);
  update_document();
  scheduler_.request_picture(picture_space(), clock_.seconds(), Scheduler::Repeat::kNever);
}

WindowSize App::window_size() const {
  return options_.size.value_or(saved_.window.value_or(WindowSize{}));
}

void App::open_window() {
  const WindowSize size = window_size();
  const bool is_chosen = options_.size || saved_.window;
  window_.emplace(WindowSetup{size.width, size.height, kMinWindowSide,
                              is_chosen ? SizeUnit::kExact : SizeUnit::kScaled},
                  fonts_);
  can_wake_ = true;
  theme_ = make_theme(ui_scale(), shape().pixel_ratio);
  blit_.emplace();
  clock_ = {};
  name_window();
  if (state_.file) remember();
}

void App::name_window() {
  if (window_ && state_.file) window_->set_title(state_.file_name + " - mdview");
}

void App::wake() {
  if (can_wake_) Window::wake();
}

void App::remember() const {
  if (session_path_.empty() || !window_) return;
  const auto side = [](float length) {
    return std::clamp(static_cast<std::uint32_t>(length), kMinWindowSide, kMaxImageSide);
  };
  const WindowShape window = window_->shape();
  write_session(session_to_keep(state_, {side(window.width), side(window.height)}), session_path_);
}

void App::update_document() {
  const auto scene = document_.update();
  if (!scene) return;
  redraws_ = kSettlingDraws;
  if (scene->error) {
    show_error(*scene->error);
    return;
  }
  scheduler_.start_again();
  shown_.clear();
  name_window();
  if (scene->is_again) {
    show_notice("Loaded " + state_.file_name + " again: it has changed");
    return;
  }
  open_ms_ = 0;
  remember();
  if (blit_) blit_->clear();
  reset_view();
  apply_options();
}

void App::apply_options() {
  if (std::exchange(options_applied_, true)) return;
  if (options_.camera) state_.camera.set(*options_.camera, state_.file->model().bounds);
  if (!options_.clip.empty() && !state_.playback.set_clip(options_.clip)) {
    std::string sentence = "there is no clip \"" + options_.clip + "\"; this file has";
    for (const ClipTimes& clip : state_.playback.clips()) sentence += " \"" + clip.name + "\"";
    show_error(Error(ErrorCode::kUsage, options_.file + ": " + sentence));
  }
  state_.playback.seek(options_.time);
  if (options_.start == StartMode::kPlaying) state_.playback.play();
}

void App::show_error(const Error& error) {
  state_.error = error.what();
  error_code_ = error.code();
  redraws_ = kSettlingDraws;
  std::cerr << "mdview: " << error.what() << "\n";
}

void App::show_notice(const std::string& sentence) {
  state_.notice = sentence;
  notice_until_ = clock_.seconds() + kNoticeSeconds;
  redraws_ = kSettlingDraws;
}

void App::expire_notice() {
  if (state_.notice.empty() || clock_.seconds() < notice_until_) return;
  state_.notice.clear();
  redraws_ = kSettlingDraws;
}

int App::run() {
  while (!quit_ && !window_->should_close()) {
    window_->wait_events(seconds_to_wait());
    pass_time();
    handle_events();
    document_.look_for_changes(clock_.seconds());
    update_document();
    show_finished_frame();
    show_export();
    if (scheduler_.update_rate(clock_.seconds())) redraws_ = std::max(redraws_, 1);
    expire_notice();
    if (draw_is_due()) draw();
    if (redraws_ == 0 && scheduler_.survey(picture_space(), clock_.seconds())) redraws_ = 1;
    if (scripted() && frames_shown_ >= options_.quit_after) quit_ = true;
  }
  finish();
  return scripted() && !state_.error.empty() ? static_cast<int>(error_code_) : 0;
}

void App::pass_time() {
  const double now = clock_.seconds();
  const double seconds = now - std::exchange(last_event_time_, now);
  state_.playback.advance(seconds);
  if (state_.turntable && scheduler_.motion() == Motion::kStill)
    state_.camera.orbit({2 * seconds / kTurntableSeconds, 0});  // a drag of 1 is half a turn
}

void App::handle_events() {
  if (window_->take_activity()) {
    redraws_ = kSettlingDraws;
    scheduler_.note_activity(clock_.seconds());
  }
  for (const KeyEvent& event : window_->take_keys())
    if (const auto action = action_for(event)) execute(*action);
  if (const auto drops = window_->take_drops(); !drops.empty()) {
    state_.file_menu.reset();
    open(drops);
  }
}

void App::show_finished_frame() {
  auto frame = scheduler_.take_finished(picture_space(), clock_.seconds());
  if (!frame) return;
  redraws_ = std::max(redraws_, 1);
  if (!frame->error.empty()) {
    show_error(Error(ErrorCode::kInternal, frame->error));
    return;
  }
  if (frame->job.request.counting == Counting::kOff) ++frames_shown_;
  shown_.show(std::move(*frame), state_.compare);
  upload_picture();
}

// What stands out does so in the window alone: the picture itself, which is saved, stays.
void App::upload_picture() {
  highlighted_ = state_.clusters.hovered;
  const auto upload = [this](const Picture& picture) {
    blit_->upload(picture.pixels, picture.width, picture.height);
  };
  if (shown_.picture().pixels.empty()) return;
  if (!highlighted_) {
    upload(shown_.picture());
    return;
  }
  const Cluster& cluster = state_.model()->clusters[*highlighted_];
  upload(shown_.with(
      {cluster.first_triangle, cluster.triangle_count, pack_srgb(cluster_color(*highlighted_))}));
}

WindowShape App::shape() const { return window_ ? window_->shape() : expected_shape_; }

float App::ui_scale() const {
  return shape().ui_scale * static_cast<float>(state_.settings.text_percent) / 100;
}

Layout App::layout() const {
  const WindowShape window = shape();
  return make_layout(window.width, window.height, ui_scale(), state_.panel);
}

PixelRect App::picture_pixels() const {
  const Rect picture = layout().picture;
  const float ratio = shape().pixel_ratio;
  const auto pixels = [&](float length) { return static_cast<int>(std::lround(length * ratio)); };
  const auto side = [&](float length) {
    return std::clamp(pixels(length), 1, static_cast<int>(kMaxImageSide));
  };
  return {pixels(picture.x), pixels(picture.y), side(picture.width), side(picture.height)};
}

PictureSpace App::picture_space() const {
  const PixelRect pixels = picture_pixels();
  return {static_cast<std::uint32_t>(pixels.width), static_cast<std::uint32_t>(pixels.height)};
}

double App::picture_aspect() const {
  const PixelRect pixels = picture_pixels();
  const int pictures = state_.compare.mode == CompareMode::kSideBySide ? 2 : 1;
  return static_cast<double>(pixels.width) / pictures / pixels.height;
}

double App::seconds_to_wait() const {
  const double since_draw = clock_.seconds() - last_draw_time_;
  if (redraws_ > 0 || scripted()) return std::max(0.0, kDrawSeconds - since_draw);
  if (state_.moves()) return std::max(0.0, kPlayingSeconds - since_draw);
  if (scheduler_.has_to_survey() && state_.file) return CostSurvey::kRestSeconds;
  return state_.notice.empty() ? kIdleSeconds : kNoticeSeconds / 8;
}

bool App::draw_is_due() const {
  const double since_draw = clock_.seconds() - last_draw_time_;
  if (redraws_ > 0 || scripted()) return since_draw >= kDrawSeconds;
  return state_.moves() && since_draw >= kPlayingSeconds;
}

void App::draw() {
  last_draw_time_ = clock_.seconds();
  ++window_draws_;
  redraws_ = std::max(0, redraws_ - 1);
  follow_display();
  set_colors(state_.settings.colors);
  window_->begin_frame();
  const Layout places = layout();
  UiResult result;
  state_.clusters.hovered.reset();
  if (state_.panel == PanelMode::kShown) {
    draw_side_panel(places.side_panel, theme_, state_, result);
    draw_time_line(places.time_line, theme_, state_, result);
    draw_pose_panel(places.picture, theme_, state_, result);
  }
  draw_picture_lines(places.picture, theme_, state_);
  draw_comparison(places.picture, theme_, state_, result);
  draw_overlays(places.picture, theme_, state_, result);
  result.widgets["picture"] = places.picture;
  const bool steered = state_.file && steer_by_mouse(state_.camera, places.picture);
  if (pick_by_mouse(state_, places.picture)) redraws_ = kSettlingDraws;
  scheduler_.set_motion(steered || state_.playback.scrubbing() ? Motion::kDragging
                                                               : Motion::kStill);
  if (shown_.arrange(state_.compare) || highlighted_ != state_.clusters.hovered) upload_picture();
  blit_->draw(picture_pixels(), window_->framebuffer().height);
  window_->end_frame();

  widgets_ = std::move(result.widgets);
  if (std::exchange(save_window_, false)) save(window_picture());
  for (const Action& action : result.actions) execute(action);
  if (!result.open_paths.empty()) open(result.open_paths);
  scheduler_.request_picture(picture_space(), clock_.seconds(), Scheduler::Repeat::kAsChosen);
  window_->present();
  if (!shown_.picture().pixels.empty()) {
    if (first_picture_ms_ == 0) first_picture_ms_ = since_start_.milliseconds();
    if (open_ms_ == 0) open_ms_ = since_asked_.milliseconds();
  }
  // A scripted run with nothing to trace still comes to its end.
  const bool nothing_comes = !document_.busy() && (!state_.file || scheduler_.failed());
  if (scripted() && nothing_comes && !quit_) ++frames_shown_;
}

// Text and widgets keep their size to the eye when the window comes to another display.
void App::follow_display() {
  const float scale = ui_scale(), ratio = shape().pixel_ratio;
  if (scale == theme_.scale && ratio == theme_.pixel_ratio) return;
  theme_ = make_theme(scale, ratio);
  window_->renew_fonts();
  redraws_ = kSettlingDraws;
}

// Waits for the picture of the state as it is, so that what is printed and saved belongs together.
// A user who quits does not wait for a bake.
void App::settle() {
  scheduler_.set_motion(Motion::kStill);
  while (true) {
    const bool busy = scheduler_.busy() || (scripted() && document_.busy());
    update_document();
    show_finished_frame();
    const bool asked =
        scheduler_.request_picture(picture_space(), clock_.seconds(), Scheduler::Repeat::kNever);
    if (!asked && !busy) return;
    window_->wait_events(kDrawSeconds);
  }
}

void App::finish() {
  remember();
  if (!options_.screenshot.empty() || options_.print_state) settle();
  if (!options_.screenshot.empty()) {
    for (int i = 0; i < kSettlingDraws; ++i) draw();  // the last frame's figures, settled
    const Picture picture = window_picture();
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
