// Measured figures as people read them in the panel.
#pragma once

#include <string>

namespace mdk {

/// Three significant digits: "0.04", "3.21", "128"
std::string short_number(double value);

/// "0.04 ms", "3.21 ms", "128 ms"
std::string milliseconds_text(double ms);

/// "12.3 M", "940 k", "87"
std::string rate_text(double per_second);

}  // namespace mdk
