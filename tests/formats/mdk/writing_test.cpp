// What mdk_writer writes: the bytes that docs/file-format.md promises, whole or not at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/mdk/mdk_file.h"
#include "tests/formats/mdk/sample_model.h"

namespace mdk::test {
namespace {

TEST_F(MdkFileTest, SameModelGivesTheSameBytes) {
  const Bytes first = sample_bytes();
  ModelStorage again = sample_model();
  write_mdk(again.view(), folder_.file("again.mdk"));
  EXPECT_EQ(read_bytes(folder_.file("again.mdk")), first);
}

TEST_F(MdkFileTest, WriterReturnsTheSizeOfTheFile) {
  const std::uint64_t size = write_mdk(sample_model().view(), path_);
  EXPECT_EQ(size, read_bytes(path_).size());
  EXPECT_EQ(MdkFile(path_).file_bytes(), size);
}

/// Remembers what it hears; gives up at the nth report.
struct Listener final : ProgressSink {
  explicit Listener(std::size_t reports) : patience(reports) {}
  void report(std::string_view stage, double fraction) override {
    EXPECT_EQ(stage, "write");
    heard.push_back(fraction);
    if (heard.size() == patience) throw std::runtime_error("enough");
  }
  std::size_t patience;
  std::vector<double> heard;
};

TEST_F(MdkFileTest, WritingTellsHowFarItIs) {
  Listener listener(1000);
  MdkWriteOptions options;
  options.progress = &listener;
  write_mdk(sample_model().view(), path_, options);
  EXPECT_GT(listener.heard.size(), 30u);
  EXPECT_EQ(listener.heard.front(), 0);
  EXPECT_LT(listener.heard.back(), 1);
  EXPECT_TRUE(std::ranges::is_sorted(listener.heard));
}

TEST_F(MdkFileTest, WritingThatIsStoppedLeavesNothing) {
  for (const std::size_t patience : {1u, 20u}) {
    Listener listener(patience);
    MdkWriteOptions options;
    options.progress = &listener;
    EXPECT_THROW(write_mdk(sample_model().view(), path_, options), std::runtime_error);
    EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(path_).parent_path()));
  }
}

TEST_F(MdkFileTest, HeaderIsAsSpecified) {
  const Bytes bytes = sample_bytes();
  const Bytes magic = {0x89, 'M', 'D', 'K', 0x0d, 0x0a, 0x1a, 0x0a, 4, 3, 2, 1, 3, 0, 0, 0};
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 16), magic);
  EXPECT_EQ(get<std::uint64_t>(bytes, 16), bytes.size());
  EXPECT_EQ(get<std::uint32_t>(bytes, 24), 38u);
  EXPECT_THAT(Bytes(bytes.begin() + 28, bytes.begin() + 56), testing::Each(0));
  Bytes resealed = bytes;
  seal(resealed);
  EXPECT_EQ(resealed, bytes);
  EXPECT_EQ(checksum_of({}), 0x2d06800538d394c2u) << "XXH3 of nothing, by its specification";
}

TEST_F(MdkFileTest, SectionsAreAlignedApartSealedAndPaddedWithZeros) {
  const Bytes bytes = sample_bytes();
  const auto table = read_table(bytes);
  std::vector<bool> used(bytes.size(), false);
  std::fill_n(used.begin(), kHeaderBytes + table.size() * kEntryBytes, true);
  for (const ImageSection& section : table) {
    EXPECT_EQ(section.offset % 64, 0u) << section.id;
    EXPECT_EQ(section.flags, 1u) << section.id;
    ASSERT_LE(section.offset + section.bytes(), bytes.size()) << section.id;
    for (std::size_t i = 0; i < section.bytes(); ++i) {
      EXPECT_FALSE(used[section.offset + i]) << section.id << " overlaps another";
      used[section.offset + i] = true;
    }
    const auto content = std::as_bytes(std::span(bytes)).subspan(section.offset, section.bytes());
    EXPECT_EQ(section.checksum, checksum_of(content)) << section.id;
  }
  EXPECT_EQ(bytes.size() % 64, 0u);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (!used[i]) {
      EXPECT_EQ(bytes[i], 0) << "gap at " << i;
    }
  }
}

TEST_F(MdkFileTest, RecordsAreAsSpecified) {
  const Bytes bytes = sample_bytes();
  const std::size_t model = find_section(bytes, "MODL").offset;
  const std::uint32_t counts[] = {10, 3, 6, 2, 2, 0, 0, 2};
  for (int i = 0; i < 8; ++i) EXPECT_EQ(get<std::uint32_t>(bytes, model + 4 * i), counts[i]) << i;
  EXPECT_EQ(get<double>(bytes, model + 32), sample_model().rest_diagonal);
  EXPECT_EQ(get<float>(bytes, model + 56), 5.0f) << "bounds.hi.y";
  const std::size_t clips = find_section(bytes, "CLIP").offset;
  const std::uint32_t second_clip[] = {4, 6, 2, 1};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(get<std::uint32_t>(bytes, clips + 16 + 4 * i), second_clip[i]) << i;
  }
  const std::size_t cluster = find_section(bytes, "CLUS").offset + 8;
  EXPECT_EQ(get<std::uint32_t>(bytes, cluster), 4u) << "first triangle";
  EXPECT_EQ(get<std::uint32_t>(bytes, cluster + 4), 2u) << "triangle count";
  const std::size_t segment = find_section(bytes, "SEGM").offset + 8;
  EXPECT_EQ(get<std::uint32_t>(bytes, segment), 2u) << "first key";
  EXPECT_EQ(get<std::uint32_t>(bytes, segment + 4), 2u) << "last key";
  const std::size_t tree = find_section(bytes, "FTRE").offset + 40;
  const std::uint32_t second_tree[] = {5, 1, 5, 2};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(get<std::uint32_t>(bytes, tree + 4 * i), second_tree[i]) << i;
  }
  EXPECT_EQ(get<float>(bytes, tree + 20), 4.0f) << "local_box.lo.y";
  const std::size_t brick = find_section(bytes, "MATL").offset + 32;
  const std::uint32_t links[] = {1, 2, 2, 1};
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(get<std::uint32_t>(bytes, brick + 16 + 4 * i), links[i]) << i;
  const std::size_t key1 = find_section(bytes, "POSE").offset + 12 * 10;
  EXPECT_EQ(get<float>(bytes, key1 + 4), 0.5f) << "cluster 0 rises";
  const std::size_t map = find_section(bytes, "MAPS").offset + 48 * 2;
  EXPECT_EQ(get<float>(bytes, map + 4 * 7), -0.5f) << "row 1, column 3 of key 1, cluster 0";
  const std::size_t key_box = find_section(bytes, "KBOX").offset + 24;
  EXPECT_EQ(get<float>(bytes, key_box + 4), 0.5f) << "lo.y of key 1";
  EXPECT_EQ(get<float>(bytes, key_box + 16), 5.0f) << "hi.y of key 1";
  const std::size_t world_box = find_section(bytes, "WBOX").offset + 12 * 2;
  EXPECT_EQ(get<std::uint16_t>(bytes, world_box + 2), 0u) << "lo.y of key 1, cluster 0";
  EXPECT_EQ(get<std::uint16_t>(bytes, world_box + 8), 14564u) << "hi.y: 1 of 4.5, rounded up";
}

TEST_F(MdkFileTest, OverwritingTheFileLeavesOpenOnesAsTheyWere) {
  const ModelStorage original = sample_model();
  const MdkFile open(written(original));
  ModelStorage other = sample_model();
  other.clips[0].name = "other";
  write_mdk(other.view(), path_);
  expect_same_model(open.model(), original);
  EXPECT_EQ(MdkFile(path_).model().clips[0].name, "other");
}

TEST_F(MdkFileTest, WriterRefusesAnInconsistentModelAndWritesNothing) {
  ModelStorage storage = sample_model();
  storage.fuzzy_trees[1].first_node = 4;
  expect_error(ErrorCode::kInternal, "fuzzy_trees: tree 1: its nodes do not start",
               [&] { write_mdk(storage.view(), path_); });
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(MdkFileTest, WriterNamesAFolderThatDoesNotExist) {
  expect_error(ErrorCode::kIo, "none/walk.mdk: cannot be written",
               [&] { write_mdk(sample_model().view(), folder_.file("none/walk.mdk")); });
}

}  // namespace
}  // namespace mdk::test
