// tinygltf parses the JSON, takes the GLB apart and decodes data URIs. It opens no file itself, and
// leaves images as they are. It sees only what the schema check has accepted.
#include "formats/gltf/parse.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <utility>

#include "common/base/error.h"
#include "common/base/text.h"
#include "formats/files/byte_order.h"
#include "formats/gltf/schema.h"

namespace mdk::gltf {
namespace {

constexpr std::size_t kMaxJsonBytes = std::size_t{1} << 30;
constexpr std::size_t kGlbJsonStart = 20;  // magic, version, length; the JSON's length and kind

bool is_glb(const Bytes& bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

std::size_t glb_word(const Bytes& bytes, std::size_t at) { return load<std::uint32_t>(&bytes[at]); }

/// The chunks end within the file: tinygltf 2.7 does not count the head of the binary one.
void check_glb(const std::string& path, const Bytes& bytes) {
  constexpr std::uint32_t kJsonKind = 0x4e4f534a;
  constexpr std::size_t kChunkHeadBytes = 8;
  if (bytes.size() < kGlbJsonStart) throw bad_input(path, "ends within its GLB header");
  if (glb_word(bytes, 4) != 2)
    throw bad_input(path, "is not version 2 of GLB; convert it to glTF 2.0");
  const std::size_t length = glb_word(bytes, 8), json_bytes = glb_word(bytes, 12);
  if (glb_word(bytes, 16) != kJsonKind || length > bytes.size() || length < kGlbJsonStart ||
      json_bytes > length - kGlbJsonStart)
    throw bad_input(path, "has no whole JSON chunk; it may be cut short");
  const std::size_t rest = length - kGlbJsonStart - json_bytes;
  if (rest > 0 && (rest < kChunkHeadBytes ||
                   glb_word(bytes, kGlbJsonStart + json_bytes) > rest - kChunkHeadBytes))
    throw bad_input(path, "has no whole binary chunk; it may be cut short");
}

/// The same file with another JSON.
Bytes with_json(const Bytes& bytes, std::string_view json) {
  if (!is_glb(bytes)) return Bytes(json.begin(), json.end());
  const auto at = [&](std::size_t offset) {
    return bytes.begin() + static_cast<std::ptrdiff_t>(offset);
  };
  const std::size_t padded = (json.size() + 3) / 4 * 4;
  Bytes out(at(0), at(kGlbJsonStart));
  out.insert(out.end(), json.begin(), json.end());
  out.resize(kGlbJsonStart + padded, ' ');
  out.insert(out.end(), at(kGlbJsonStart + glb_word(bytes, 12)), at(glb_word(bytes, 8)));
  for (const auto& [field, value] : {std::pair(8, out.size()), std::pair(12, padded)})
    for (int i = 0; i < 4; ++i)
      out[static_cast<std::size_t>(field + i)] = static_cast<unsigned char>(value >> (8 * i));
  return out;
}

/// What tinygltf's file callbacks share: they serve the buffers of the schema, in order, and
/// nothing else, so that no other file is ever opened.
struct BufferFiles {
  const std::string& path;
  std::vector<std::string>& dependencies;
  std::vector<BufferSource> requested = {};
  std::size_t next = 0;
  std::exception_ptr failure = nullptr;
};

bool is_requested(const std::string&, void* user) {
  const auto& files = *static_cast<BufferFiles*>(user);
  return files.next < files.requested.size();
}

std::string same_name(const std::string& name, void*) { return name; }

bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string&, void* user) {
  auto& files = *static_cast<BufferFiles*>(user);
  const BufferSource& buffer = files.requested[files.next++];
  try {
    const std::string file = resolve_uri(files.path, buffer.uri);
    *out = read_whole_file(file);
    files.dependencies.push_back(file);
    if (out->size() < buffer.bytes)
      throw bad_input(file, "holds " + std::to_string(out->size()) + " bytes where " +
                                std::to_string(buffer.bytes) + " are needed; it may be cut short");
    out->resize(buffer.bytes);
    return true;
  } catch (...) {
    files.failure = std::current_exception();
    return false;
  }
}

bool no_writing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// Keeps a data URI's bytes as they are. Images in buffer views are found through their view later.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
  return true;
}

}  // namespace

std::string_view json_text(const std::string& path, const Bytes& bytes) {
  std::string_view json(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (is_glb(bytes)) {
    check_glb(path, bytes);
    json = json.substr(kGlbJsonStart, glb_word(bytes, 12));
  }
  if (json.size() > kMaxJsonBytes) throw bad_input(path, "has more than 1 GiB of JSON");
  return json;
}

tinygltf::Model parse_gltf(const std::string& path, const Bytes& bytes, const Schema& schema,
                           std::vector<std::string>& dependencies) {
  const Bytes plain = schema.plain_json.empty() ? Bytes() : with_json(bytes, schema.plain_json);
  const Bytes& file = plain.empty() ? bytes : plain;
  BufferFiles files{path, dependencies};
  for (const BufferSource& buffer : schema.buffers)
    if (buffer.is_file()) files.requested.push_back(buffer);
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  loader.SetFsCallbacks({is_requested, same_name, read_buffer, no_writing, &files});
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned int>(file.size());
  bool loaded = false;
  try {
    loaded = is_glb(file)
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning, file.data(), size, "")
                 : loader.LoadASCIIFromString(&model, &error, &warning,
                                              reinterpret_cast<const char*>(file.data()), size, "");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    error = "its parts do not fit together";
  }
  if (files.failure) std::rethrow_exception(files.failure);
  if (!loaded) {
    // Its first line, without the bytes of a data URI.
    const std::size_t end = std::min({error.find('\n'), error.find("data:"), std::size_t{200}});
    throw bad_input(path, "is not usable glTF (" + printable_line(error.substr(0, end)) + ")");
  }
  return model;
}

}  // namespace mdk::gltf
