// What another program would paste.
#pragma once

#include <string>

namespace mdk::test {

/// The text that stands in the clipboard of `display`. Throws std::runtime_error where there is
/// none.
std::string clipboard_text(const std::string& display);

}  // namespace mdk::test
