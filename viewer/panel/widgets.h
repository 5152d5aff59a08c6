// Widgets: the few widgets and texts that the panel is made of.
#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "viewer/panel/commands.h"
#include "viewer/panel/style.h"
#include "viewer/state/layout.h"

namespace mdk {

/// What one drawing of the window gathers besides pixels.
struct UiResult {
  WidgetMap widgets;
  std::vector<Action> actions;          ///< asked for, to be done when the drawing is done
  std::vector<std::string> open_paths;  ///< an animation or a folder that was chosen, else empty
};

/// Notes where ImGui's last item is; shows `tip`, if there is one, while the pointer is on it.
void record(WidgetMap& widgets, const std::string& name, const char* tip = nullptr);

/// An invisible button, at least a pixel large: ImGui ends the program over one without size, which
/// a tiny window would ask for.
bool hit_area(const char* id, const ImVec2& size);

/// A small dim title with some space above.
void heading(const Theme& theme, const char* title);

/// One line: a dim name at the left, its value at the right.
void fact(const char* name, const std::string& value);

/// The next column of a table, with this text.
void cell(const std::string& text);

/// ImGui's text in a colour; dim and wrapped at the window's edge.
void colored_text(ImU32 color, const std::string& text);
void dim_paragraph(const std::string& text);

/// A box to tick, recorded with its tip.
void checkbox(const char* label, bool& on, WidgetMap& widgets, const char* name,
              const char* tip = nullptr);

struct ButtonSegment {
  std::string id;  ///< as recorded
  std::string label;
};

/// Buttons side by side over the whole width, one of them chosen; the one that was clicked now.
std::optional<std::size_t> segmented_buttons(const std::vector<ButtonSegment>& segments,
                                             std::size_t chosen, WidgetMap& widgets);

/// The same for an enumeration that counts from 0.
template <class Enum>
void choose(const std::vector<ButtonSegment>& segments, Enum& chosen, WidgetMap& widgets) {
  if (const auto clicked = segmented_buttons(segments, static_cast<std::size_t>(chosen), widgets))
    chosen = static_cast<Enum>(*clicked);
}

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

/// A box over the picture, from its making to its end; ImGui's SetNextWindow... come before it.
class FloatingBox {
 public:
  /// `padding`: between its edges and its content, in units of design; {}: as of any window.
  FloatingBox(const char* id, const Theme& theme, ImGuiWindowFlags flags, ImVec2 padding = {},
              ImU32 ground = floating_color());
  ~FloatingBox();
  FloatingBox(const FloatingBox&) = delete;
  FloatingBox& operator=(const FloatingBox&) = delete;
};

/// No title, not to be moved or sized.
inline constexpr ImGuiWindowFlags kFixedBox =
    ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav;

/// Begins a window that fills `place` and stays there, below all others; ImGui::End() ends it.
void begin_docked(const char* id, const Rect& place, ImGuiWindowFlags more_flags = 0);

/// The next window stands in the middle of `place`.
void center_next_window(const Rect& place);

/// Three significant digits: "0.04", "3.21", "128"
std::string short_number(double value);

/// "0.04 ms", "3.21 ms", "128 ms"
std::string milliseconds_text(double ms);

/// "12.3 M", "940 k", "87"
std::string rate_text(double per_second);

}  // namespace mdk
