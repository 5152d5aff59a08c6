#include "viewer/options.h"

#include <vector>

#include "common/base/error.h"
#include "preprocess/tool/command.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

WindowSize parse_window_size(std::string_view text) {
  const auto wrong = [] {
    return expected("WIDTHxHEIGHT, each side from " + std::to_string(kMinWindowSide) + " to " +
                    std::to_string(kMaxImageSide) + ", such as 1280x800");
  };
  try {
    const ImageSize size = parse_image_size(text);
    if (size.width < kMinWindowSide || size.height < kMinWindowSide) throw wrong();
    return {size.width, size.height};
  } catch (const Error&) {
    throw wrong();
  }
}

int parse_viewer_threads(std::string_view text) { return text == "0" ? 0 : parse_threads(text); }

std::string tab_ids() {
  std::string ids;
  for (const PanelTabInfo& info : panel_tab_table())
    ids += (ids.empty() ? "" : ", ") + std::string(info.id);
  return ids;
}

std::vector<Choice<CompareMode>> compare_modes() {
  std::vector<Choice<CompareMode>> choices;
  for (const CompareMode mode :
       {CompareMode::kOff, CompareMode::kSideBySide, CompareMode::kWipe, CompareMode::kDifference})
    choices.push_back({compare_mode_id(mode), mode});
  return choices;
}

void add_picture_options(Command& mdview, ViewerOptions& options, bool& play) {
  mdview.add_value("--size", "WxH", "window size (1280x800)", "", options.size, parse_window_size);
  mdview.add_value("--technique", "ID", "technique to start with, by id", "", options.technique,
                   parse_technique);
  mdview.add_value("--shading", "MODE",
                   "shading mode to start with, by id (as it was last; at first diffuse)", "",
                   options.shading, find_shading);
  mdview.add_value("--samples", "N", "samples per pixel (1)", "1", options.samples, parse_samples);
  const std::string usual = std::to_string(kOcclusionRays);
  mdview.add_value(
      "--ao", "N",
      "rays per sample for ambient occlusion, where the shading is lit (" + usual + ")", usual,
      options.occlusion_rays, parse_occlusion_rays);
  mdview.add_text("--clip", "NAME", "animation to show, by name (the first)", options.clip);
  mdview.add_value(
      "--time", "T", "seconds from the clip's start (0)", "0", options.time,
      real_where([](double x) { return x >= 0; }, "seconds from the clip's start, 0 or more"));
  mdview.add_value(
      "--theme", "dark|light", "dark or light (as it was last; at first dark)", "", options.colors,
      one_of<ColorScheme>({{"dark", ColorScheme::kDark}, {"light", ColorScheme::kLight}}));
  mdview.add_flag("--play", "start playing", play);
  mdview.add_value("--camera", "\"EYE TARGET UP FOV\"",
                   "ten numbers: eye xyz, target xyz, up xyz, vertical field of view in degrees",
                   "", options.camera, parse_camera);
  mdview.add_value("--compare", "off|side|wipe|difference",
                   "hold a second technique against the first: side, wipe or difference (off)",
                   "off", options.compare, one_of(compare_modes()));
  mdview.add_value("--against", "ID", "the second technique, by id (rebuild-bvh)", "",
                   options.against, parse_technique);
  mdview.add_value("--tab", "ID", "page of the side panel to start with: " + tab_ids() + " (view)",
                   "view", options.tab, find_panel_tab);
}

void add_machine_options(Command& mdview, ViewerOptions& options) {
  mdview.add_value("--threads", "all|N", "threads for tracing (all)", "all", options.threads,
                   parse_viewer_threads);
  mdview.add_text("--isa", "sse4|avx2|avx512|neon",
                  "use no more than sse4, avx2, avx512 or neon (the best)", options.isa);
}

void add_session_options(Command& mdview, ViewerOptions& options) {
  mdview.add_text("--screenshot", "FILE",
                  "write the whole window as PNG at the end (with --quit-after)",
                  options.screenshot);
  mdview.add_value("--quit-after", "N", "quit when N rendered frames were shown", "0",
                   options.quit_after, count_in({0, 0xffffffffu}));
  mdview.add_text("--state", "FILE",
                  "keep recent files and settings in this file (mdview/session.json in "
                  "$XDG_STATE_HOME or ~/.local/state)",
                  options.state_file);
  mdview.add_flag("--no-state",
                  "neither recall nor keep anything (so it is with --print-state and --quit-after)",
                  options.no_state);
  mdview.add_flag("--print-state", "print one JSON object on stdout at the end",
                  options.print_state);
}

}  // namespace

std::optional<ViewerOptions> parse_options(int argc, const char* const* argv, std::ostream& out) {
  ViewerOptions options;
  bool play = false;
  Command mdview("mdview",
                 "mdview: look at an animated model in an .mdk file while it is ray traced.");
  mdview.set_version("mdview " + version_text(tool_version()));
  mdview.add_text(
      "FILE", "",
      "what to open: .mdk, made by mdprep bake, or a source that it reads, such as .glb, "
      ".gltf or .fbx, baked now; files and folders can also be dropped on the window",
      options.file);
  add_picture_options(mdview, options, play);
  add_machine_options(mdview, options);
  add_session_options(mdview, options);
  if (!mdview.parse({argv + 1, argv + argc}, out)) return std::nullopt;
  if (play) options.start = StartMode::kPlaying;
  return options;
}

}  // namespace mdk
