#include "common/base/isa.h"

#include <hwy/targets.h>

#include <string>
#include <vector>

#include "common/base/error.h"

namespace mdk {
namespace {

struct IsaRow {
  std::string_view name;
  std::int64_t target;  ///< Highway's bit; better targets have lower bits
};

constexpr IsaRow kRows[] = {
#if HWY_ARCH_X86
    {"sse4", HWY_SSE4},
    {"avx2", HWY_AVX2},
    {"avx512", HWY_AVX3},
#elif HWY_ARCH_ARM
    {"neon", HWY_NEON},
#endif
    {"scalar", 0},
};

bool is_available(const IsaRow& row) {
  static const std::int64_t machine = [] {
    hwy::DisableTargets(0);
    return hwy::SupportedTargets();
  }();
  return (machine & row.target) != 0;
}

}  // namespace

std::span<const std::string_view> available_isas() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> found;
    for (const IsaRow& row : kRows)
      if (is_available(row)) found.push_back(row.name);
    return found;
  }();
  return names;
}

void limit_isa(std::string_view name) {
  for (const IsaRow& row : kRows) {
    if (row.name != name || row.target == 0) continue;
    if (!is_available(row))
      throw Error(ErrorCode::kUsage,
                  "--isa " + std::string(name) + ": this machine does not have it");
    hwy::DisableTargets(row.target - 1);  // every better target
    return;
  }
  std::string known;
  for (const std::string_view isa : available_isas()) known.append(" ").append(isa);
  throw Error(ErrorCode::kUsage,
              "--isa " + std::string(name) + ": no such instruction set; this machine has" + known);
}

void reset_isa() { hwy::DisableTargets(0); }

std::string_view isa_in_use() {
  const std::int64_t usable = hwy::SupportedTargets();
  for (std::size_t i = std::size(kRows); i-- > 0;)
    if ((usable & kRows[i].target) != 0) return kRows[i].name;
  return "scalar";
}

}  // namespace mdk
