// Settings: what the user has chosen, apart from the file, its time and the view.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "common/trace/shading.h"

namespace mdk {

/// Row of technique_table(). Throws Error (kUsage) for an unknown id.
std::size_t technique_row(std::string_view id);

enum class ColorScheme { kDark, kLight };

/// The pages of the side panel, one of which is open.
enum class PanelTab { kView, kCost, kCompare, kClusters, kPick, kFile };

struct PanelTabInfo {
  PanelTab tab;
  std::string_view id;  ///< as in --tab and --print-state
  std::string_view label;
  std::string_view summary;  ///< half a sentence
};

/// All of them, from left to right.
std::span<const PanelTabInfo> panel_tab_table();

/// Throws Error (kUsage) with the ids there are.
PanelTab find_panel_tab(std::string_view id);
std::string_view panel_tab_id(PanelTab tab);

/// How a second technique's picture is compared with the first.
enum class CompareMode {
  kOff,
  kSideBySide,  ///< two pictures, each in half of the space
  kWipe,        ///< one picture, the first technique's to the left of a divider
  kDifference,  ///< pixels that are not the same
};

struct CompareSettings {
  CompareMode mode = CompareMode::kOff;
  std::size_t against = 0;  ///< row of technique_table()
  float divider = 0.5f;     ///< of a wipe: part of the picture's width
};

/// As in --compare and --print-state. find_compare_mode() throws Error (kUsage).
std::string_view compare_mode_id(CompareMode mode);
CompareMode find_compare_mode(std::string_view id);
CompareMode next_compare_mode(CompareMode mode);

/// What a technique is compared with unless one is chosen.
inline std::size_t default_against() { return technique_row("rebuild-bvh"); }

inline constexpr int kMaxTreeDepth = 16;

/// Which boxes are drawn over the picture.
struct OverlaySettings {
  bool world_boxes = false;  ///< of clusters, axis-aligned in the world
  bool local_boxes = false;  ///< of clusters, in their own bases
  bool tree_cells = false;   ///< of the fuzzy kd-trees
  int tree_depth = 4;        ///< cells at this depth, and leaves above it
  bool fuzzy_box = true;     ///< of the picked triangle
  bool local_basis = true;   ///< of its cluster
};

enum class Resolution {
  kFull,
  kHalf,
  kQuarter,
  kAuto,  ///< full, but coarser while the user drags and full would be late
};

/// By resolution: as the panel and --print-state name it.
inline constexpr std::array kResolutionNames = {"1", "1/2", "1/4", "auto"};

/// What the table of techniques shows.
enum class CostColumns { kTimes, kWork };

inline constexpr int kMinTextPercent = 70, kMaxTextPercent = 200;

struct ViewSettings {
  std::size_t technique = 0;  ///< row of technique_table()
  ShadingMode shading = ShadingMode::kDiffuse;
  std::uint32_t samples = 1;                      ///< per pixel
  std::uint32_t occlusion_rays = kOcclusionRays;  ///< per sample of lit pictures
  Resolution resolution = Resolution::kAuto;
  bool count_work = false;  ///< trace an extra counting frame now and then
  CostColumns cost_columns = CostColumns::kTimes;
  bool keep_tracing = false;  ///< trace again although nothing has changed, to watch the times
  ColorScheme colors = ColorScheme::kDark;
  int text_percent = 100;  ///< size of text and widgets; 100: as the display asks

  /// To another row of the table, around its ends.
  void step_technique(int by);
  void next_shading();
  void toggle_colors();
  /// Larger or smaller by so many steps, within bounds.
  void step_text_size(int by);

  bool operator==(const ViewSettings&) const = default;
};

enum class ExportKind { kPictures, kFilm };

struct ExportSettings {
  ExportKind kind = ExportKind::kPictures;
  bool films_possible = false;  ///< ffmpeg is there
};

}  // namespace mdk
