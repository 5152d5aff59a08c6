#include "formats/gltf/files.h"

#include <cstdint>
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

constexpr std::uintmax_t kMaxFileBytes =
    0xffffffffu;  // tinygltf, and a .glb, count bytes in 32 bits

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

}  // namespace mdk::gltf
