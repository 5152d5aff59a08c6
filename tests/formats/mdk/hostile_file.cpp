#include "tests/formats/mdk/hostile_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>

#include "common/base/error.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/formats/mdk/mdk_image.h"

namespace mdk::test {
HostileFile::HostileFile(const ModelStorage& sample) : path_(folder_.file("sample.mdk")) {
  write_mdk(sample.view(), path_);
  bytes_ = read_bytes(path_);
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
}

HostileFile::~HostileFile() { ::close(descriptor_); }

std::vector<ByteRange> HostileFile::ranges() const {
  const auto table = read_table(bytes_);
  std::vector<ByteRange> ranges = {
      {"header and table", 0, kHeaderBytes + table.size() * kEntryBytes}};
  for (const ImageSection& section : table) {
    ranges.push_back({section.id, section.offset, section.offset + section.bytes()});
  }
  return ranges;
}

Bytes HostileFile::with_word(std::size_t at, std::uint32_t word) const {
  Bytes damaged = bytes_;
  put(damaged, at, word);
  seal(damaged);
  return damaged;
}

Bytes HostileFile::with_flip(std::size_t at, int bit) const {
  Bytes damaged = bytes_;
  damaged[at] ^= static_cast<unsigned char>(1u << bit);
  return damaged;
}

std::optional<ModelStorage> HostileFile::open(const Bytes& bytes) {
  EXPECT_EQ(::ftruncate(descriptor_, static_cast<off_t>(bytes.size())), 0);
  EXPECT_EQ(::pwrite(descriptor_, bytes.data(), bytes.size(), 0),
            static_cast<ssize_t>(bytes.size()));
  try {
    const MdkFile file(path_);
    return copy_of(file.model());
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kBadInput) << error.what();
    EXPECT_THAT(error.what(), testing::StartsWith(path_ + ": "));
    return std::nullopt;
  }
}

std::vector<std::uint32_t> extreme_words() {
  return {0,
          1,
          2,
          0x3fffffff,
          0x40000000,
          0x7fffffff,
          0x80000000,
          0xfffffffe,
          0xffffffff,
          std::bit_cast<std::uint32_t>(3e38f),
          std::bit_cast<std::uint32_t>(-1e-40f),
          std::bit_cast<std::uint32_t>(std::nanf("")),
          std::bit_cast<std::uint32_t>(HUGE_VALF)};
}

}  // namespace mdk::test
