#include "viewer/state/panel_tab.h"

#include <array>
#include <string>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr std::array kTabs = {
    PanelTabInfo{PanelTab::kView, "view", "View", "technique, shading, resolution"},
    PanelTabInfo{PanelTab::kCost, "cost", "Cost", "what the last frames took, in time and work"},
    PanelTabInfo{PanelTab::kCompare, "compare", "Compare", "two techniques held together"},
    PanelTabInfo{PanelTab::kClusters, "clusters", "Clusters",
                 "the parts that move alike, and their boxes"},
    PanelTabInfo{PanelTab::kPick, "pick", "Pick", "the triangle that was clicked on"},
    PanelTabInfo{PanelTab::kFile, "file", "File", "what is open, and pictures of it"},
};

}  // namespace

std::span<const PanelTabInfo> panel_tab_table() { return kTabs; }

PanelTab find_panel_tab(std::string_view id) {
  std::string ids;
  for (const PanelTabInfo& info : kTabs) {
    if (info.id == id) return info.tab;
    ids += (ids.empty() ? "" : ", ") + std::string(info.id);
  }
  throw Error(ErrorCode::kUsage, "there is no tab \"" + std::string(id) + "\"; choose from " + ids);
}

std::string_view panel_tab_id(PanelTab tab) {
  for (const PanelTabInfo& info : kTabs)
    if (info.tab == tab) return info.id;
  return {};
}

}  // namespace mdk
