#include "formats/gltf/files.h"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include "common/base/error.h"
#include "common/base/text.h"
#include "formats/files/byte_order.h"
#include "formats/files/file_kind.h"

namespace mdk::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 30;
constexpr std::uintmax_t kMaxFileBytes = 0xffffffffu;  // a .glb counts its bytes in 32 bits

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

std::optional<Bytes> data_uri_bytes(std::string_view uri) {
  constexpr std::string_view kBase64 = ";base64,";
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::size_t mark = uri.find(kBase64);
  if (!uri.starts_with("data:") || mark == std::string_view::npos) return std::nullopt;
  Bytes bytes;
  std::size_t bits = 0;
  int bit_count = 0;
  for (const char c : uri.substr(mark + kBase64.size())) {
    const std::size_t digit = kDigits.find(c);
    if (digit == kDigits.npos) break;
    bits = bits << 6 | digit;
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes.push_back(static_cast<unsigned char>(bits >> bit_count));
  }
  return bytes;
}

/// magic, version, length | JSON length, kind, JSON | binary length, kind, bytes.
FileParts file_parts(const std::string& path, const Bytes& bytes) {
  constexpr std::size_t kJsonStart = 20, kHeadBytes = 8;
  const auto word = [&](std::size_t at) { return load<std::uint32_t>(&bytes[at]); };
  const char* text = reinterpret_cast<const char*>(bytes.data());
  FileParts parts{{text, bytes.size()}, {}};
  if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
    if (bytes.size() < kJsonStart) throw bad_input(path, "ends within its GLB header");
    if (word(4) != 2) throw bad_input(path, "is not version 2 of GLB; convert it to glTF 2.0");
    const std::size_t length = word(8), json_bytes = word(12);
    if (word(16) != 0x4e4f534au || length > bytes.size() || length < kJsonStart ||
        json_bytes > length - kJsonStart)
      throw bad_input(path, "has no whole JSON chunk; it may be cut short");
    parts.json = parts.json.substr(kJsonStart, json_bytes);
    if (const std::size_t json_end = kJsonStart + json_bytes; json_end != length) {
      const std::size_t left = length - json_end;
      if (left < kHeadBytes + 4 || word(json_end + 4) != 0x004e4942u || word(json_end) < 4 ||
          word(json_end) % 4 != 0 || word(json_end) > left - kHeadBytes)
        throw bad_input(path, "has no whole binary chunk; it may be cut short");
      parts.binary = std::span(bytes).subspan(json_end + kHeadBytes, word(json_end));
    }
  }
  if (parts.json.size() > kMaxJsonBytes) throw bad_input(path, "has more than 1 GiB of JSON");
  return parts;
}

}  // namespace mdk::gltf
