// One line of 'mdprep verify'.
#pragma once

#include <cstdint>
#include <string>

namespace mdk {

struct CheckResult {
  std::string name;         ///< what is true if it passes, as a short phrase
  std::uint64_t count = 0;  ///< how many things were looked at
  std::uint64_t failures = 0;
  std::string detail;  ///< where the first failure is, or a figure worth knowing

  bool passed() const { return failures == 0; }
};

}  // namespace mdk
