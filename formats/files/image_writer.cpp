// PNG through libpng's simplified writer: into memory first, so that what can fail in libpng and
// what can fail on disk stay apart. It adds an sRGB chunk and no time.
#include "formats/files/image_writer.h"

#include <png.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr int kChannels = 3;

std::vector<png_byte> without_alpha(std::span<const std::uint32_t> pixels) {
  std::vector<png_byte> rgb(pixels.size() * kChannels);
  png_byte* out = rgb.data();
  for (const std::uint32_t pixel : pixels) {
    *out++ = static_cast<png_byte>(pixel);
    *out++ = static_cast<png_byte>(pixel >> 8);
    *out++ = static_cast<png_byte>(pixel >> 16);
  }
  return rgb;
}

}  // namespace

void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint32_t> pixels, Overwrite overwrite) {
  if (pixels.size() != std::uint64_t{width} * height) {
    throw std::logic_error("write_png: the pixels do not fill the picture");
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;  // zlib level 3, no row filters
  const std::vector<png_byte> rgb = without_alpha(pixels);
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<std::byte> encoded(bytes);
  constexpr int kPackedRows = 0;
  const int done = png_image_write_to_memory(&image, encoded.data(), &bytes, /*convert_to_8bit=*/0,
                                             rgb.data(), kPackedRows, nullptr);
  if (done == 0) {
    throw io_error(path, std::string("cannot be encoded as PNG: ") + image.message);
  }
  AtomicFile file(path, overwrite);
  file.write(std::span(encoded).first(bytes));
  file.commit();
}

}  // namespace mdk
