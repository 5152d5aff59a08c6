#include "viewer/app.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "common/trace/technique.h"
#include "formats/image_writer.h"
#include "viewer/overlays.h"
#include "viewer/picture_name.h"
#include "viewer/source_file.h"
#include "viewer/state_report.h"
#include "viewer/time_line.h"

namespace mdk {
namespace {

constexpr double kDrawSeconds = 1.0 / 60;     // never drawn more often
constexpr double kPlayingSeconds = 1.0 / 30;  // the play head moves although the picture is late
constexpr double kIdleSeconds = 1.0;
constexpr double kNoticeSeconds = 4;
constexpr int kSettlingDraws = 3;

}  // namespace

App::App(const ViewerOptions& options)
    : options_(options),
      window_(options.size.value_or(WindowSize{}),
              options.size ? SizeUnit::kExact : SizeUnit::kScaled),
      theme_(make_theme(window_.ui_scale(), window_.pixel_ratio())),
      worker_(&Window::wake) {
  if (!options_.technique.empty())
    state_.settings.technique =
        static_cast<std::size_t>(&find_technique(options_.technique) - technique_table().data());
  state_.settings.shading = options_.shading;
  if (options_.file.empty()) return;
  open(options_.file);
  if (state_.file) apply_options();
}

void App::open(const std::string& path) {
  try {
    refuse_source_file(path);
    state_.file = std::make_shared<const MdkFile>(path);
  } catch (const Error& error) {
    show_error(error);
    return;
  }
  state_.file_name = std::filesystem::path(path).filename().string();
  state_.playback = Playback(clip_times(state_.file->model()));
  state_.last_frame.reset();
  state_.last_work.reset();
  state_.history.clear();
  state_.error.clear();
  shown_ = {};
  full_picture_ms_ = 0;
  blit_.clear();
  reset_view();
  window_.set_title(state_.file_name + " - mdview");
}

void App::apply_options() {
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
  while (!quit_ && !window_.should_close()) {
    window_.wait_events(seconds_to_wait());
    const double now = clock_.seconds();
    state_.playback.advance(now - last_event_time_);
    last_event_time_ = now;
    handle_events();
    show_finished_frame();
    update_shown_rate();
    expire_notice();
    if (draw_is_due()) draw();
    if (scripted() && frames_shown_ >= options_.quit_after) quit_ = true;
  }
  finish();
  return scripted() && !state_.error.empty() ? static_cast<int>(error_code_) : 0;
}

void App::handle_events() {
  if (window_.take_activity()) redraws_ = kSettlingDraws;
  for (const KeyEvent& event : window_.take_keys())
    if (const auto action = action_for(event)) execute(*action);
  for (const std::string& path : window_.take_drops()) open(path);
}

void App::execute(const Action& action) {
  redraws_ = kSettlingDraws;
  Playback& playback = state_.playback;
  switch (action.command) {
    case Command::kPlayPause:
      playback.toggle();
      break;
    case Command::kPreviousKey:
      playback.step_key(StepDirection::kBack);
      break;
    case Command::kNextKey:
      playback.step_key(StepDirection::kForward);
      break;
    case Command::kStart:
      playback.go_to_start();
      break;
    case Command::kEnd:
      playback.go_to_end();
      break;
    case Command::kPreviousTechnique:
      step_technique(-1);
      break;
    case Command::kNextTechnique:
      step_technique(+1);
      break;
    case Command::kTechniqueByNumber:
      if (action.number < technique_table().size()) state_.settings.technique = action.number;
      break;
    case Command::kNextShading:
      next_shading();
      break;
    case Command::kFit:
      if (state_.file) state_.camera.fit(state_.file->model().bounds, picture_aspect());
      break;
    case Command::kResetView:
      reset_view();
      break;
    case Command::kSavePicture:
      save_picture();
      break;
    case Command::kSaveWindow:
      save_window_ = true;
      break;
    case Command::kTogglePanel:
      state_.panel = state_.panel == PanelMode::kShown ? PanelMode::kHidden : PanelMode::kShown;
      break;
    case Command::kToggleHelp:
      state_.help_open = !state_.help_open;
      break;
    case Command::kDismiss:
      if (state_.help_open)
        state_.help_open = false;
      else if (!state_.error.empty())
        state_.error.clear();
      else
        quit_ = true;
      break;
    case Command::kQuit:
      quit_ = true;
      break;
  }
}

void App::step_technique(int by) {
  const auto count = static_cast<int>(technique_table().size());
  const int row = static_cast<int>(state_.settings.technique) + by;
  state_.settings.technique = static_cast<std::size_t>((row + count) % count);
}

void App::next_shading() {
  const auto modes = shading_table();
  std::size_t row = 0;
  while (row < modes.size() && modes[row].mode != state_.settings.shading) ++row;
  state_.settings.shading = modes[(row + 1) % modes.size()].mode;
}

void App::reset_view() {
  if (!state_.file) return;
  const Aabb& bounds = state_.file->model().bounds;
  state_.camera.set(fit_camera(bounds, picture_aspect()), bounds);
}

void App::show_finished_frame() {
  auto frame = worker_.take_finished();
  if (!frame || frame->job.file != state_.file) return;
  redraws_ = std::max(redraws_, 1);
  const RenderJob& job = frame->job;
  if (!frame->error.empty()) {
    requests_.note_failure();
    show_error(Error(ErrorCode::kInternal, frame->error));
    return;
  }
  blit_.upload(frame->pixels, job.request.width, job.request.height);
  shown_ = {job.request.width, job.request.height, std::move(frame->pixels)};
  if (job.request.counting == Counting::kOn) {
    state_.last_work = WorkReport{job.technique, frame->stats.rays, frame->stats.counters};
    return;
  }
  state_.last_frame = FrameReport{job.technique, job.request.width, job.request.height,
                                  frame->stats, frame->structure_bytes};
  const double ms = frame->stats.time_to_image_ms();
  state_.history.add({job.technique, ms});
  const PixelRect full = picture_pixels();
  full_picture_ms_ = ms * (static_cast<double>(full.width) * full.height) /
                     (static_cast<double>(job.request.width) * job.request.height);
  shown_times_.push_back(clock_.seconds());
  ++frames_shown_;
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
  const PixelRect room = picture_pixels();
  const std::uint32_t divisor =
      picture_divisor(state_.settings.resolution, motion_, full_picture_ms_);
  RenderJob job{state_.file, state_.settings.technique, {}};
  job.request.at =
      locate_time(state_.file->model(), static_cast<std::uint32_t>(state_.playback.clip()),
                  state_.playback.time());
  job.request.camera = state_.camera.camera();
  job.request.width = std::max(1u, static_cast<std::uint32_t>(room.width) / divisor);
  job.request.height = std::max(1u, static_cast<std::uint32_t>(room.height) / divisor);
  job.request.shading = state_.settings.shading;
  return job;
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

// Waits for the picture of the state as it is, so that what is printed and saved belongs together.
void App::settle() {
  motion_ = Motion::kStill;
  bool asked = true;
  while (asked || worker_.busy()) {
    show_finished_frame();
    asked = request_picture(Repeat::kNever);
    window_.wait_events(kDrawSeconds);
  }
  show_finished_frame();
}

Layout App::layout() const {
  return make_layout(window_.width(), window_.height(), theme_.scale, state_.panel);
}

PixelRect App::picture_pixels() const {
  const Rect picture = layout().picture;
  const float ratio = window_.pixel_ratio();
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
  return static_cast<double>(pixels.width) / pixels.height;
}

double App::seconds_to_wait() const {
  const double since_draw = clock_.seconds() - last_draw_time_;
  if (redraws_ > 0 || scripted()) return std::max(0.0, kDrawSeconds - since_draw);
  if (state_.playback.playing()) return std::max(0.0, kPlayingSeconds - since_draw);
  return state_.notice.empty() ? kIdleSeconds : kNoticeSeconds / 8;
}

bool App::draw_is_due() const {
  const double since_draw = clock_.seconds() - last_draw_time_;
  if (redraws_ > 0 || scripted()) return since_draw >= kDrawSeconds;
  return state_.playback.playing() && since_draw >= kPlayingSeconds;
}

void App::draw() {
  last_draw_time_ = clock_.seconds();
  ++window_draws_;
  redraws_ = std::max(0, redraws_ - 1);
  window_.begin_frame();
  blit_.draw(picture_pixels(), window_.framebuffer_height());

  UiResult result;
  const Layout places = layout();
  if (state_.panel == PanelMode::kShown) {
    draw_side_panel(places.side_panel, theme_, state_, result);
    draw_time_line(places.time_line, theme_, state_, result);
  }
  draw_overlays(places.picture, theme_, state_, result);
  result.widgets["picture"] = places.picture;
  handle_mouse(places.picture);
  window_.end_frame();

  widgets_ = std::move(result.widgets);
  if (save_window_) save_window();
  for (const Action& action : result.actions) execute(action);
  request_picture(Repeat::kAsChosen);
  window_.present();
  // A scripted run with nothing to trace still comes to its end.
  if (scripted() && (!state_.file || requests_.failed())) ++frames_shown_;
}

void App::handle_mouse(const Rect& picture) {
  const ImGuiIO& io = ImGui::GetIO();
  motion_ = state_.playback.scrubbing() ? Motion::kDragging : Motion::kStill;
  if (io.WantCaptureMouse || !state_.file || !(picture.height > 0)) return;
  const auto held = [&](ImGuiMouseButton button) {
    return io.MouseDown[button] && io.MouseDownDuration[button] > 0;
  };
  const PictureOffset drag{static_cast<double>(io.MouseDelta.x / picture.height),
                           static_cast<double>(io.MouseDelta.y / picture.height)};
  const bool pans = held(ImGuiMouseButton_Middle) || held(ImGuiMouseButton_Right) ||
                    (held(ImGuiMouseButton_Left) && io.KeyShift);
  const bool moved = drag.x != 0 || drag.y != 0;
  if (pans || held(ImGuiMouseButton_Left)) motion_ = Motion::kDragging;
  if (pans && moved)
    state_.camera.pan(drag);
  else if (held(ImGuiMouseButton_Left) && moved)
    state_.camera.orbit(drag);

  if (io.MouseWheel != 0 && picture.contains(io.MousePos.x, io.MousePos.y)) {
    const PictureOffset pointer{
        static_cast<double>((io.MousePos.x - picture.x - picture.width / 2) / picture.height),
        static_cast<double>((io.MousePos.y - picture.y - picture.height / 2) / picture.height)};
    state_.camera.zoom(static_cast<double>(io.MouseWheel), pointer);
  }
}

void App::save_picture() {
  if (shown_.pixels.empty())
    show_notice("There is no picture to save yet");
  else
    save(shown_);
}

void App::save_window() {
  save_window_ = false;
  save(window_.read_pixels());
}

void App::save(const Picture& picture) {
  try {
    const std::string name = free_picture_name(
        state_.file ? std::filesystem::path(state_.file_name).stem().string() : "mdview");
    write_png(name, picture.width, picture.height, picture.pixels);
    show_notice("Saved " + name + " (" + std::to_string(picture.width) + " x " +
                std::to_string(picture.height) + ")");
  } catch (const Error& error) {
    show_error(error);
  }
}

void App::finish() {
  if (!options_.screenshot.empty() || options_.print_state) settle();
  if (!options_.screenshot.empty()) {
    for (int i = 0; i < kSettlingDraws; ++i) draw();  // the last frame's figures, settled
    const Picture picture = window_.read_pixels();
    write_png(options_.screenshot, picture.width, picture.height, picture.pixels);
  }
  if (options_.print_state)
    std::cout << state_json(state_, {frames_shown_, window_draws_, window_.width(),
                                     window_.height(), widgets_})
              << std::endl;
}

}  // namespace mdk
