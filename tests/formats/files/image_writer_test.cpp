// Pictures come back from an independent reading of the file, pixel by pixel.
#include "formats/files/image_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <random>
#include <set>

#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

struct Picture {
  std::uint32_t width = 0, height = 0;
  Bytes rgb;
};

Picture read_png(const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) throw std::runtime_error(path);
  image.format = PNG_FORMAT_RGB;
  Picture picture{image.width, image.height, Bytes(PNG_IMAGE_SIZE(image))};
  if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) {
    throw std::runtime_error(path);
  }
  return picture;
}

/// Types of the chunks, in order.
std::vector<std::string> chunk_types(const Bytes& png) {
  std::vector<std::string> types;
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t length = std::size_t{png[at]} << 24 | std::size_t{png[at + 1]} << 16 |
                               std::size_t{png[at + 2]} << 8 | png[at + 3];
    types.emplace_back(png.begin() + static_cast<std::ptrdiff_t>(at + 4),
                       png.begin() + static_cast<std::ptrdiff_t>(at + 8));
    at += length + 12;
  }
  return types;
}

std::vector<std::uint32_t> noise(std::size_t count) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> pixels(count);
  for (std::uint32_t& pixel : pixels) pixel = random();
  return pixels;
}

class ImageWriterTest : public testing::Test {
 protected:
  TempFolder folder_;
  std::string path_ = folder_.file("frame.png");
};

TEST_F(ImageWriterTest, KeepsChannelsRowsAndDropsAlpha) {
  const std::vector<std::uint32_t> pixels = {0xff0000ff, 0x0000ff00, 0x80ff0000,
                                             0xff030201, 0xffffffff, 0x00000000};
  write_png(path_, 3, 2, pixels);
  const Picture picture = read_png(path_);
  EXPECT_EQ(picture.width, 3u);
  EXPECT_EQ(picture.height, 2u);
  EXPECT_EQ(picture.rgb, (Bytes{255, 0, 0, 0, 255, 0, 0, 0, 255, 1, 2, 3, 255, 255, 255, 0, 0, 0}));
}

TEST_F(ImageWriterTest, IsAnEightBitRgbFileWithoutATime) {
  write_png(path_, 5, 4, noise(20));
  const Bytes png = read_bytes(path_);
  EXPECT_EQ(png[24], 8) << "bits per channel";
  EXPECT_EQ(png[25], 2) << "colour type RGB";
  const auto types = chunk_types(png);
  EXPECT_EQ(types.front(), "IHDR");
  EXPECT_EQ(types.back(), "IEND");
  EXPECT_THAT(types, testing::Contains("sRGB"));
  EXPECT_THAT(std::set<std::string>(types.begin(), types.end()),
              testing::Not(testing::Contains("tIME")));
}

TEST_F(ImageWriterTest, HoldsPicturesThatDoNotCompress) {
  constexpr std::uint32_t kWidth = 301, kHeight = 203;
  const auto pixels = noise(kWidth * kHeight);
  write_png(path_, kWidth, kHeight, pixels);
  const Picture picture = read_png(path_);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::uint32_t read = picture.rgb[3 * i] | std::uint32_t{picture.rgb[3 * i + 1]} << 8 |
                               std::uint32_t{picture.rgb[3 * i + 2]} << 16;
    ASSERT_EQ(read, pixels[i] & 0xffffff) << "pixel " << i;
  }
}

TEST_F(ImageWriterTest, SamePixelsGiveTheSameBytes) {
  const auto pixels = noise(64 * 64);
  write_png(path_, 64, 64, pixels);
  write_png(folder_.file("again.png"), 64, 64, pixels);
  EXPECT_EQ(read_bytes(path_), read_bytes(folder_.file("again.png")));
}

TEST_F(ImageWriterTest, SaysWhereItCannotWriteAndLeavesNothing) {
  expect_error(ErrorCode::kIo, "none/frame.png: cannot be written",
               [&] { write_png(folder_.file("none/frame.png"), 1, 1, noise(1)); });
  expect_error(ErrorCode::kIo, "frame.png: cannot be encoded as PNG",
               [&] { write_png(path_, 0, 0, {}); });
  EXPECT_THAT(folder_.names(), testing::IsEmpty());
}

TEST_F(ImageWriterTest, RefusesPixelsThatDoNotFillThePicture) {
  EXPECT_THROW(write_png(path_, 3, 2, noise(5)), std::logic_error);
}

}  // namespace
}  // namespace mdk::test
