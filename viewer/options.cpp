#include "viewer/options.h"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "common/base/error.h"
#include "common/trace/technique.h"

namespace mdk {
namespace {

Error usage(const std::string& sentence) { return {ErrorCode::kUsage, sentence}; }

std::optional<std::uint32_t> parse_side(std::string_view text) {
  std::uint32_t side = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (failure != std::errc{} || end != text.data() + text.size()) return {};
  if (side < kMinWindowSide || side > kMaxImageSide) return {};
  return side;
}

WindowSize parse_size(const std::string& text) {
  const auto cross = text.find('x');
  if (cross != std::string::npos) {
    const auto width = parse_side(std::string_view(text).substr(0, cross));
    const auto height = parse_side(std::string_view(text).substr(cross + 1));
    if (width && height) return {*width, *height};
  }
  throw usage("--size \"" + text + "\": give WIDTHxHEIGHT, each side from " +
              std::to_string(kMinWindowSide) + " to " + std::to_string(kMaxImageSide) +
              ", such as 1280x800");
}

Camera parse_camera(const std::string& text) {
  constexpr std::string_view kBetween = " ,\t\n";
  std::array<float, 10> n{};
  std::size_t count = 0;
  std::string_view rest = text;
  while (true) {
    const auto start = rest.find_first_not_of(kBetween);
    if (start == std::string_view::npos) break;
    rest.remove_prefix(start);
    float value = 0;
    const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    const auto length = static_cast<std::size_t>(end - rest.data());
    const bool ends_well =
        length == rest.size() || kBetween.find(rest[length]) != std::string_view::npos;
    if (failure != std::errc{} || !ends_well || count == n.size()) {
      count = n.size() + 1;
      break;
    }
    n[count++] = value;
    rest.remove_prefix(length);
  }
  if (count != n.size())
    throw usage(
        "--camera \"" + text +
        "\": give ten numbers: eye xyz, target xyz, up xyz, vertical field of view in degrees");
  const Camera camera{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, n[9]};
  make_pinhole_rays(camera, 1, 1);  // refuses one that sees nothing
  return camera;
}

ColorScheme parse_theme(const std::string& text) {
  if (text == "dark") return ColorScheme::kDark;
  if (text == "light") return ColorScheme::kLight;
  throw usage("--theme \"" + text + "\": give dark or light");
}

std::string tab_ids() {
  std::string ids;
  for (const PanelTabInfo& info : panel_tab_table())
    ids += (ids.empty() ? "" : ", ") + std::string(info.id);
  return ids;
}

void check(const ViewerOptions& options) {
  if (!options.technique.empty()) find_technique(options.technique);
  if (!options.against.empty()) find_technique(options.against);
  if (!std::isfinite(options.time) || options.time < 0)
    throw usage("--time: give seconds from the clip's start, 0 or more");
  if (options.threads < 0) throw usage("--threads: give 0 for all cores, or how many");
}

}  // namespace

std::optional<ViewerOptions> parse_options(int argc, const char* const* argv, std::ostream& out) {
  ViewerOptions options;
  std::string size, shading, camera, theme, tab, compare;
  bool play = false;

  CLI::App app{"mdview: look at an animated model in an .mdk file while it is ray traced.",
               "mdview"};
  app.set_version_flag("--version", "mdview " MDK_VERSION);
  app.add_option(
      "FILE", options.file,
      "what to open: .mdk, made by mdprep bake, or a source that it reads, such as .glb, "
      ".gltf or .fbx, baked now; files and folders can also be dropped on the window");
  app.add_option("--size", size, "window size WxH (1280x800)");
  app.add_option("--technique", options.technique, "technique to start with, by id");
  app.add_option("--shading", shading,
                 "shading mode to start with, by id (as it was last; at first diffuse)");
  app.add_option("--samples", options.samples, "samples per pixel (1)")
      ->check(CLI::Range(1u, kMostSamples));
  app.add_option("--ao", options.occlusion_rays,
                 "rays per sample for ambient occlusion, where the shading is lit (" +
                     std::to_string(kOcclusionRays) + ")")
      ->check(CLI::Range(0u, kMostOcclusionRays));
  app.add_option("--clip", options.clip, "animation to show, by name (the first)");
  app.add_option("--time", options.time, "seconds from the clip's start (0)");
  app.add_option("--theme", theme, "dark or light (as it was last; at first dark)");
  app.add_flag("--play", play, "start playing");
  app.add_option("--camera", camera,
                 "ten numbers: eye xyz, target xyz, up xyz, vertical field of view in degrees");
  app.add_option("--compare", compare,
                 "hold a second technique against the first: side, wipe or difference (off)");
  app.add_option("--against", options.against, "the second technique, by id (rebuild-bvh)");
  app.add_option("--tab", tab, "page of the side panel to start with: " + tab_ids() + " (view)");
  app.add_option("--threads", options.threads, "threads for tracing (all)");
  app.add_option("--isa", options.isa, "use no more than sse4, avx2, avx512 or neon (the best)");
  app.add_option("--screenshot", options.screenshot,
                 "write the whole window as PNG at the end (with --quit-after)");
  app.add_option("--quit-after", options.quit_after, "quit when N rendered frames were shown");
  app.add_option("--state", options.state_file,
                 "keep recent files and settings in this file (mdview/session.json in "
                 "$XDG_STATE_HOME or ~/.local/state)");
  app.add_flag("--no-state", options.no_state,
               "neither recall nor keep anything (so it is with --print-state and --quit-after)");
  app.add_option("--random-events", options.random_events, "")->group("");
  app.add_option("--seed", options.seed, "")->group("");
  app.add_flag("--print-state", options.print_state, "print one JSON object on stdout at the end");

  try {
    app.parse(argc, const_cast<char**>(argv));
  } catch (const CLI::CallForHelp&) {
    out << app.help();
    return {};
  } catch (const CLI::CallForVersion& version) {
    out << version.what() << "\n";
    return {};
  } catch (const CLI::ParseError& error) {
    throw usage(std::string(error.what()) + " (see mdview --help)");
  }

  if (!size.empty()) options.size = parse_size(size);
  if (!shading.empty()) options.shading = find_shading(shading);
  if (!camera.empty()) options.camera = parse_camera(camera);
  if (!theme.empty()) options.colors = parse_theme(theme);
  if (!compare.empty()) options.compare = find_compare_mode(compare);
  if (!tab.empty()) options.tab = find_panel_tab(tab);
  if (play) options.start = StartMode::kPlaying;
  check(options);
  return options;
}

}  // namespace mdk
