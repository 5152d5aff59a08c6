// Accessors, read: strides, sparse replacements and normalised integers resolved.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.h"
#include "formats/files/byte_order.h"
#include "formats/gltf/document.h"

namespace mdk::gltf {
namespace {

std::uint32_t load_unsigned(const unsigned char* bytes, ComponentType type) {
  switch (type) {
    case ComponentType::kUint8:
      return bytes[0];
    case ComponentType::kUint16:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
}

/// glTF 2.0 §3.11: a signed integer's lowest value stands for -1, like the one above it.
template <class T>
float number(const unsigned char* bytes, bool normalized) {
  const T value = load<T>(bytes);
  if (!normalized) return static_cast<float>(value);
  const double unit = static_cast<double>(value) / std::numeric_limits<T>::max();
  return static_cast<float>(std::max(unit, -1.0));
}

float load_float(const unsigned char* bytes, ComponentType type, bool normalized) {
  switch (type) {
    case ComponentType::kInt8:
      return number<std::int8_t>(bytes, normalized);
    case ComponentType::kUint8:
      return number<std::uint8_t>(bytes, normalized);
    case ComponentType::kInt16:
      return number<std::int16_t>(bytes, normalized);
    case ComponentType::kUint16:
      return number<std::uint16_t>(bytes, normalized);
    case ComponentType::kUint32:
      return number<std::uint32_t>(bytes, normalized);
    default:
      return load<float>(bytes);
  }
}

/// Calls read(element, bytes) for every element that has bytes, base first, then replacements.
template <class Read>
void for_each_element(const Document& document, int accessor, const Read& read) {
  const Accessor& a = entry(document.accessors, accessor);
  if (a.data)
    for (std::size_t i = 0; i < a.count; ++i) read(i, a.data + i * a.stride);
  for (std::size_t s = 0; s < a.sparse_count; ++s) {
    const std::size_t i = load_unsigned(a.sparse_indices + s * component_bytes(a.sparse_index_type),
                                        a.sparse_index_type);
    if (i >= a.count)
      fail(document, "accessor", static_cast<std::size_t>(accessor),
           "has a sparse index past its end");
    read(i, a.sparse_values + s * a.element_bytes());
  }
}

}  // namespace

std::size_t component_bytes(ComponentType type) {
  switch (type) {
    case ComponentType::kInt8:
    case ComponentType::kUint8:
      return 1;
    case ComponentType::kInt16:
    case ComponentType::kUint16:
      return 2;
    default:
      return 4;
  }
}

bool is_unsigned(ComponentType type) {
  return type == ComponentType::kUint8 || type == ComponentType::kUint16 ||
         type == ComponentType::kUint32;
}

std::vector<float> read_floats(const Document& document, int accessor) {
  const Accessor& a = entry(document.accessors, accessor);
  const auto components = static_cast<std::size_t>(a.components);
  const std::size_t width = component_bytes(a.type);
  std::vector<float> values(a.count * components, 0.0f);
  for_each_element(document, accessor, [&](std::size_t i, const unsigned char* bytes) {
    for (std::size_t c = 0; c < components; ++c)
      values[i * components + c] = load_float(bytes + c * width, a.type, a.normalized);
  });
  if (!std::ranges::all_of(values, [](float v) { return std::isfinite(v); }))
    fail(document, "accessor", static_cast<std::size_t>(accessor),
         "holds a number that is not finite");
  return values;
}

std::vector<std::uint32_t> read_unsigned(const Document& document, int accessor) {
  const Accessor& a = entry(document.accessors, accessor);
  if (!is_unsigned(a.type) || a.normalized)
    fail(document, "accessor", static_cast<std::size_t>(accessor),
         "holds indices but is not of plain unsigned integers");
  const auto components = static_cast<std::size_t>(a.components);
  const std::size_t width = component_bytes(a.type);
  std::vector<std::uint32_t> values(a.count * components, 0);
  for_each_element(document, accessor, [&](std::size_t i, const unsigned char* bytes) {
    for (std::size_t c = 0; c < components; ++c)
      values[i * components + c] = load_unsigned(bytes + c * width, a.type);
  });
  return values;
}

const Accessor& expect_components(const Document& document, int accessor, int components,
                                  const std::string& place) {
  const Accessor& a = entry(document.accessors, accessor);
  if (a.components != components)
    throw bad_input(document.path, place + " has " + std::to_string(a.components) +
                                       " numbers an element instead of " +
                                       std::to_string(components));
  return a;
}

}  // namespace mdk::gltf
