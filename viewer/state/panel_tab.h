// PanelTab: the pages of the side panel, one of which is open.
#pragma once

#include <span>
#include <string_view>

namespace mdk {

enum class PanelTab { kView, kCost, kCompare, kClusters, kPick, kFile };

struct PanelTabInfo {
  PanelTab tab;
  std::string_view id;  ///< as in --tab and --print-state
  std::string_view label;
  std::string_view summary;  ///< half a sentence
};

/// All of them, as they stand from left to right.
std::span<const PanelTabInfo> panel_tab_table();

/// Throws Error (kUsage) with the ids there are.
PanelTab find_panel_tab(std::string_view id);
std::string_view panel_tab_id(PanelTab tab);

}  // namespace mdk
