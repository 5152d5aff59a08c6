#include "viewer/app.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <utility>

#include "common/trace/color.h"
#include "common/trace/shading.h"
#include "common/trace/technique.h"
#include "viewer/panel/comparison_view.h"
#include "viewer/panel/overlays.h"
#include "viewer/panel/picture_lines.h"
#include "viewer/panel/pose_panel.h"
#include "viewer/panel/time_line.h"
#include "viewer/picture/picture_job.h"
#include "viewer/state/picture_mouse.h"

namespace mdk {
namespace {

constexpr double kDrawSeconds = 1.0 / 60;     // never drawn more often
constexpr double kPlayingSeconds = 1.0 / 30;  // the play head moves although the picture is late
constexpr double kIdleSeconds = 1.0;
constexpr double kNoticeSeconds = 4;
constexpr double kCurveSeconds = 0.2;     // between drawings of a growing curve
constexpr double kTurntableSeconds = 14;  // once round
constexpr double kMappingSeconds = 0.02;  // a file that takes longer comes after the window
constexpr double kLookSeconds = 0.5;      // between looks at the files on disk

}  // namespace

App::App(const ViewerOptions& options)
    : options_(options),
      session_path_(session_path(options)),
      saved_(read_session(session_path_)),
      fonts_(static_cast<float>(saved_.settings.text_percent) / 100),
      loader_([this] { wake(); }),
      export_([this] { wake(); }),
      worker_([this] { wake(); }) {
  recall();
  if (!options_.technique.empty()) state_.settings.technique = technique_row(options_.technique);
  if (options_.shading) state_.settings.shading = *options_.shading;
  if (options_.colors) state_.settings.colors = *options_.colors;
  state_.settings.samples = options_.samples;
  state_.settings.occlusion_rays = options_.occlusion_rays;
  state_.tab = options_.tab;
  state_.compare.mode = options_.compare;
  state_.compare.against =
      options_.against.empty() ? default_against() : technique_row(options_.against);
  if (options_.random_events > 0)
    hand_.emplace(options_.random_events, options_.seed, what_lies_here());
  if (!options_.file.empty()) begin_first_picture();
  open_window();
}

// To open a window takes longer than to map a file and trace a picture of it: a worker does that
// meanwhile, in the size that the window will most likely have.
void App::begin_first_picture() {
  const WindowSize size = window_size();
  expected_shape_ = {static_cast<float>(size.width), static_cast<float>(size.height)};
  open({options_.file});
  loader_.wait(kMappingSeconds);
  show_loaded_scene();
  request_picture(Repeat::kNever);
}

WindowSize App::window_size() const {
  return options_.size.value_or(saved_.window.value_or(WindowSize{}));
}

void App::open_window() {
  window_.emplace(window_size(),
                  options_.size || saved_.window ? SizeUnit::kExact : SizeUnit::kScaled, fonts_);
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

// Text and widgets keep their size to the eye when the window comes to another display.
void App::follow_display() {
  const float scale = ui_scale(), ratio = shape().pixel_ratio;
  if (scale == theme_.scale && ratio == theme_.pixel_ratio) return;
  theme_ = make_theme(scale, ratio);
  window_->renew_fonts();
  redraws_ = kSettlingDraws;
}

void App::show_loaded_scene() {
  state_.baking = loader_.progress();
  auto scene = loader_.take_loaded();
  if (!scene) return;
  redraws_ = kSettlingDraws;
  if (scene->error) {
    show_error(*scene->error);
    return;
  }
  state_.file = std::move(scene->file);
  state_.path = scene->path;
  state_.file_name = std::filesystem::path(scene->path).filename().string();
  state_.forget_frames();
  costs_wait_ = true;
  state_.error.clear();
  shown_.clear();
  state_.clusters = ClusterView(state_.file->model());
  state_.picked.reset();
  state_.residuals = {};
  full_picture_ms_ = 0;
  name_window();
  if (scene->is_again) {
    state_.playback.set_clips(clip_times(state_.file->model()));
    state_.hand = rest_pose_of(state_.file->model());
    show_notice("Loaded " + state_.file_name + " again: it has changed");
    return;
  }
  open_ms_ = 0;
  state_.playback = Playback(clip_times(state_.file->model()));
  state_.playback.set_loop(saved_.loop);
  state_.playback.set_speed(saved_.speed);
  remember_file(state_.recent_files, loader_.paths());
  remember();
  state_.hand = rest_pose_of(state_.file->model());
  if (blit_) blit_->clear();
  reset_view();
  apply_options();
}

void App::look_for_changes() {
  const double now = clock_.seconds();
  if (now < last_look_time_ + kLookSeconds) return;
  last_look_time_ = now;
  loader_.look_for_changes();
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

int App::run() {
  while (!quit_ && !window_->should_close()) {
    window_->wait_events(seconds_to_wait());
    const double now = clock_.seconds();
    pass_time(now - last_event_time_);
    last_event_time_ = now;
    if (hand_) play_random_event();
    handle_events();
    look_for_changes();
    show_loaded_scene();
    show_finished_frame();
    show_export();
    update_shown_rate();
    expire_notice();
    if (draw_is_due()) draw();
    survey_costs();
    if (scripted() && frames_shown_ >= options_.quit_after) quit_ = true;
  }
  finish();
  return scripted() && !state_.error.empty() ? static_cast<int>(error_code_) : 0;
}

void App::pass_time(double seconds) {
  state_.playback.advance(seconds);
  if (state_.turntable && motion_ == Motion::kStill)
    state_.camera.orbit({2 * seconds / kTurntableSeconds, 0});  // a drag of 1 is half a turn
}

void App::handle_events() {
  if (window_->take_activity()) {
    redraws_ = kSettlingDraws;
    last_activity_time_ = clock_.seconds();
    costs_wait_ = true;
  }
  for (const KeyEvent& event : window_->take_keys())
    if (const auto action = action_for(event)) execute(*action);
  if (const auto drops = window_->take_drops(); !drops.empty()) {
    state_.file_menu.reset();
    open(drops);
  }
}

void App::show_finished_frame() {
  auto frame = worker_.take_finished();
  if (!frame || frame->job.file != state_.file) return;
  const RenderJob& job = frame->job;
  if (job.survey && frame->error.empty()) {
    survey_.take(*frame, state_.cost_curves);
    return;
  }
  redraws_ = std::max(redraws_, 1);
  if (!frame->error.empty()) {
    requests_.note_failure();
    show_error(Error(ErrorCode::kInternal, frame->error));
    return;
  }
  if (note_costs(*frame, state_)) {
    const double ms = frame->stats.time_to_image_ms() +
                      (frame->second ? frame->second->stats.time_to_image_ms() : 0);
    const PixelRect full = picture_pixels();
    full_picture_ms_ = ms * (static_cast<double>(full.width) * full.height) /
                       (static_cast<double>(job.request.width) * job.request.height);
    shown_times_.push_back(clock_.seconds());
    ++frames_shown_;
  }
  shown_.show(std::move(*frame), state_.compare);
  upload_picture();
}

// What stands out does so in the window alone: the picture itself, which is saved, stays.
void App::upload_picture() {
  highlighted_ = state_.clusters.hovered;
  const Picture& plain = shown_.picture();
  if (plain.pixels.empty()) return;
  if (!highlighted_) {
    blit_->upload(plain.pixels, plain.width, plain.height);
    return;
  }
  const Cluster& cluster = state_.model()->clusters[*highlighted_];
  const Picture marked = shown_.with(
      {cluster.first_triangle, cluster.triangle_count, pack_srgb(cluster_color(*highlighted_))});
  blit_->upload(marked.pixels, marked.width, marked.height);
}

void App::update_shown_rate() {
  const double now = clock_.seconds();
  while (!shown_times_.empty() && shown_times_.front() < now - 1) shown_times_.pop_front();
  const auto rate = static_cast<double>(shown_times_.size());
  if (rate == 0 && state_.shown_per_second != 0) redraws_ = std::max(redraws_, 1);
  state_.shown_per_second = rate;
}

void App::expire_notice() {
  if (state_.notice.empty() || clock_.seconds() < notice_until_) return;
  state_.notice.clear();
  redraws_ = kSettlingDraws;
}

RenderJob App::wanted_job() const {
  return job_at_divisor(picture_divisor(state_.settings.resolution, motion_, full_picture_ms_));
}

RenderJob App::job_at_divisor(std::uint32_t divisor) const {
  PixelRect room = picture_pixels();
  if (state_.compare.mode == CompareMode::kSideBySide) room.width /= 2;
  return picture_job(state_, std::max(1u, static_cast<std::uint32_t>(room.width) / divisor),
                     std::max(1u, static_cast<std::uint32_t>(room.height) / divisor));
}

bool App::request_picture(Repeat repeat) {
  if (!state_.file) return false;
  const RequestPolicy::Situation situation{
      clock_.seconds(), worker_.busy(), state_.settings.count_work,
      repeat == Repeat::kAsChosen && (state_.settings.keep_tracing || scripted())};
  auto job = requests_.next(wanted_job(), situation);
  if (job) worker_.request(std::move(*job));
  return job.has_value();
}

void App::survey_costs() {
  const bool at_rest = !state_.moves() && motion_ == Motion::kStill && !state_.hand.active &&
                       !worker_.busy() && redraws_ == 0;
  if (!state_.file || scripted() || requests_.failed() || state_.settings.keep_tracing) return;
  if (!at_rest || clock_.seconds() < last_activity_time_ + CostSurvey::kRestSeconds) return;
  const Playback& playback = state_.playback;
  const std::size_t technique = state_.settings.technique;
  const std::uint32_t divisor =
      picture_divisor(Resolution::kAuto, Motion::kDragging, full_picture_ms_);
  auto job = survey_.next(job_at_divisor(divisor), static_cast<std::uint32_t>(playback.clip()),
                          playback.clips()[playback.clip()].key_times, state_.cost_curves);
  costs_wait_ = job.has_value();
  if (job) worker_.request(std::move(*job));
  // The curve is seen to grow, but drawing takes no time from measuring.
  const std::size_t known = state_.cost_curves.known(technique);
  const double now = clock_.seconds();
  if (known != costs_drawn_ && (!job || now >= last_draw_time_ + kCurveSeconds)) {
    costs_drawn_ = known;
    redraws_ = 1;
  }
}

// Waits for the picture of the state as it is, so that what is printed and saved belongs together.
// A user who quits does not wait for a bake.
void App::settle() {
  motion_ = Motion::kStill;
  while (true) {
    const bool busy = worker_.busy() || (scripted() && loader_.busy());
    show_loaded_scene();
    show_finished_frame();
    if (!request_picture(Repeat::kNever) && !busy) return;
    window_->wait_events(kDrawSeconds);
  }
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
  const auto pixels = [&](float length) {
    return std::clamp(static_cast<int>(std::lround(length * ratio)), 1,
                      static_cast<int>(kMaxImageSide));
  };
  return {static_cast<int>(std::lround(picture.x * ratio)),
          static_cast<int>(std::lround(picture.y * ratio)), pixels(picture.width),
          pixels(picture.height)};
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
  if (costs_wait_ && state_.file) return CostSurvey::kRestSeconds;
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
  UiResult result;
  const Layout places = layout();
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
  motion_ = steered || state_.playback.scrubbing() ? Motion::kDragging : Motion::kStill;
  if (shown_.arrange(state_.compare) || highlighted_ != state_.clusters.hovered) upload_picture();
  blit_->draw(picture_pixels(), window_->framebuffer_height());
  window_->end_frame();

  widgets_ = std::move(result.widgets);
  if (save_window_) save_window();
  for (const Action& action : result.actions) execute(action);
  if (!result.open_paths.empty()) open(result.open_paths);
  request_picture(Repeat::kAsChosen);
  window_->present();
  if (!shown_.picture().pixels.empty()) {
    if (first_picture_ms_ == 0) first_picture_ms_ = since_start_.milliseconds();
    if (open_ms_ == 0) open_ms_ = since_asked_.milliseconds();
  }
  // A scripted run with nothing to trace still comes to its end.
  const bool nothing_comes = !loader_.busy() && (!state_.file || requests_.failed());
  if (scripted() && nothing_comes && !quit_) ++frames_shown_;
}

}  // namespace mdk
