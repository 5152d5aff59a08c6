#include "common/motion/arrays.h"

#include <algorithm>

namespace mdk {

std::string count_fault(std::string_view name, std::uint64_t size, std::uint64_t wanted) {
  if (size == wanted) return {};
  return std::string(name) + ": " + std::to_string(size) + " of them, not " +
         std::to_string(wanted);
}

std::string range_fault(std::string_view name, std::uint64_t size, std::uint64_t min,
                        std::uint64_t max) {
  if (min <= size && size <= max) return {};
  return std::string(name) + ": " + std::to_string(size) + " of them, where " +
         std::to_string(min) + " to " + std::to_string(max) + " can be";
}

std::string count_fault(const ModelArray& row, std::uint64_t size, const ArrayCounts& counts) {
  const CountRule& rule = row.count;
  const std::uint64_t whole = counts[rule.a] * counts[rule.b] + rule.more;
  const std::uint64_t keys = std::max<std::uint64_t>(1, counts[Count::kKeys]);
  switch (rule.kind) {
    case CountRule::Kind::kExactly:
      return count_fault(row.name, size, whole);
    case CountRule::Kind::kNoneOr:
      return size == 0 ? "" : count_fault(row.name, size, whole);
    case CountRule::Kind::kRange:
      return range_fault(row.name, size, rule.more,
                         rule.a == Count::kOne ? rule.max : std::min(rule.max, counts[rule.a]));
    case CountRule::Kind::kPerKey:
      if (size % keys == 0) return {};
      return std::string(row.name) + ": " + std::to_string(size) +
             " of them are not as many for each of " + std::to_string(keys) + " keys";
  }
  return {};
}

}  // namespace mdk
