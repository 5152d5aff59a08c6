#include "viewer/state/view_state.h"

#include "common/trace/technique.h"

namespace mdk {

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

}  // namespace mdk
