#include "formats/gltf_files.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include "common/base/error.h"
#include "common/base/text.h"
#include "formats/files/file_kind.h"

namespace mdk::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 30;
constexpr std::uintmax_t kMaxFileBytes = 0xffffffffu;  // tinygltf counts bytes in 32 bits

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size()) {
      const int high = hex_digit(uri[i + 1]), low = hex_digit(uri[i + 2]);
      if (high >= 0 && low >= 0) {
        text += static_cast<char>(high * 16 + low);
        i += 2;
        continue;
      }
    }
    text += uri[i];
  }
  return text;
}

std::uint32_t little_endian_u32(const unsigned char* bytes) {
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
         std::uint32_t{bytes[3]} << 24;
}

/// "http://…", "file:…": letters, then a colon before any slash.
bool has_scheme(const std::string& uri) {
  const std::size_t colon = uri.find(':');
  return colon != std::string::npos && uri.find('/') > colon;
}

}  // namespace

Bytes read_whole_file(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw io_error(path, "there is no such file");
  // Anything else could block for ever (a pipe) or never end (a device).
  if (!fs::is_regular_file(status)) throw io_error(path, "is not a file");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw io_error(path, "cannot be read: " + error.message());
  if (size > kMaxFileBytes)
    throw Error(ErrorCode::kOverLimit, path + ": is larger than 4 GiB; split it");
  Bytes bytes(static_cast<std::size_t>(size));
  std::ifstream in(path, std::ios::binary);
  if (!in) throw io_error(path, "cannot be opened; check its permissions");
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size())
    throw io_error(path, "could not be read to its end");
  return bytes;
}

std::string resolve_uri(const std::string& gltf_path, const std::string& uri) {
  const std::string name = percent_decoded(uri);
  if (name.size() > kMaxNameBytes)
    throw bad_input(gltf_path, "refers to \"" + printable_line(uri.substr(0, 40)) +
                                   "…\", which at " + std::to_string(name.size()) +
                                   " bytes is no name that a file can have");
  const std::optional<std::string> path = neighbor_path(gltf_path, name);
  if (!path || has_scheme(name))
    throw bad_input(gltf_path, "refers to \"" + printable_line(uri.substr(0, 200)) +
                                   "\", which is not a file in its own folder; put it there");
  return *path;
}

bool is_glb(const Bytes& bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

std::string_view json_text(const std::string& path, const Bytes& bytes) {
  const char* text = reinterpret_cast<const char*>(bytes.data());
  std::string_view json(text, bytes.size());
  if (is_glb(bytes)) {
    if (bytes.size() < 20) throw bad_input(path, "ends within its GLB header");
    if (little_endian_u32(bytes.data() + 4) != 2)
      throw bad_input(path, "is not version 2 of GLB; convert it to glTF 2.0");
    const std::size_t json_bytes = little_endian_u32(bytes.data() + 12);
    if (little_endian_u32(bytes.data() + 16) != 0x4e4f534au || json_bytes > bytes.size() - 20)
      throw bad_input(path, "has no whole JSON chunk; it may be cut short");
    json = std::string_view(text + 20, json_bytes);
  }
  if (json.size() > kMaxJsonBytes) throw bad_input(path, "has more than 1 GiB of JSON");
  return json;
}

Bytes with_json(const Bytes& bytes, std::string_view json) {
  if (!is_glb(bytes)) return Bytes(json.begin(), json.end());
  const std::size_t padded = (json.size() + 3) / 4 * 4;
  const std::size_t old_end = 20 + little_endian_u32(bytes.data() + 12);
  Bytes out(bytes.begin(), bytes.begin() + 20);
  out.insert(out.end(), json.begin(), json.end());
  out.resize(20 + padded, ' ');
  out.insert(out.end(), bytes.begin() + static_cast<std::ptrdiff_t>(old_end), bytes.end());
  const std::size_t sizes[] = {out.size(), padded};
  for (std::size_t field = 0; field < 2; ++field)
    for (std::size_t i = 0; i < 4; ++i)
      out[8 + 4 * field + i] = static_cast<unsigned char>(sizes[field] >> (8 * i));
  return out;
}

}  // namespace mdk::gltf
