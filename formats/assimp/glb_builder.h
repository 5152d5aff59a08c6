// A binary glTF in the making: objects of its JSON, and numbers that accessors find.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace mdk {

using Json = nlohmann::ordered_json;

class GlbBuilder {
 public:
  /// `path`: of the input, for messages.
  explicit GlbBuilder(const std::string& path);

  /// Appends to the list `kind` ("meshes") and returns its number.
  std::size_t add(const char* kind, Json object);
  Json& at(const char* kind, std::size_t number) { return root_[kind][number]; }

  /// A new buffer view. Throws Error (kOverLimit) past 4 GiB in all.
  std::size_t add_bytes(std::span<const unsigned char> bytes);
  /// New accessors; `type` as in glTF ("VEC3"), at least one element.
  std::size_t add_floats(const char* type, std::span<const float> numbers);
  std::size_t add_indices(std::span<const std::uint32_t> numbers);
  std::size_t add_joints(std::span<const std::uint16_t> numbers);

  /// The file. The builder is empty afterwards.
  std::vector<unsigned char> finish();

 private:
  std::size_t add_accessor(const char* type, int component_type,
                           std::span<const unsigned char> bytes, std::size_t count);

  const std::string& path_;
  Json root_;
  std::vector<unsigned char> binary_;
};

}  // namespace mdk
