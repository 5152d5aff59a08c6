#include "tests/viewer/x_clipboard.h"

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

namespace mdk::test {
namespace {

std::string property_text(Display* x, Window window, Atom property) {
  Atom type = 0;
  int format = 0;
  unsigned long count = 0, left = 0;
  unsigned char* bytes = nullptr;
  XGetWindowProperty(x, window, property, 0, 1 << 16, False, AnyPropertyType, &type, &format,
                     &count, &left, &bytes);
  std::string text;
  if (bytes && format == 8) text.assign(reinterpret_cast<const char*>(bytes), count);
  if (bytes) XFree(bytes);
  return text;
}

}  // namespace

std::string clipboard_text(const std::string& display) {
  const std::unique_ptr<Display, int (*)(Display*)> x(XOpenDisplay(display.c_str()), XCloseDisplay);
  if (!x) throw std::runtime_error("no display " + display);
  const Window own = XCreateSimpleWindow(x.get(), DefaultRootWindow(x.get()), 0, 0, 1, 1, 0, 0, 0);
  const Atom property = XInternAtom(x.get(), "MDK_PASTED", False);
  XConvertSelection(x.get(), XInternAtom(x.get(), "CLIPBOARD", False),
                    XInternAtom(x.get(), "UTF8_STRING", False), property, own, CurrentTime);
  XFlush(x.get());
  for (int i = 0; i < 1000; ++i) {
    while (XPending(x.get())) {
      XEvent event;
      XNextEvent(x.get(), &event);
      if (event.type != SelectionNotify) continue;
      if (event.xselection.property == 0) throw std::runtime_error("the clipboard is empty");
      return property_text(x.get(), own, property);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  throw std::runtime_error("the clipboard's owner does not answer");
}

}  // namespace mdk::test
