// Opening .mdk files: what was written comes back, and what is not such a file is refused with the
// right sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>
#include <span>
#include <utility>
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

void expect_poses_of_the_sample(const ModelView& model) {
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
  const ModelView& model = file.model();
  EXPECT_TRUE(model.appearance.corner_colors.empty());
  EXPECT_TRUE(model.appearance.corner_texcoords.empty());
  EXPECT_TRUE(model.appearance.textures.empty());
  EXPECT_TRUE(model.appearance.texels.empty());
  EXPECT_THAT(model.clips, testing::ElementsAreArray(original.clips));
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

TEST_F(MdkFileTest, KnowsWhetherBoxesHoldBetweenKeys) {
  ModelStorage storage = sample_model();
  storage.holds_between_keys = false;
  const std::string path = written(storage);
  expect_same_model(MdkFile(path).model(), storage);
  Bytes bytes = read_bytes(path);
  const std::size_t field = find_section(bytes, "MODL").offset + 24;
  EXPECT_EQ(get<std::uint32_t>(bytes, field), 0x10000u) << "a pose kind that older readers refuse";
  put(bytes, field, std::uint32_t{0x20000});
  expect_refused(bytes, "flags this program does not know");
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

}  // namespace
}  // namespace mdk::test
