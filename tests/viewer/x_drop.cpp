#include "tests/viewer/x_drop.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace mdk::test {
namespace {

constexpr long kXdndVersion = 5;

/// The first window below the root whose name contains `name`.
Window find_window(Display* display, const std::string& name) {
  const Window root = DefaultRootWindow(display);
  Window ignored = 0, parent = 0, *children = nullptr;
  unsigned count = 0;
  Window found = 0;
  if (!XQueryTree(display, root, &ignored, &parent, &children, &count)) return 0;
  for (unsigned i = 0; i < count && !found; ++i) {
    char* title = nullptr;
    if (XFetchName(display, children[i], &title) && std::strstr(title, name.c_str()))
      found = children[i];
    if (title) XFree(title);
  }
  if (children) XFree(children);
  if (!found) throw std::runtime_error("no window " + name);
  return found;
}

class DropSource {
 public:
  explicit DropSource(const std::string& display) : display_(XOpenDisplay(display.c_str())) {
    if (!display_) throw std::runtime_error("no display " + display);
    own_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
    XSetSelectionOwner(display_, atom("XdndSelection"), own_, CurrentTime);
  }
  ~DropSource() { XCloseDisplay(display_); }
  DropSource(const DropSource&) = delete;
  DropSource& operator=(const DropSource&) = delete;

  void drop(const std::string& window_name, const std::string& path) {
    const Window to = find_window(display_, window_name);
    XWindowAttributes at{};
    XGetWindowAttributes(display_, to, &at);
    const long middle = ((at.x + at.width / 2L) << 16) | (at.y + at.height / 2L);
    send(to, "XdndEnter", kXdndVersion << 24, static_cast<long>(atom("text/uri-list")), 0);
    send(to, "XdndPosition", 0, middle, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
    wait_for("XdndStatus");
    send(to, "XdndDrop", 0, CurrentTime, 0);
    uris_ = "file://" + path + "\r\n";
    wait_for("XdndFinished");
  }

 private:
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }

  void send(Window to, const char* message, long a, long b, long c, long d = 0) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = to;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(own_);
    event.xclient.data.l[1] = a;
    event.xclient.data.l[2] = b;
    event.xclient.data.l[3] = c;
    event.xclient.data.l[4] = d;
    XSendEvent(display_, to, False, NoEventMask, &event);
    XFlush(display_);
  }

  // Hands the path over when it is asked for meanwhile.
  void wait_for(const char* message) {
    for (int i = 0; i < 2000; ++i) {
      while (XPending(display_)) {
        XEvent event;
        XNextEvent(display_, &event);
        if (event.type == SelectionRequest) hand_over(event.xselectionrequest);
        if (event.type == ClientMessage && event.xclient.message_type == atom(message)) return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    throw std::runtime_error(std::string("no answer ") + message);
  }

  void hand_over(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8,
                    PropModeReplace, reinterpret_cast<const unsigned char*>(uris_.data()),
                    static_cast<int>(uris_.size()));
    XEvent answer{};
    answer.xselection.type = SelectionNotify;
    answer.xselection.requestor = request.requestor;
    answer.xselection.selection = request.selection;
    answer.xselection.target = request.target;
    answer.xselection.property = request.property;
    answer.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &answer);
    XFlush(display_);
  }

  Display* display_;
  Window own_ = 0;
  std::string uris_;
};

}  // namespace

void drop_file(const std::string& display, const std::string& window_name,
               const std::string& path) {
  DropSource(display).drop(window_name, path);
}

void close_window(const std::string& display, const std::string& window_name) {
  Display* const x = XOpenDisplay(display.c_str());
  if (!x) throw std::runtime_error("no display " + display);
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = find_window(x, window_name);
  event.xclient.message_type = XInternAtom(x, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(XInternAtom(x, "WM_DELETE_WINDOW", False));
  XSendEvent(x, event.xclient.window, False, NoEventMask, &event);
  XCloseDisplay(x);
}

void set_display_density(const std::string& display, int dots_per_inch) {
  Display* const x = XOpenDisplay(display.c_str());
  if (!x) throw std::runtime_error("no display " + display);
  const std::string resources = std::string("Xft.dpi:\t") + std::to_string(dots_per_inch) + "\n";
  XChangeProperty(x, DefaultRootWindow(x), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(resources.data()),
                  static_cast<int>(resources.size()));
  XSetCloseDownMode(x, RetainPermanent);
  XCloseDisplay(x);
}

}  // namespace mdk::test
