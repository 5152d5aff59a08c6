// UiParts: the few widgets of its own that the panel is made of.
#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "viewer/panel/style.h"
#include "viewer/panel/ui_result.h"

namespace mdk {

/// Notes where ImGui's last item is.
void record(WidgetMap& widgets, const std::string& name);

/// An invisible button, at least a pixel large: ImGui ends the program over one without size, which
/// a tiny window would ask for.
bool hit_area(const char* id, const ImVec2& size);

/// A small dim title with some air above.
void heading(const Theme& theme, const char* title);

/// One line: a dim name at the left, its value at the right.
void fact(const char* name, const std::string& value);

struct ButtonSegment {
  std::string id;  ///< as recorded
  std::string label;
};

/// Buttons side by side over the whole width, one of them chosen; the one that was clicked now.
std::optional<std::size_t> segmented_buttons(const std::vector<ButtonSegment>& segments,
                                             std::size_t chosen, WidgetMap& widgets);

/// A button that asks for a command.
struct CommandButton {
  const char* id;  ///< as recorded
  const char* label;
  const char* tip;
  Command command;
};

/// Equally wide, side by side over the whole width.
void button_row(const std::vector<CommandButton>& buttons, UiResult& result);

enum class Icon { kPlay, kPause, kPreviousKey, kNextKey, kStart, kEnd };

/// A square button with a drawn icon, as no font is sure to have one.
bool icon_button(const char* id, Icon icon, const ImVec2& size);

}  // namespace mdk
