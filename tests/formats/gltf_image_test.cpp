#include <gmock/gmock.h>
#include <sys/resource.h>
#include <zlib.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/images.h"

namespace mdk::test {
namespace {

using gltf::decode_image;
using gltf::DecodedImage;
using Bytes = std::vector<unsigned char>;

void append_chunk(Bytes& file, const std::string& name, const Bytes& data) {
  const auto append_word = [&](std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8)
      file.push_back(static_cast<unsigned char>(word >> shift));
  };
  append_word(static_cast<std::uint32_t>(data.size()));
  const std::size_t start = file.size();
  file.insert(file.end(), name.begin(), name.end());
  file.insert(file.end(), data.begin(), data.end());
  append_word(static_cast<std::uint32_t>(
      crc32(0, file.data() + start, static_cast<uInt>(file.size() - start))));
}

/// A grey picture of 8 bits of 2 x 2 texels, over rows that deflate to `packed`.
Bytes grey_png(const Bytes& packed) {
  Bytes file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk(file, "IHDR", {0, 0, 0, 2, 0, 0, 0, 2, 8, 0, 0, 0, 0});
  append_chunk(file, "IDAT", packed);
  append_chunk(file, "IEND", {});
  return file;
}

Bytes deflated(std::size_t zeros) {
  z_stream stream = {};
  deflateInit(&stream, 9);
  Bytes packed(zeros / 500 + 1000), block(std::size_t{1} << 20, 0);
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  for (std::size_t left = zeros; left > 0;) {
    const std::size_t size = std::min(left, block.size());
    stream.next_in = block.data();
    stream.avail_in = static_cast<uInt>(size);
    left -= size;
    deflate(&stream, left > 0 ? Z_NO_FLUSH : Z_FINISH);
  }
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

std::size_t peak_bytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

TEST(GltfImage, GreyBecomesOpaqueColour) {
  const DecodedImage image = decode_image(grey_png(deflated(6)));
  EXPECT_EQ(image.problem, "");
  EXPECT_THAT(image.texels,
              testing::ElementsAre(0xff000000u, 0xff000000u, 0xff000000u, 0xff000000u));
}

TEST(GltfImage, APngThatInflatesToAGigabyteTakesNoSuchMemory) {
  const Bytes bomb = grey_png(deflated(std::size_t{1} << 30));
  ASSERT_LT(bomb.size(), std::size_t{2} << 20);
  const std::size_t before = peak_bytes();
  decode_image(bomb);
  EXPECT_LT(peak_bytes() - before, std::size_t{64} << 20);
}

TEST(GltfImage, AnyCutOrFlippedByteIsDecodedOrRefused) {
  const Bytes good = grey_png(deflated(6));
  for (std::size_t size = 0; size + 16 < good.size(); ++size) {
    const DecodedImage image = decode_image(std::span(good).first(size));
    EXPECT_EQ(image.texels.size(), image.problem.empty() ? 4u : 0u);
  }
  for (std::size_t at = 0; at < good.size(); ++at)
    for (const int flip : {0x01, 0x08, 0x80, 0xff}) {
      Bytes changed = good;
      changed[at] ^= static_cast<unsigned char>(flip);
      const DecodedImage image = decode_image(changed);
      EXPECT_EQ(image.texels.size(), image.problem.empty() ? image.width * image.height : 0u);
    }
}

}  // namespace
}  // namespace mdk::test
