// Numbers as people read them in the panel.
#pragma once

#include <cstdint>
#include <string>

namespace mdk {

/// "15,840"
std::string grouped(std::uint64_t count);

/// "9.1 MiB", "512 B"
std::string bytes_text(std::uint64_t bytes);

/// Three significant digits: "0.04", "3.21", "128"
std::string short_number(double value);

/// "0.04 ms", "3.21 ms", "128 ms"
std::string milliseconds_text(double ms);

/// "12.3 M", "940 k", "87"
std::string rate_text(double per_second);

}  // namespace mdk
