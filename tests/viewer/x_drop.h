// Dropping a file on a window, as a file manager does it (the XDND protocol).
#pragma once

#include <string>

namespace mdk::test {

/// Drops `path` in the middle of the first window on `display` whose name contains `window_name`.
/// Throws std::runtime_error where no such window takes it.
void drop_file(const std::string& display, const std::string& window_name, const std::string& path);

}  // namespace mdk::test
