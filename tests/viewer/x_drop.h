// What a desktop does to a window: drops files on it (the XDND protocol), tells it how dense the
// display is.
#pragma once

#include <string>

namespace mdk::test {

/// Drops `path` in the middle of the first window on `display` whose name contains `window_name`.
/// Throws std::runtime_error where no such window takes it.
void drop_file(const std::string& display, const std::string& window_name, const std::string& path);

/// Asks that window to close, as its title bar's button does.
void close_window(const std::string& display, const std::string& window_name);

/// From now on programs take `display` for one of so many dots per inch; 96 is an ordinary one.
void set_display_density(const std::string& display, int dots_per_inch);

}  // namespace mdk::test
