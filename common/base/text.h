// Text for people: figures in reports and in the panel alike, and text from outside that is made
// fit for one line of a terminal.
#pragma once

#include <cstdint>
#include <string>

namespace mdk {

/// 12.345 with 1 decimal: "12.3".
std::string fixed_text(double value, int decimals);

/// 1234567: "1,234,567".
std::string grouped_text(std::uint64_t value);

/// 3250585: "3.1 MiB"; 512: "512 B".
std::string bytes_text(std::uint64_t bytes);

/// Control characters, which names in files may hold and terminals obey, become '?'.
std::string printable_line(std::string text);

}  // namespace mdk
