// Window: one GLFW window with an OpenGL 3.3 core context and Dear ImGui in it, from start to end.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "viewer/window/texture_blit.h"

struct GLFWwindow;

namespace mdk {

class FontBook;

/// Whether a size counts pixels of an ordinary display and grows on a dense one.
enum class SizeUnit { kExact, kScaled };

/// The window to open, in window coordinates.
struct WindowSetup {
  std::uint32_t width = 0, height = 0, min_side = 1;
  SizeUnit unit = SizeUnit::kExact;
};

/// A key that was pressed or a character that was typed; the other one is 0. Letters and signs are
/// taken as characters, so that they follow the keyboard's layout.
struct KeyEvent {
  int key = 0;  ///< GLFW_KEY_...
  unsigned character = 0;
};

/// How large the window is, and how dense its display.
struct WindowShape {
  float width = 0, height = 0;  ///< in window coordinates, those of the mouse and of ImGui
  float pixel_ratio = 1;        ///< framebuffer pixels per window coordinate
  float ui_scale = 1;           ///< how much larger than on an ordinary display things should be

  bool operator==(const WindowShape&) const = default;
};

/// One per process. All of it for the main thread, except wake().
class Window {
 public:
  /// `fonts` must outlive it. Throws Error (kIo) where there is no display or no OpenGL 3.3; the
  /// sentence says what to do.
  Window(const WindowSetup& setup, FontBook& fonts);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool should_close() const;
  void set_title(const std::string& title);
  void set_clipboard(const std::string& text);

  /// Sleeps until something happens, wake() is called, or `seconds` have passed.
  void wait_events(double seconds);
  /// Ends a wait_events() of the main thread. For any thread.
  static void wake();

  /// Whether the user or the system did anything to the window since the last call.
  bool take_activity();
  /// Keys and characters since the last call, none lost. Empty while a text field has the keyboard.
  std::vector<KeyEvent> take_keys();
  /// Paths of files dropped on the window since the last call.
  std::vector<std::string> take_drops();

  /// As it is now: the user, or a move to another display, may change any of it.
  WindowShape shape() const;
  PixelRect framebuffer() const;

  /// ImGui's fonts are others than at the last frame.
  void renew_fonts();

  /// Clears the window and begins an ImGui frame.
  void begin_frame();
  /// Draws what ImGui has collected over what was drawn since begin_frame().
  void end_frame();
  /// What was drawn, before it is presented: the framebuffer in sRGB RGBA, row 0 on top.
  std::vector<std::uint32_t> read_pixels() const;
  void present();

 private:
  struct Events;
  void hold_taps();
  static void note_activity(GLFWwindow* window);
  static void install_callbacks(GLFWwindow* window);

  std::unique_ptr<Events> events_;
  GLFWwindow* window_ = nullptr;
};

}  // namespace mdk
