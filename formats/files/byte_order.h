// Numbers as files hold them, in either byte order.
#pragma once

#include <bit>
#include <cstddef>
#include <cstring>

namespace mdk {

/// The number that starts at `bytes`, which need not be aligned.
template <class Number>
Number load(const void* bytes, std::endian order = std::endian::little) {
  unsigned char raw[sizeof(Number)];
  std::memcpy(raw, bytes, sizeof raw);
  if (order != std::endian::native) {
    for (std::size_t i = 0; i < sizeof raw / 2; ++i) {
      const unsigned char swapped = raw[i];
      raw[i] = raw[sizeof raw - 1 - i];
      raw[sizeof raw - 1 - i] = swapped;
    }
  }
  Number value;
  std::memcpy(&value, raw, sizeof value);
  return value;
}

}  // namespace mdk
