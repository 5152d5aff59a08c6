// What the arrays of a model have in common: spans in a view of it, vectors where it owns its
// memory, and for each one row that says what the .mdk file calls it and how many elements it has.
// The structs of arrays (RigLists, ModelLists, ...) visit theirs with these rows: whatever is done
// to all arrays, writing, mapping, checking, copying, is done through that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mdk {

template <class T>
using ConstSpan = std::span<const T>;
template <class T>
using OwnedList = std::vector<T>;

/// What the number of elements of an array is made of.
enum class Count {
  kOne,
  kVertices,
  kKeys,
  kTriangles,
  kCorners,  ///< three per triangle
  kClusters,
  kSegments,
  kBones,
  kRuns,  ///< of quantised vertices
};

/// Their values in a model.
class ArrayCounts {
 public:
  void set(Count count, std::uint64_t value) { values_[static_cast<std::size_t>(count)] = value; }
  std::uint64_t operator[](Count count) const { return values_[static_cast<std::size_t>(count)]; }

 private:
  std::uint64_t values_[static_cast<std::size_t>(Count::kRuns) + 1] = {1};  ///< of kOne first
};

inline constexpr std::uint64_t kMaxCount =
    (std::uint64_t{1} << 30) - 1;  // so that 3 T fits 32 bits
inline constexpr std::uint64_t kMaxLinks = std::numeric_limits<std::uint32_t>::max();

/// How many elements an array has, once the arrays before it have as many as they must.
struct CountRule {
  enum class Kind {
    kExactly,  ///< a * b + more
    kNoneOr,   ///< 0, or the same
    kRange,    ///< more to max, or to a where that is less
    kPerKey,   ///< a multiple of the keys
  };
  Kind kind = Kind::kRange;
  Count a = Count::kOne, b = Count::kOne;
  std::uint64_t more = 0, max = 0;
};

namespace count_rules {

constexpr CountRule exactly(Count a, Count b = Count::kOne) {
  return {.kind = CountRule::Kind::kExactly, .a = a, .b = b};
}
constexpr CountRule exactly_one_more_than(Count a) {
  return {.kind = CountRule::Kind::kExactly, .a = a, .more = 1};
}
constexpr CountRule none_or(Count a) { return {.kind = CountRule::Kind::kNoneOr, .a = a}; }
constexpr CountRule none_or_one_more_than(Count a) {
  return {.kind = CountRule::Kind::kNoneOr, .a = a, .more = 1};
}
constexpr CountRule per_key() { return {.kind = CountRule::Kind::kPerKey}; }
constexpr CountRule between(std::uint64_t min, std::uint64_t max) {
  return {.kind = CountRule::Kind::kRange, .more = min, .max = max};
}
/// At least one.
constexpr CountRule at_most(Count a) {
  return {.kind = CountRule::Kind::kRange,
          .a = a,
          .more = 1,
          .max = std::numeric_limits<std::uint64_t>::max()};
}

/// As many as there may be of things that have numbers, at least `min`.
constexpr CountRule some(std::uint64_t min = 1) { return between(min, kMaxCount); }
constexpr CountRule any() { return between(0, std::numeric_limits<std::uint64_t>::max()); }

}  // namespace count_rules

/// Which arrays stand or fall together.
enum class ModelPart {
  kWhole,         ///< always there
  kKeyPositions,  ///< one of these three is there, by the kind of the poses
  kRig,
  kQuantized,
  kSkeleton,
};

/// One array of a model.
struct ModelArray {
  std::uint32_t id = 0;   ///< of its section: four letters, the first in the lowest byte
  std::string_view name;  ///< as in docs/file-format.md
  CountRule count;        ///< where its part is there; else it is empty
  ModelPart part = ModelPart::kWhole;
};

/// Four letters as a number, the first in the lowest byte.
constexpr std::uint32_t fourcc(const char (&letters)[5]) {
  std::uint32_t id = 0;
  for (int i = 0; i < 4; ++i)
    id |= static_cast<std::uint32_t>(static_cast<unsigned char>(letters[i])) << (8 * i);
  return id;
}

constexpr ModelArray array_row(const char (&letters)[5], std::string_view name, CountRule count,
                               ModelPart part = ModelPart::kWhole) {
  return {fourcc(letters), name, count, part};
}

/// "fuzzy_boxes: 7 of them, not 12", or nothing where an array has as many elements as it must.
std::string count_fault(const ModelArray& row, std::uint64_t size, const ArrayCounts& counts);
std::string count_fault(std::string_view name, std::uint64_t size, std::uint64_t wanted);
std::string range_fault(std::string_view name, std::uint64_t size, std::uint64_t min,
                        std::uint64_t max);

/// A visitor of two structs of arrays: the first one's become views or copies of the second one's.
inline constexpr auto kAssign = [](const ModelArray&, auto& to, const auto& from) {
  if constexpr (std::is_assignable_v<decltype(to), decltype(from)>)
    to = from;
  else
    to.assign(from.begin(), from.end());
};

/// A visitor that adds up bytes.
struct ByteSum {
  std::size_t bytes = 0;

  template <class List>
  void operator()(const ModelArray&, const List& list) {
    bytes += list.size() * sizeof(typename List::value_type);
  }
};

}  // namespace mdk
