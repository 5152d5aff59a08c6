#include "viewer/window/window.h"

#include <glad/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "common/base/error.h"
#include "viewer/window/fonts.h"

namespace mdk {
namespace {

Error no_window(const std::string& what) {
  const char* reason = nullptr;
  glfwGetError(&reason);
  return {ErrorCode::kIo, what + (reason ? std::string(" (") + reason + ")" : std::string()) +
                              "; \"mdprep render\" makes pictures without a window"};
}

// EGL first: GLX has a thousand configurations to be asked for twenty attributes each, which takes
// longer than all the rest of a start.
GLFWwindow* create_window(const WindowSetup& setup) {
  for (const int api : {GLFW_EGL_CONTEXT_API, GLFW_NATIVE_CONTEXT_API}) {
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, api);
    if (GLFWwindow* const window =
            glfwCreateWindow(static_cast<int>(setup.width), static_cast<int>(setup.height),
                             "mdview", nullptr, nullptr))
      return window;
  }
  return nullptr;
}

}  // namespace

// GLFW hands everything to callbacks; they only note what came. ImGui's own callbacks are chained
// behind these (ImGui 1.86 polls its keys and would miss a quick tap).
struct Window::Events {
  bool active = true;
  std::vector<KeyEvent> keys;
  std::vector<std::string> drops;
  std::vector<int> tapped;  ///< keys pressed since the last frame
  std::vector<int> held;    ///< of the last frame's, those that ImGui was told of by us

  static Events& of(GLFWwindow* window) {
    return *static_cast<Events*>(glfwGetWindowUserPointer(window));
  }
};

Window::Window(const WindowSetup& setup, FontBook& fonts) : events_(std::make_unique<Events>()) {
  if (!glfwInit()) throw no_window("mdview finds no display to open a window on");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, setup.unit == SizeUnit::kScaled ? GLFW_TRUE : GLFW_FALSE);
  window_ = create_window(setup);
  if (!window_) {
    const Error error = no_window("mdview cannot open a window with OpenGL 3.3");
    glfwTerminate();
    throw error;
  }
  glfwMakeContextCurrent(window_);
  if (!gladLoadGL(glfwGetProcAddress)) {
    glfwDestroyWindow(window_);
    glfwTerminate();
    throw no_window("the functions of OpenGL 3.3 are missing here");
  }
  glfwSwapInterval(1);
  const auto min_side = static_cast<int>(setup.min_side);
  glfwSetWindowSizeLimits(window_, min_side, min_side, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwSetWindowUserPointer(window_, events_.get());
  install_callbacks(window_);

  IMGUI_CHECKVERSION();
  ImGui::CreateContext(&fonts.atlas());
  ImGui::GetIO().IniFilename = nullptr;
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::note_activity(GLFWwindow* window) { Events::of(window).active = true; }

void Window::install_callbacks(GLFWwindow* window) {
  glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
    Events& events = Events::of(w);
    events.active = true;
    if (action != GLFW_RELEASE) events.keys.push_back({key, 0});
    if (action == GLFW_PRESS && key >= 0) events.tapped.push_back(key);
  });
  glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
    Events::of(w).keys.push_back({0, character});
  });
  glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
    Events& events = Events::of(w);
    events.active = true;
    events.drops.insert(events.drops.end(), paths, paths + count);
  });
  glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int, int) { note_activity(w); });
  glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) { note_activity(w); });
  glfwSetScrollCallback(window, [](GLFWwindow* w, double, double) { note_activity(w); });
  glfwSetWindowRefreshCallback(window, note_activity);
  glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { note_activity(w); });
  glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int) { note_activity(w); });
  glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) { note_activity(w); });
  glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { note_activity(w); });
}

bool Window::should_close() const { return glfwWindowShouldClose(window_); }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

void Window::set_clipboard(const std::string& text) {
  glfwSetClipboardString(window_, text.c_str());
}

void Window::wait_events(double seconds) {
  if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
}

void Window::wake() { glfwPostEmptyEvent(); }

// ImGui looks at keys once a frame: one that went down and up in between is held for a frame, or a
// quick Enter in a text field would be lost.
void Window::hold_taps() {
  ImGuiIO& io = ImGui::GetIO();
  for (const int key : std::exchange(events_->held, {}))
    io.KeysDown[key] = glfwGetKey(window_, key) == GLFW_PRESS;
  for (const int key : std::exchange(events_->tapped, {})) {
    if (io.KeysDown[key]) continue;
    io.KeysDown[key] = true;
    events_->held.push_back(key);
  }
}

bool Window::take_activity() { return std::exchange(events_->active, false); }

std::vector<KeyEvent> Window::take_keys() {
  std::vector<KeyEvent> keys = std::exchange(events_->keys, {});
  if (ImGui::GetIO().WantTextInput) keys.clear();
  return keys;
}

std::vector<std::string> Window::take_drops() { return std::exchange(events_->drops, {}); }

WindowShape Window::shape() const {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  WindowShape shape{static_cast<float>(width), static_cast<float>(height)};
  const int pixels = framebuffer().width;
  if (width > 0 && pixels > 0) shape.pixel_ratio = static_cast<float>(pixels) / shape.width;
  float scale_x = 1, scale_y = 1;
  glfwGetWindowContentScale(window_, &scale_x, &scale_y);
  shape.ui_scale = std::clamp(scale_x / shape.pixel_ratio, 0.5f, 4.0f);
  return shape;
}

PixelRect Window::framebuffer() const {
  PixelRect pixels;
  glfwGetFramebufferSize(window_, &pixels.width, &pixels.height);
  return pixels;
}

void Window::renew_fonts() {
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::begin_frame() {
  const PixelRect pixels = framebuffer();
  glViewport(0, 0, pixels.width, pixels.height);
  const ImVec4& ground = ImGui::GetStyle().Colors[ImGuiCol_WindowBg];
  glClearColor(ground.x, ground.y, ground.z, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  hold_taps();
  ImGui::NewFrame();
}

void Window::end_frame() {
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

std::vector<std::uint32_t> Window::read_pixels() const {
  const auto [left, top, width, height] = framebuffer();
  const auto row = static_cast<std::size_t>(width);
  std::vector<std::uint32_t> pixels(row * static_cast<std::size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  for (int y = 0; y < height / 2; ++y) {  // OpenGL's row 0 is at the bottom
    const auto upper = pixels.begin() + static_cast<std::ptrdiff_t>(row) * y;
    const auto lower = pixels.begin() + static_cast<std::ptrdiff_t>(row) * (height - 1 - y);
    std::swap_ranges(upper, upper + width, lower);
  }
  return pixels;
}

void Window::present() { glfwSwapBuffers(window_); }

}  // namespace mdk
