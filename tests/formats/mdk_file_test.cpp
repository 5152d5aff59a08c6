// Writing and mapping .mdk files: what goes in comes out, in the bytes docs/file-format.md
// promises, and what is not such a file is refused with the right sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "formats/mdk_sections.h"
#include "formats/mdk_view.h"
#include "formats/mdk_writer.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/mdk_image.h"
#include "tests/formats/sample_model.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

class MdkFileTest : public testing::Test {
 protected:
  std::string written(const ModelStorage& storage) {
    write_mdk(storage.view(), path_);
    return path_;
  }
  Bytes sample_bytes() { return read_bytes(written(sample_model())); }
  void expect_refused(const Bytes& bytes, const std::string& words) {
    write_bytes(path_, bytes);
    expect_error(ErrorCode::kBadInput, words, [&] { MdkFile file(path_); });
  }

  TempFolder folder_;
  std::string path_ = folder_.file("walk.mdk");
};

template <class T>
void expect_same(const char* name, std::span<const T> mapped, const std::vector<T>& original) {
  ASSERT_EQ(mapped.size(), original.size()) << name;
  if (original.empty()) return;
  EXPECT_EQ(std::memcmp(mapped.data(), original.data(), mapped.size_bytes()), 0) << name;
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(mapped.data()) % 64, 0u) << name;
}

void expect_same_poses(const PoseSource& mapped, const PoseStorage& original) {
  EXPECT_EQ(mapped.kind, original.kind);
  expect_same("key_positions", mapped.key_positions, original.key_positions);
  expect_same("base_positions", mapped.rig.base_positions, original.rig.base_positions);
  expect_same("first_weight", mapped.rig.first_weight, original.rig.first_weight);
  expect_same("bone_weights", mapped.rig.bone_weights, original.rig.bone_weights);
  expect_same("first_offset", mapped.rig.first_offset, original.rig.first_offset);
  expect_same("morph_offsets", mapped.rig.morph_offsets, original.rig.morph_offsets);
  expect_same("bone_maps", mapped.rig.bone_maps, original.rig.bone_maps);
  expect_same("quantization_error", mapped.quantized.error, original.quantized.error);
  expect_same("first_vertex", mapped.quantized.first_vertex, original.quantized.first_vertex);
  expect_same("rest_positions", mapped.quantized.rest_positions, original.quantized.rest_positions);
  expect_same("quantized_blocks", mapped.quantized.blocks, original.quantized.blocks);
  expect_same("quantized_words", mapped.quantized.words, original.quantized.words);
  expect_same("target_weights", mapped.rig.target_weights, original.rig.target_weights);
}

void expect_same_model(const Model& mapped, const ModelStorage& original) {
  EXPECT_EQ(mapped.vertex_count, original.vertex_count);
  EXPECT_EQ(mapped.rest_key, original.rest_key);
  EXPECT_EQ(mapped.bounds, original.bounds);
  EXPECT_EQ(mapped.rest_diagonal, original.rest_diagonal);
  EXPECT_THAT(mapped.clips, testing::ElementsAreArray(original.clips));
  expect_same("key_times", mapped.key_times, original.key_times);
  expect_same_poses(mapped.poses, original.poses);
  expect_same("triangles", mapped.triangles, original.triangles);
  expect_same("source_triangles", mapped.source_triangles, original.source_triangles);
  expect_same("clusters", mapped.clusters, original.clusters);
  expect_same("local_from_world", mapped.local_from_world, original.local_from_world);
  expect_same("key_boxes", mapped.key_boxes, original.key_boxes);
  expect_same("cluster_world_boxes", mapped.cluster_world_boxes, original.cluster_world_boxes);
  expect_same("segments", mapped.segments, original.segments);
  expect_same("fuzzy_trees", mapped.fuzzy_trees, original.fuzzy_trees);
  expect_same("fuzzy_boxes", mapped.fuzzy_boxes, original.fuzzy_boxes);
  expect_same("kd_nodes", mapped.kd_nodes, original.kd_nodes);
  expect_same("kd_refs", mapped.kd_refs, original.kd_refs);
  const Appearance& look = original.appearance;
  expect_same("materials", mapped.materials, look.materials);
  expect_same("triangle_materials", mapped.triangle_materials, look.triangle_materials);
  expect_same("corner_texcoords", mapped.corner_texcoords, look.corner_texcoords);
  expect_same("corner_colors", mapped.corner_colors, look.corner_colors);
  expect_same("textures", mapped.textures, look.textures);
  expect_same("texels", mapped.texels, look.texels);
}

TEST_F(MdkFileTest, TellsWhatMadeItWhereThatIsKnown) {
  const MdkOrigin origin{{1, 20, 300}, 0x0123456789abcdefu, SourceReader::kAssimp};
  write_mdk(sample_model().view(), path_, {.origin = origin});
  EXPECT_EQ(MdkFile(path_).origin(), origin);
  EXPECT_EQ(MdkFile(written(sample_model())).origin(), MdkOrigin{});
}

TEST_F(MdkFileTest, GivesBackEveryListAndNumber) {
  ModelStorage original = sample_model();
  original.rest_key = 2;
  const MdkFile file(written(original));
  expect_same_model(file.model(), original);
  EXPECT_EQ(file.path(), path_);
}

void expect_poses_of_the_sample(const Model& model) {
  const ModelStorage keys = sample_model();
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    std::vector<Vec3f> pose(model.vertex_count);
    decode_pose(model, key, {0, model.vertex_count}, pose);
    EXPECT_THAT(pose,
                testing::ElementsAreArray(
                    std::span(keys.poses.key_positions).subspan(key * pose.size(), pose.size())));
  }
}

TEST_F(MdkFileTest, GivesBackARigAndThePosesItStandsFor) {
  const ModelStorage original = sample_rig_model();
  const MdkFile file(written(original));
  expect_same_model(file.model(), original);
  expect_poses_of_the_sample(file.model());
}

TEST_F(MdkFileTest, GivesBackQuantisedPosesAndWhatTheyDecodeTo) {
  const ModelStorage original = sample_quantized_model();
  const MdkFile file(written(original));
  expect_same_model(file.model(), original);
  expect_poses_of_the_sample(file.model());
}

TEST_F(MdkFileTest, GivesBackAModelWithoutAnyOptionalList) {
  ModelStorage original = sample_model();
  original.appearance.corner_colors.clear();
  original.appearance.corner_texcoords.clear();
  original.appearance.textures.clear();
  original.appearance.texels.clear();
  original.appearance.materials[1].texture = kNoTexture;
  for (Clip& clip : original.clips) clip.name.clear();
  const MdkFile file(written(original));
  const Model& model = file.model();
  EXPECT_TRUE(model.corner_colors.empty());
  EXPECT_TRUE(model.corner_texcoords.empty());
  EXPECT_TRUE(model.textures.empty());
  EXPECT_TRUE(model.texels.empty());
  EXPECT_THAT(model.clips, testing::ElementsAreArray(original.clips));
}

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

TEST_F(MdkFileTest, ListsItsSectionsByName) {
  const auto sections = MdkFile(written(sample_model())).sections();
  ASSERT_EQ(sections.size(), 38u);
  EXPECT_EQ(sections.front().name, "model");
  EXPECT_EQ(sections.front().bytes, 64u);
  EXPECT_EQ(sections.back().name, "key_positions");
  EXPECT_EQ(sections.back().bytes, 3u * 10 * 12);
}

TEST_F(MdkFileTest, StaysValidWhenMoved) {
  const ModelStorage original = sample_model();
  MdkFile first(written(original));
  MdkFile second(std::move(first));
  expect_same_model(second.model(), original);
  MdkFile third(written(original));
  third = std::move(second);
  expect_same_model(third.model(), original);
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

TEST_F(MdkFileTest, OpensPositionsThatAreNotNumbersAndKeepsTheirChecksum) {
  ModelStorage storage = sample_model();
  storage.poses.key_positions[7].y = std::numeric_limits<float>::quiet_NaN();
  const MdkFile file(written(storage));
  EXPECT_TRUE(std::isnan(file.model().poses.key_positions[7].y));
  EXPECT_NO_THROW(file.verify_checksums());
}

TEST_F(MdkFileTest, ChecksumsNameTheSectionThatDiffers) {
  const Bytes bytes = sample_bytes();
  for (const auto& [id, name] : {std::pair{"POSE", "key_positions"},
                                 {"TEXL", "texels"},
                                 {"UVCO", "corner_texcoords"},
                                 {"COLR", "corner_colors"}}) {
    Bytes damaged = bytes;
    const ImageSection section = find_section(bytes, id);
    damaged[section.offset + section.bytes() - 1] ^= 1;
    write_bytes(path_, damaged);
    const MdkFile file(path_);
    expect_error(ErrorCode::kBadInput, std::string("section ") + name + " differs",
                 [&] { file.verify_checksums(); });
  }
}

TEST_F(MdkFileTest, IgnoresUnknownSectionsUnlessTheyAreNeeded) {
  const Bytes bytes = sample_bytes();
  const Bytes content(15, 42);
  ImageSection extra{"XTRA", 0, 5, 3};
  extra.checksum = checksum_of(std::as_bytes(std::span(content)));
  const Bytes longer = with_section(bytes, extra, content);
  write_bytes(path_, longer);
  const MdkFile file(path_);
  expect_same_model(file.model(), sample_model());
  EXPECT_EQ(file.sections().back().name, "'XTRA'");
  EXPECT_EQ(file.sections().back().bytes, 15u);
  EXPECT_NO_THROW(file.verify_checksums());

  extra.flags = 1;
  expect_refused(with_section(bytes, extra, content), "section 'XTRA' is needed to read it");
  extra.flags = 2;
  expect_refused(with_section(bytes, extra, content), "section 'XTRA' has flags");
}

TEST_F(MdkFileTest, SectionsMayReachTheLastByteAndNotOneFurther) {
  const Bytes bytes = sample_bytes();
  const Bytes content(64, 1);
  write_bytes(path_, with_section(bytes, {"XTRA", 0, 4, 16}, content));
  EXPECT_EQ(MdkFile(path_).sections().back().bytes, 64u);
  write_bytes(path_, with_section(bytes, {"XTRA", 0, 7, 9}, content));
  EXPECT_EQ(MdkFile(path_).sections().back().bytes, 63u);
  for (const ImageSection& section : {ImageSection{"XTRA", 0, 1, 65},
                                      {"XTRA", 0, 65, 1},
                                      {"XTRA", 0, 4, 17},
                                      {"XTRA", 0, 7, 10}}) {
    expect_refused(with_section(bytes, section, content), "section 'XTRA' reaches past the end");
  }
}

TEST_F(MdkFileTest, RefusesSectionsThatAreMissingOrThereTwice) {
  const Bytes bytes = sample_bytes();
  for (const ImageSection& section : read_table(bytes)) {
    Bytes missing = bytes;
    put(missing, entry_offset(bytes, section.id), std::uint32_t{0x41544841});
    put(missing, entry_offset(bytes, section.id) + 4, std::uint32_t{0});
    seal(missing);
    expect_refused(missing, " is missing");
    expect_refused(with_section(bytes, {section.id, 1, section.element_bytes, 0}, {}),
                   " is there twice");
  }
}

TEST_F(MdkFileTest, RefusesSectionsInPlacesTheyCannotBe) {
  const Bytes bytes = sample_bytes();
  const std::size_t entry = entry_offset(bytes, "TEXL");
  const auto refused = [&](std::size_t field, auto value, const char* words) {
    Bytes changed = bytes;
    put(changed, entry + field, value);
    seal(changed);
    expect_refused(changed, std::string("section texels ") + words);
  };
  constexpr std::uint64_t kHuge = ~std::uint64_t{0};
  refused(24, std::uint64_t{1000}, "starts where no section can");
  refused(24, std::uint64_t{64}, "starts where no section can");
  refused(24, std::uint64_t{bytes.size() + 64}, "reaches past the end");
  refused(24, kHuge / 64 * 64, "reaches past the end");
  refused(16, kHuge, "reaches past the end");
  refused(16, kHuge / 4 + 1, "reaches past the end");
  refused(16, kHuge / 4 + 3, "reaches past the end");
  refused(8, std::uint32_t{0}, "reaches past the end");
  refused(8, std::uint32_t{2}, "has elements of 2 bytes instead of 4");
}

TEST_F(MdkFileTest, RefusesWhatIsNoMdkFile) {
  expect_refused({'h', 'e', 'l', 'l', 'o'},
                 "walk.mdk: not an .mdk file (bad magic); bake one with mdprep bake");
  expect_refused({}, "not an .mdk file (bad magic)");
  expect_refused(Bytes(4096, 0), "not an .mdk file (bad magic)");
}

TEST_F(MdkFileTest, RefusesOtherVersionsAndByteOrders) {
  const Bytes bytes = sample_bytes();
  Bytes newer = bytes;
  put(newer, 12, std::uint16_t{4});
  put(newer, 14, std::uint16_t{4});
  expect_refused(newer, "has file format 4.4, this program reads 3.0");
  Bytes older = bytes;
  put(older, 12, std::uint16_t{2});
  expect_refused(older, "has file format 2.0, this program reads 3.0");
  Bytes swapped = bytes;
  put(swapped, 8, std::uint32_t{0x04030201});
  expect_refused(swapped, "has an unknown byte order");
  Bytes minor = bytes;
  put(minor, 14, std::uint16_t{7});
  seal(minor);
  write_bytes(path_, minor);
  EXPECT_NO_THROW(MdkFile file(path_)) << "a higher minor version stays readable";
}

TEST_F(MdkFileTest, RefusesFilesOfAnotherLength) {
  Bytes bytes = sample_bytes();
  const std::size_t whole = bytes.size();
  bytes.resize(whole - 7);
  expect_refused(bytes, "is cut: header says " + std::to_string(whole) + " bytes, the file has " +
                            std::to_string(whole - 7));
  bytes.resize(whole + 64);
  expect_refused(bytes, "is too long: header says " + std::to_string(whole));
  bytes.resize(20);
  expect_refused(bytes, "is cut: the header alone has 64 bytes, the file has 20");
}

TEST_F(MdkFileTest, RefusesUnknownPoseKinds) {
  Bytes bytes = sample_bytes();
  put(bytes, find_section(bytes, "MODL").offset + 24, std::uint32_t{3});
  expect_refused(bytes, "stores its poses as kind 3");
}

TEST_F(MdkFileTest, RefusesCountsThatDisagreeAndNamesOfNoClip) {
  const Bytes bytes = sample_bytes();
  const std::size_t model = find_section(bytes, "MODL").offset;
  for (const std::size_t field : {4, 8, 12, 16, 28}) {
    Bytes changed = bytes;
    put(changed, model + field, std::uint32_t{77});
    expect_refused(changed, "disagree");
  }
  for (const std::size_t field : {0, 4}) {
    Bytes changed = bytes;
    put(changed, find_section(bytes, "CLIP").offset + 16 + field, ~std::uint32_t{0});
    expect_refused(changed, "section clip_names does not hold the name of clip 1");
  }
}

TEST_F(MdkFileTest, NamesTheSectionThatIsInconsistent) {
  Bytes bytes = sample_bytes();
  put(bytes, find_section(bytes, "TRIS").offset + 12, std::uint32_t{10});
  expect_refused(bytes, "walk.mdk: section triangles: triangle 1 names vertex 10 of 10");
}

TEST_F(MdkFileTest, CannotReadWhatIsMissingOrNoRegularFile) {
  expect_error(ErrorCode::kIo, "walk.mdk: cannot be read: No such file",
               [&] { MdkFile file(path_); });
  expect_error(ErrorCode::kIo, "it is a folder", [&] { MdkFile file(folder_.path()); });
  ASSERT_EQ(::mkfifo(folder_.file("pipe").c_str(), 0600), 0);
  expect_error(ErrorCode::kIo, "not a regular file", [&] { MdkFile file(folder_.file("pipe")); });
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
