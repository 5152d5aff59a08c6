// Options: what mdview's command line says.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>

#include "common/trace/camera.h"
#include "common/trace/shading.h"
#include "viewer/state/settings.h"

namespace mdk {

inline constexpr std::uint32_t kMinWindowSide = 64;

struct WindowSize {
  std::uint32_t width = 1280, height = 800;

  bool operator==(const WindowSize&) const = default;
};

enum class StartMode { kPaused, kPlaying };

struct ViewerOptions {
  std::string file;                    ///< empty: start without one
  std::optional<WindowSize> size;      ///< none: 1280x800, enlarged on dense displays
  std::string technique;               ///< empty: as it was last, or the table's first
  std::optional<ShadingMode> shading;  ///< none: as it was last, or diffuse
  std::optional<ColorScheme> colors;   ///< none: as it was last, or dark
  std::uint32_t samples = 1;
  std::uint32_t occlusion_rays = kOcclusionRays;
  std::string clip;  ///< empty: the file's first
  double time = 0;   ///< seconds
  StartMode start = StartMode::kPaused;
  std::optional<Camera> camera;  ///< none: fits the clip's bounds
  int threads = 0;               ///< 0: all
  std::string isa;               ///< empty: the best there is
  std::string screenshot;        ///< where to write the whole window at the end
  CompareMode compare = CompareMode::kOff;
  std::string against;  ///< technique to compare with; empty: default_against()
  PanelTab tab = PanelTab::kView;
  std::uint64_t quit_after = 0;  ///< finished frames shown; 0: stay
  bool print_state = false;
  std::string state_file;  ///< what to remember is kept there; empty: in the usual place
  bool no_state = false;   ///< nothing is remembered, and nothing recalled
};

/// Reads the command line; empty where it only asked for help or the version, which went to `out`.
/// Throws Error (kUsage).
std::optional<ViewerOptions> parse_options(int argc, const char* const* argv, std::ostream& out);

}  // namespace mdk
