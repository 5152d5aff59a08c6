// Pictures that a glTF file shows: PNG and JPEG.
#include <stb_image_write.h>

#include <numeric>
#include <stdexcept>

#include "formats/files/image_writer.h"
#include "formats/gltf/images.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

void read_image(std::span<const unsigned char> bytes) {
  const gltf::DecodedImage image = gltf::decode_image(bytes);
  if (!image.problem.empty()) return;
  if (image.texels.size() != std::size_t{image.width} * image.height || image.texels.empty())
    throw std::logic_error("decoded more or fewer texels than the picture's size");
}

Bytes jpeg(int width, int height, int channels) {
  std::vector<unsigned char> pixels(static_cast<std::size_t>(width * height * channels));
  std::iota(pixels.begin(), pixels.end(), std::uint8_t{0});
  Bytes file;
  const auto append = [](void* context, void* data, int size) {
    const auto* const bytes = static_cast<unsigned char*>(data);
    auto& whole = *static_cast<Bytes*>(context);
    whole.insert(whole.end(), bytes, bytes + size);
  };
  stbi_write_jpg_to_func(append, &file, width, height, channels, pixels.data(), 60);
  return file;
}

Bytes png() {
  std::vector<std::uint32_t> pixels(5 * 3);
  std::iota(pixels.begin(), pixels.end(), 0xff102030u);
  const TempFolder folder;
  write_png(folder.file("a.png"), 5, 3, pixels);
  return read_bytes(folder.file("a.png"));
}

/// A head and no more: 2 x 2 of a depth and kind, interlaced.
Bytes png_head(unsigned char depth, unsigned char kind) {
  return {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0,   0,     13,   'I', 'H',
          'D',  'R', 0,   0,   0,  2,  0,  0,  0, 2,   depth, kind, 0,   0,
          1,    0,   0,   0,   0,  0,  0,  0,  9, 'I', 'D',   'A',  'T'};
}

}  // namespace

const FuzzTarget& image_target() {
  static const FuzzTarget target = {"image", read_image, [] {
                                      return std::vector<Bytes>{png(),           jpeg(9, 7, 3),
                                                                jpeg(17, 16, 1), png_head(4, 3),
                                                                png_head(16, 6), png_head(1, 0)};
                                    }};
  return target;
}

}  // namespace mdk::test
