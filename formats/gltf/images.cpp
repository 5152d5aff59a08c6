// PNG through libpng, which inflates row by row: stb_image inflates all there is before it looks at
// the picture's size, so that a megabyte could ask for gigabytes. JPEG through stb_image.
#include "formats/gltf/images.h"

#include <png.h>
#include <stb_image.h>

#include <csetjmp>
#include <cstring>
#include <limits>
#include <memory>

#include "formats/files/byte_order.h"

namespace mdk::gltf {
namespace {

constexpr std::uint64_t kMaxTexels = 64'000'000;               // of one image
constexpr std::size_t kMaxTexelsInAll = std::size_t{1} << 28;  // of an appearance

bool starts_with(std::span<const unsigned char> bytes, std::span<const unsigned char> magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

bool is_png(std::span<const unsigned char> bytes) {
  constexpr unsigned char kMagic[] = {0x89, 'P', 'N', 'G'};
  return starts_with(bytes, kMagic);
}

/// stb_image reads many formats; glTF has two, and each further one is a door for bad files.
bool is_jpeg(std::span<const unsigned char> bytes) {
  constexpr unsigned char kMagic[] = {0xff, 0xd8, 0xff};
  return starts_with(bytes, kMagic);
}

DecodedImage refused(const std::string& problem) { return {0, 0, {}, problem}; }

bool is_too_large(std::uint64_t width, std::uint64_t height) {
  return width > kMaxTexels || height > kMaxTexels || width * height > kMaxTexels;
}

/// libpng leaves by longjmp where something is wrong: its two calls have no objects to destroy.
class PngReader {
 public:
  explicit PngReader(std::span<const unsigned char> bytes) : rest_(bytes) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave, ignore);
    if (png_) info_ = png_create_info_struct(png_);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  /// Colour data is taken as it is (glTF 2.0 §3.8.3: colour space chunks do not count), and so are
  /// wrong checksums. False where the head cannot be read.
  bool read_head() {
    if (!info_ || setjmp(png_jmpbuf(png_))) return false;
    png_set_read_fn(png_, this, give);
    png_set_crc_action(png_, PNG_CRC_QUIET_USE, PNG_CRC_QUIET_USE);
    png_read_info(png_, info_);
    png_set_expand(png_);
    png_set_strip_16(png_);
    png_set_gray_to_rgb(png_);
    png_set_add_alpha(png_, 0xff, PNG_FILLER_AFTER);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return png_get_rowbytes(png_, info_) == std::size_t{4} * width();
  }
  std::uint32_t width() const { return png_get_image_width(png_, info_); }
  std::uint32_t height() const { return png_get_image_height(png_, info_); }

  /// As many rows as the picture is high, of 4 * width bytes.
  bool read_rows(unsigned char** rows) {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_read_image(png_, rows);
    return true;
  }

 private:
  [[noreturn]] static void leave(png_structp png, png_const_charp) { png_longjmp(png, 1); }
  static void ignore(png_structp, png_const_charp) {}
  static void give(png_structp png, png_bytep out, std::size_t size) {
    auto& rest = static_cast<PngReader*>(png_get_io_ptr(png))->rest_;
    if (size > rest.size()) png_error(png, "cut short");
    std::memcpy(out, rest.data(), size);
    rest = rest.subspan(size);
  }

  std::span<const unsigned char> rest_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

DecodedImage decode_png(std::span<const unsigned char> bytes) {
  PngReader reader(bytes);
  if (!reader.read_head()) return refused("cannot be decoded");
  if (is_too_large(reader.width(), reader.height())) return refused("has more than 64 megapixels");
  const std::size_t row = std::size_t{4} * reader.width();
  std::vector<unsigned char> pixels(row * reader.height());
  std::vector<unsigned char*> rows;
  for (std::size_t y = 0; y < reader.height(); ++y) rows.push_back(pixels.data() + y * row);
  if (!reader.read_rows(rows.data())) return refused("cannot be decoded");
  DecodedImage image{reader.width(), reader.height(), {}, {}};
  image.texels.reserve(pixels.size() / 4);
  for (std::size_t i = 0; i < pixels.size(); i += 4)
    image.texels.push_back(load<std::uint32_t>(&pixels[i]));
  return image;
}

DecodedImage decode_jpeg(std::span<const unsigned char> bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    return refused("is larger than 2 GiB");
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(bytes.data(), size, &width, &height, &channels) || width < 1 ||
      height < 1)
    return refused("cannot be decoded");
  const auto w = static_cast<std::uint32_t>(width), h = static_cast<std::uint32_t>(height);
  if (is_too_large(w, h)) return refused("has more than 64 megapixels");
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4), stbi_image_free);
  if (!pixels || static_cast<std::uint32_t>(width) != w || static_cast<std::uint32_t>(height) != h)
    return refused("cannot be decoded");
  DecodedImage image{w, h, {}, {}};
  image.texels.resize(std::size_t{w} * h);
  for (std::size_t i = 0; i < image.texels.size(); ++i)
    image.texels[i] = load<std::uint32_t>(pixels.get() + 4 * i);
  return image;
}

}  // namespace

DecodedImage decode_image(std::span<const unsigned char> bytes) {
  if (is_png(bytes)) return decode_png(bytes);
  if (is_jpeg(bytes)) return decode_jpeg(bytes);
  return refused("is neither PNG nor JPEG");
}

std::uint32_t add_texture(std::span<const unsigned char> bytes, Appearance& appearance,
                          std::string& problem) {
  const DecodedImage decoded = decode_image(bytes);
  problem = decoded.problem;
  if (problem.empty() && decoded.texels.size() > kMaxTexelsInAll - appearance.texels.size())
    problem = "would make more than 268 million texels";
  if (!problem.empty()) return kNoTexture;
  const auto number = static_cast<std::uint32_t>(appearance.textures.size());
  appearance.textures.push_back({decoded.width, decoded.height, appearance.texels.size()});
  appearance.texels.insert(appearance.texels.end(), decoded.texels.begin(), decoded.texels.end());
  return number;
}

}  // namespace mdk::gltf
