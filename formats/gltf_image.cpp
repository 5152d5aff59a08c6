#include "formats/gltf_image.h"

#include <stb_image.h>

#include <cstring>
#include <limits>
#include <memory>

namespace mdk::gltf {
namespace {

constexpr std::uint64_t kMaxTexels = 64'000'000;

bool starts_with(std::span<const unsigned char> bytes, std::span<const unsigned char> magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// stb_image reads many formats; glTF has two, and each further one is a door for bad files.
bool is_png_or_jpeg(std::span<const unsigned char> bytes) {
  constexpr unsigned char kPng[] = {0x89, 'P', 'N', 'G'};
  constexpr unsigned char kJpeg[] = {0xff, 0xd8, 0xff};
  return starts_with(bytes, kPng) || starts_with(bytes, kJpeg);
}

DecodedImage refused(const std::string& problem) { return {0, 0, {}, problem}; }

}  // namespace

DecodedImage decode_image(std::span<const unsigned char> bytes) {
  if (!is_png_or_jpeg(bytes)) return refused("is neither PNG nor JPEG");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return refused("is larger than 2 GiB");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) || width < 1 ||
      height < 1)
    return refused("cannot be decoded");
  const std::uint64_t texels =
      static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (texels > kMaxTexels) return refused("has more than 64 megapixels");
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgba(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), stbi_image_free);
  if (!rgba || static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) != texels)
    return refused("cannot be decoded");
  DecodedImage image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}, {}};
  image.texels.resize(texels);
  for (std::size_t i = 0; i < texels; ++i) {
    const stbi_uc* p = rgba.get() + 4 * i;
    image.texels[i] = std::uint32_t{p[0]} | std::uint32_t{p[1]} << 8 | std::uint32_t{p[2]} << 16 |
                      std::uint32_t{p[3]} << 24;
  }
  return image;
}

}  // namespace mdk::gltf
