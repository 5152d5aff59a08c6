// App: what keys, buttons, menus and drops ask for.
#include <filesystem>

#include "common/trace/technique.h"
#include "formats/files/image_writer.h"
#include "viewer/app/app.h"

namespace mdk {

template <class Work>
void App::show_outcome(const Work& work) {
  try {
    show_notice(work());
  } catch (const Error& error) {
    show_error(error);
  }
}

void App::execute(const Action& action) {
  redraws_ = kSettlingDraws;
  Playback& playback = state_.playback;
  switch (action.command) {
    case Command::kPlayPause:
      return playback.toggle();
    case Command::kPreviousKey:
      return playback.step_key(StepDirection::kBack);
    case Command::kNextKey:
      return playback.step_key(StepDirection::kForward);
    case Command::kStart:
      return playback.go_to_start();
    case Command::kEnd:
      return playback.go_to_end();
    case Command::kPreviousTechnique:
      return state_.settings.step_technique(-1);
    case Command::kNextTechnique:
      return state_.settings.step_technique(+1);
    case Command::kTechniqueByNumber:
      if (action.number < technique_table().size()) state_.settings.technique = action.number;
      break;
    case Command::kNextShading:
      return state_.settings.next_shading();
    case Command::kNextCompare:
      state_.compare.mode = next_compare_mode(state_.compare.mode);
      break;
    case Command::kShowAll:
      return state_.clusters.show_all();
    case Command::kFit:
      if (state_.file) state_.camera.fit(state_.file->model().bounds, picture_aspect());
      break;
    case Command::kResetView:
      return reset_view();
    case Command::kSavePicture:
      return save_picture();
    case Command::kSaveWindow:
      save_window_ = true;
      break;
    case Command::kCopyCommand:
      return copy_render_command();
    case Command::kExport:
      return export_sequence();
    case Command::kCancelExport:
      return export_.cancel();
    case Command::kToggleFileMenu:
      return toggle_file_menu();
    case Command::kKeepBaked:
      if (state_.file) show_outcome([this] { return document_.keep_baked(); });
      break;
    case Command::kCancelBake:
      return document_.cancel();
    case Command::kBeginRange:
      return playback.begin_range_here();
    case Command::kEndRange:
      return playback.end_range_here();
    case Command::kClearRange:
      return playback.clear_range();
    case Command::kToggleTurntable:
      state_.turntable = !state_.turntable;
      break;
    case Command::kToggleColors:
      return state_.settings.toggle_colors();
    case Command::kLargerText:
      return state_.settings.step_text_size(+1);
    case Command::kSmallerText:
      return state_.settings.step_text_size(-1);
    case Command::kTogglePanel:
      state_.panel = state_.panel == PanelMode::kShown ? PanelMode::kHidden : PanelMode::kShown;
      break;
    case Command::kToggleHelp:
      state_.help_open = !state_.help_open;
      break;
    case Command::kDismiss:
      return dismiss();
    case Command::kQuit:
      quit_ = true;
      break;
  }
}

void App::toggle_file_menu() {
  if (state_.file_menu)
    state_.file_menu.reset();
  else
    state_.file_menu = FileMenu{"Open", state_.recent_files, ""};
}

void App::dismiss() {
  if (state_.help_open)
    state_.help_open = false;
  else if (state_.file_menu)
    state_.file_menu.reset();
  else if (!state_.error.empty())
    state_.error.clear();
  else if (state_.baking)
    document_.cancel();
  else if (export_.busy())
    export_.cancel();
  else
    quit_ = true;
}

void App::reset_view() {
  if (!state_.file) return;
  const Aabb& bounds = state_.file->model().bounds;
  state_.camera.set(fit_camera(bounds, picture_aspect()), bounds);
}

std::string App::render_command_of_picture() const {
  if (!state_.file || state_.hand.active || state_.clusters.part()) return {};
  const Playback& playback = state_.playback;
  return render_command(scheduler_.current_job(picture_space()), state_.path,
                        playback.clips()[playback.clip()].name, playback.time());
}

void App::copy_render_command() {
  if (!state_.file) return;
  const std::string command = render_command_of_picture();
  if (!command.empty()) window_->set_clipboard(command);
  show_notice(
      command.empty()
          ? "No mdprep command makes this picture: it is posed by hand, or parts are left out"
          : "Copied the mdprep command that renders this picture");
}

void App::open(const std::vector<std::string>& paths) {
  since_asked_ = {};
  try {
    document_.open(paths);
  } catch (const Error& error) {
    show_error(error);
  }
}

void App::export_sequence() {
  if (!state_.file || export_.busy()) return;
  if (state_.hand.active) {
    show_notice("Only clips are exported: the model is posed by hand");
    return;
  }
  const Playback& playback = state_.playback;
  const TimeRange played = playback.played();
  ExportOrder order;
  order.picture = scheduler_.full_job(picture_space());
  order.keys = keys_within(state_.file->model(), static_cast<std::uint32_t>(playback.clip()),
                           played.begin, played.end);
  order.kind = state_.export_settings.kind;
  order.stem = std::filesystem::path(state_.file_name).stem().string();
  export_.start(std::move(order));
}

void App::show_export() {
  state_.exporting = export_.progress();
  const auto result = export_.take_result();
  if (!result) return;
  if (result->error)
    show_error(*result->error);
  else
    show_notice(result->sentence);
}

void App::save_picture() {
  if (shown_.picture().pixels.empty())
    show_notice("There is no picture to save yet");
  else
    save(shown_.picture());
}

void App::save(const Picture& picture) {
  show_outcome([&] {
    const std::string name = free_picture_name(
        state_.file ? std::filesystem::path(state_.file_name).stem().string() : "mdview");
    write_png(name, picture.width, picture.height, picture.pixels);
    return "Saved " + name + " (" + std::to_string(picture.width) + " x " +
           std::to_string(picture.height) + ")";
  });
}

Picture App::window_picture() const {
  const PixelRect pixels = window_->framebuffer();
  return {static_cast<std::uint32_t>(pixels.width), static_cast<std::uint32_t>(pixels.height),
          window_->read_pixels()};
}

}  // namespace mdk
