#include "viewer/picture/picture_name.h"

#include <filesystem>

#include "common/base/error.h"

namespace mdk {

std::string free_picture_name(const std::string& stem) {
  constexpr std::size_t kDigits = 4;
  for (int number = 1; number < 10000; ++number) {
    const std::string digits = std::to_string(number);
    const std::string name =
        stem + "-" + std::string(kDigits - digits.size(), '0') + digits + ".png";
    std::error_code ignored;
    if (!std::filesystem::exists(name, ignored)) return name;
  }
  throw io_error(stem + "-9999.png", "no number is free for another picture; move some away");
}

}  // namespace mdk
