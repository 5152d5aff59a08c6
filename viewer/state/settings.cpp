#include "viewer/state/settings.h"

#include <algorithm>
#include <string>

#include "common/base/error.h"
#include "common/trace/technique.h"

namespace mdk {
namespace {

constexpr std::array kTabs = {
    PanelTabInfo{PanelTab::kView, "view", "View", "technique, shading, resolution"},
    PanelTabInfo{PanelTab::kCost, "cost", "Cost", "what the last frames took, in time and work"},
    PanelTabInfo{PanelTab::kCompare, "compare", "Compare", "two techniques side by side"},
    PanelTabInfo{PanelTab::kClusters, "clusters", "Clusters",
                 "the parts that move alike, and their boxes"},
    PanelTabInfo{PanelTab::kPick, "pick", "Pick", "the triangle that was clicked on"},
    PanelTabInfo{PanelTab::kFile, "file", "File", "what is open, and pictures of it"},
};

constexpr std::array<std::string_view, 4> kCompareIds = {"off", "side", "wipe", "difference"};

}  // namespace

std::size_t technique_row(std::string_view id) {
  return static_cast<std::size_t>(&find_technique(id) - technique_table().data());
}

std::span<const PanelTabInfo> panel_tab_table() { return kTabs; }

PanelTab find_panel_tab(std::string_view id) {
  std::string ids;
  for (const PanelTabInfo& info : kTabs) {
    if (info.id == id) return info.tab;
    ids += (ids.empty() ? "" : ", ") + std::string(info.id);
  }
  throw Error(ErrorCode::kUsage, "there is no tab \"" + std::string(id) + "\"; choose from " + ids);
}

std::string_view panel_tab_id(PanelTab tab) { return kTabs[static_cast<std::size_t>(tab)].id; }

std::string_view compare_mode_id(CompareMode mode) {
  return kCompareIds[static_cast<std::size_t>(mode)];
}

CompareMode find_compare_mode(std::string_view id) {
  const auto at = std::ranges::find(kCompareIds, id);
  if (at != kCompareIds.end()) return static_cast<CompareMode>(at - kCompareIds.begin());
  throw Error(ErrorCode::kUsage,
              "--compare \"" + std::string(id) + "\": give off, side, wipe or difference");
}

CompareMode next_compare_mode(CompareMode mode) {
  return static_cast<CompareMode>((static_cast<std::size_t>(mode) + 1) % kCompareIds.size());
}

void ViewSettings::step_technique(int by) {
  const auto count = static_cast<int>(technique_table().size());
  const int row = static_cast<int>(technique) + by;
  technique = static_cast<std::size_t>((row + count) % count);
}

void ViewSettings::next_shading() {
  const auto modes = shading_table();
  std::size_t row = 0;
  while (row < modes.size() && modes[row].mode != shading) ++row;
  shading = modes[(row + 1) % modes.size()].mode;
}

void ViewSettings::toggle_colors() {
  colors = colors == ColorScheme::kDark ? ColorScheme::kLight : ColorScheme::kDark;
}

void ViewSettings::step_text_size(int by) {
  constexpr int kStep = 10;
  text_percent = std::clamp(text_percent + by * kStep, kMinTextPercent, kMaxTextPercent);
}

}  // namespace mdk
