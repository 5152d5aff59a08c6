// tinygltf parses the JSON, takes the GLB apart and decodes data URIs. It opens no file itself, and
// leaves images as they are.
#include "formats/gltf_parse.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <exception>
#include <new>

#include "common/base/error.h"

namespace mdk::gltf {
namespace {

/// What tinygltf's file callbacks share: they serve the buffers of the schema, in order, and
/// nothing else, so that no other file is ever opened.
struct BufferFiles {
  const std::string& path;
  const std::vector<ExternalBuffer>& wanted;
  std::vector<std::string>& dependencies;
  std::size_t next = 0;
  std::exception_ptr failure;
};

bool buffer_wanted(const std::string&, void* user) {
  const auto& files = *static_cast<BufferFiles*>(user);
  return files.next < files.wanted.size();
}

std::string same_name(const std::string& name, void*) { return name; }

bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string&, void* user) {
  auto& files = *static_cast<BufferFiles*>(user);
  const ExternalBuffer& buffer = files.wanted[files.next++];
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

tinygltf::Model parse_gltf(const GltfText& text, std::vector<std::string>& dependencies) {
  const Bytes& bytes = text.bytes;
  BufferFiles files{text.path, text.external_buffers, dependencies, 0, nullptr};
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_encoded, nullptr);
  loader.SetFsCallbacks({buffer_wanted, same_name, read_buffer, no_writing, &files});
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned int>(bytes.size());
  bool loaded = false;
  try {
    loaded =
        is_glb(bytes)
            ? loader.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(), size, "")
            : loader.LoadASCIIFromString(&model, &error, &warning,
                                         reinterpret_cast<const char*>(bytes.data()), size, "");
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    error = "its parts do not fit together";
  }
  if (files.failure) std::rethrow_exception(files.failure);
  if (!loaded) {
    // Its first line, without the bytes of a data URI.
    const std::size_t end = std::min({error.find('\n'), error.find("data:"), std::size_t{200}});
    throw bad_input(files.path, "is not usable glTF (" + error.substr(0, end) + ")");
  }
  return model;
}

}  // namespace mdk::gltf
