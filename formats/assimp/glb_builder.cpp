// GlbBuilder: see import.h.
#include <cstring>
#include <utility>

#include "common/base/error.h"
#include "formats/assimp/import.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxBytes = 0xf0000000u;  // of 4 GiB, with room for the JSON
constexpr int kUint16 = 5123, kUint32 = 5125, kFloat32 = 5126;

std::size_t components_of(const char* type) {
  if (std::strcmp(type, "SCALAR") == 0) return 1;
  if (std::strcmp(type, "MAT4") == 0) return 16;
  return static_cast<std::size_t>(type[3] - '0');
}

template <class Number>
std::span<const unsigned char> bytes_of(std::span<const Number> numbers) {
  return {reinterpret_cast<const unsigned char*>(numbers.data()), numbers.size_bytes()};
}

void append_u32(std::vector<unsigned char>& out, std::size_t value) {
  for (std::size_t i = 0; i < 4; ++i) out.push_back(static_cast<unsigned char>(value >> (8 * i)));
}

/// Length, kind and content, which `filler` brings to a multiple of four.
void append_chunk(std::vector<unsigned char>& out, const char* kind,
                  std::span<const unsigned char> content, unsigned char filler) {
  append_u32(out, (content.size() + 3) / 4 * 4);
  out.insert(out.end(), kind, kind + 4);
  out.insert(out.end(), content.begin(), content.end());
  while (out.size() % 4 != 0) out.push_back(filler);
}

}  // namespace

GlbBuilder::GlbBuilder(const std::string& path)
    : path_(path), root_{{"asset", {{"version", "2.0"}}}} {}

std::size_t GlbBuilder::add(const char* kind, Json object) {
  root_[kind].push_back(std::move(object));
  return root_[kind].size() - 1;
}

std::size_t GlbBuilder::add_bytes(std::span<const unsigned char> bytes) {
  if (bytes.size() > kMaxBytes - binary_.size())
    throw Error(ErrorCode::kOverLimit, path_ + ": holds over 4 GB of meshes and tracks; split it");
  const std::size_t offset = binary_.size();
  binary_.insert(binary_.end(), bytes.begin(), bytes.end());
  binary_.resize((binary_.size() + 3) / 4 * 4);
  return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
}

std::size_t GlbBuilder::add_accessor(const char* type, int component_type,
                                     std::span<const unsigned char> bytes, std::size_t count) {
  const std::size_t view = add_bytes(bytes);
  return add(
      "accessors",
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
}

std::size_t GlbBuilder::add_floats(const char* type, std::span<const float> numbers) {
  return add_accessor(type, kFloat32, bytes_of(numbers), numbers.size() / components_of(type));
}

std::size_t GlbBuilder::add_indices(std::span<const std::uint32_t> numbers) {
  return add_accessor("SCALAR", kUint32, bytes_of(numbers), numbers.size());
}

std::size_t GlbBuilder::add_joints(std::span<const std::uint16_t> numbers) {
  return add_accessor("VEC4", kUint16, bytes_of(numbers), numbers.size() / 4);
}

std::vector<unsigned char> GlbBuilder::finish() {
  if (!binary_.empty()) add("buffers", {{"byteLength", binary_.size()}});
  const std::string json =
      std::exchange(root_, {}).dump(-1, ' ', false, Json::error_handler_t::replace);
  std::vector<unsigned char> out = {'g', 'l', 'T', 'F'};
  append_u32(out, 2);
  append_u32(out, 0);
  append_chunk(out, "JSON", {reinterpret_cast<const unsigned char*>(json.data()), json.size()},
               ' ');
  if (!binary_.empty()) append_chunk(out, std::string("BIN\0", 4).data(), binary_, 0);
  std::vector<unsigned char> size;
  append_u32(size, out.size());
  std::memcpy(out.data() + 8, size.data(), size.size());
  return out;
}

}  // namespace mdk
