#include "formats/assimp/neighbor_files.h"

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "common/base/error.h"
#include "formats/assimp/scene_import.h"
#include "formats/gltf_files.h"
#include "formats/files/file_kind.h"

namespace mdk {
namespace {

class LoadedFile final : public Assimp::IOStream {
 public:
  explicit LoadedFile(gltf::Bytes bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* out, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    if (whole > 0) std::memcpy(out, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    const std::size_t to = origin == aiOrigin_END ? from - offset : from + offset;
    const bool is_inside = to <= bytes_.size() && (origin == aiOrigin_END || to >= from);
    if (is_inside) at_ = to;
    return is_inside ? aiReturn_SUCCESS : aiReturn_FAILURE;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  gltf::Bytes bytes_;
  std::size_t at_ = 0;
};

/// Assimp 5.2 takes a line of an MD5 text that ends in "\n" alone for one that goes on.
bool wants_carriage_returns(const std::string& path) {
  return has_extension(path, ".md5mesh") || has_extension(path, ".md5anim");
}

gltf::Bytes with_carriage_returns(const gltf::Bytes& text) {
  gltf::Bytes out;
  for (const unsigned char c : text) {
    if (c == '\n' && (out.empty() || out.back() != '\r')) out.push_back('\r');
    out.push_back(c);
  }
  return out;
}

}  // namespace

std::string NeighborFiles::path_of(const char* name) const {
  std::string text(name);
  std::ranges::replace(text, '\\', '/');
  return neighbor_path(input_, text).value_or(std::string());
}

bool NeighborFiles::Exists(const char* name) const {
  const std::string path = path_of(name);
  std::error_code ignored;
  return !path.empty() && std::filesystem::is_regular_file(path, ignored);
}

Assimp::IOStream* NeighborFiles::Open(const char* name, const char* mode) {
  const std::string path = path_of(name);
  if (path.empty() || std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  try {
    gltf::Bytes bytes = gltf::read_whole_file(path);
    if (wants_carriage_returns(path)) bytes = with_carriage_returns(bytes);
    auto* file = new LoadedFile(std::move(bytes));
    if (std::ranges::find(opened_, path) == opened_.end()) opened_.push_back(path);
    return file;
  } catch (const Error&) {
    return nullptr;
  }
}

void NeighborFiles::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace mdk
