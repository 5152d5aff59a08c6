// .mds files: what goes in comes out; what is damaged is refused with a sentence, or harmless.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>

#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "formats/mds/mds_file.h"
#include "formats/mds/writer.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/mdk/hostile_file.h"
#include "tests/formats/mdk/mdk_image.h"
#include "tests/formats/mdk/sample_model.h"
#include "tests/formats/mds/sample_scene.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

class MdsTest : public testing::Test {
 protected:
  MdsTest() : models_(write_sample_models(folder_.path())), path_(folder_.file("crowd.mds")) {
    write_mds(sample_scene().view(), models_, path_);
  }

  void expect_refused(const Bytes& bytes, const std::string& words,
                      ErrorCode code = ErrorCode::kBadInput) {
    write_bytes(path_, bytes);
    expect_error(code, words, [&] { MdsFile{path_}; });
  }
  /// The file with a number changed in a section, sealed.
  template <class T>
  Bytes with(const std::string& section, std::size_t at, T value) const {
    Bytes bytes = read_bytes(path_);
    put(bytes, find_section(bytes, section).offset + at, value);
    seal(bytes);
    return bytes;
  }

  TempFolder folder_;
  std::vector<SceneModelFile> models_;
  std::string path_;
};

template <class T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

TEST_F(MdsTest, GivesBackWhatWasWritten) {
  const MdsFile file(path_);
  const SceneStorage sample = sample_scene();
  const SceneView& scene = file.scene();
  EXPECT_EQ(scene.model_count, 2);
  EXPECT_EQ(scene.last_time, 10);
  SceneView::for_each_array(
      [](std::uint32_t, const char* name, const auto& read, const auto& written) {
        EXPECT_TRUE(same_bytes(read, written)) << name;
      },
      scene, static_cast<const SceneView&>(sample.view()));
  EXPECT_EQ(file.model_files()[1].name, "b.mdk");
  EXPECT_EQ(file.model_path(1), folder_.file("b.mdk"));
  EXPECT_EQ(file.stage().models()[1].triangle_count(), sample_rig_model().triangle_count());
  EXPECT_EQ(walk_scene(file.stage()), walk_scene(file.stage()));
  file.verify_checksums();
  const Bytes first = read_bytes(path_);
  write_mds(scene, file.model_files(), folder_.file("again.mds"));
  EXPECT_EQ(read_bytes(folder_.file("again.mds")), first);
}

TEST_F(MdsTest, StandsAsItsPageSays) {
  const Bytes bytes = read_bytes(path_);
  EXPECT_EQ(bytes[3], 'S');
  EXPECT_EQ(get<std::uint16_t>(bytes, 12), 1);
  const ImageSection instances = find_section(bytes, "INST");
  EXPECT_EQ(instances.element_bytes, 64);
  EXPECT_EQ(instances.element_count, 5);
  const std::size_t second = instances.offset + 64;
  EXPECT_EQ(get<float>(bytes, second + 12), 1.0f);
  EXPECT_EQ(get<double>(bytes, second + 48), 0.25);
  EXPECT_EQ(get<float>(bytes, second + 56), -0.5f);
  EXPECT_EQ(get<std::uint32_t>(bytes, second + 60), 1u | 1u << 29 | 1u << 31);
  EXPECT_EQ(get<std::uint64_t>(bytes, find_section(bytes, "MFIL").offset + 8),
            get<std::uint64_t>(read_bytes(folder_.file("a.mdk")), 56));
}

TEST_F(MdsTest, ModelsMustBeThoseOfTheScene) {
  std::filesystem::remove(folder_.file("b.mdk"));
  expect_error(ErrorCode::kIo, "b.mdk", [&] { MdsFile{path_}; });
  ModelStorage other = sample_rig_model();
  other.rest_diagonal *= 2;
  write_mdk(other.view(), folder_.file("b.mdk"));
  expect_error(ErrorCode::kBadInput, "\"b.mdk\" was baked anew", [&] { MdsFile{path_}; });
}

TEST_F(MdsTest, ModelsMayStandInOtherFolders) {
  std::filesystem::create_directory(folder_.file("scenes"));
  for (SceneModelFile& model : models_) model.name.insert(0, "../");
  write_mds(sample_scene().view(), models_, folder_.file("scenes/far.mds"));
  EXPECT_EQ(MdsFile(folder_.file("scenes/far.mds")).stage().instance_count(), 5);
}

TEST_F(MdsTest, RefusesWhatIsNoSceneByName) {
  const Bytes whole = read_bytes(path_);
  expect_refused(read_bytes(folder_.file("a.mdk")), "crowd.mds: not an .mds file");
  expect_refused({whole.begin(), whole.begin() + 200}, "is cut");
  write_bytes(path_, whole);
  expect_refused(with("SCNE", 0, std::uint32_t{3}), "section model_files");
  write_bytes(path_, whole);
  expect_refused(with("SCNE", 4, std::uint32_t{3}), "section instances");
  write_bytes(path_, whole);
  expect_refused(with("INST", 0, NAN), "instances: instance 0");
  write_bytes(path_, whole);
  expect_refused(with("ROLE", 4, std::uint32_t{7}), "roles: role 0 plays clip 7");
  write_bytes(path_, whole);
  expect_refused(with("MFIL", 4, std::uint32_t{4}), "model_names does not hold the name");
  write_bytes(path_, whole);
  expect_refused(with("MNAM", 0, std::uint16_t{'/'}), "no relative path");
  write_bytes(path_, whole);
  expect_refused(with("LABL", 20, std::uint32_t{1}), "reserved");
}

/// Each refused with a sentence, or safe to walk.
TEST_F(MdsTest, DamageAnywhereIsRefusedOrHarmless) {
  const Bytes whole = read_bytes(path_);
  std::size_t refused = 0, opened = 0;
  const auto open = [&](const Bytes& bytes) {
    write_bytes(path_, bytes);
    try {
      const MdsFile file(path_);
      ++opened;
      EXPECT_TRUE(std::isfinite(walk_scene(file.stage())));
    } catch (const Error& error) {
      ++refused;
      const bool is_expected =
          error.code() == ErrorCode::kBadInput || error.code() == ErrorCode::kIo;
      EXPECT_TRUE(is_expected) << error.what();
    }
  };
  for (std::size_t at = 0; at + 4 <= whole.size(); at += 4)
    for (const std::uint32_t word : extreme_words()) {
      Bytes bytes = whole;
      put(bytes, at, word);
      if (at < kHeaderBytes) {
        open(bytes);
        continue;
      }
      seal(bytes);
      open(bytes);
    }
  for (std::size_t size = 0; size < whole.size(); size += 37)
    open({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
  EXPECT_GT(refused, 1000);
  EXPECT_GT(opened, 100);
}

}  // namespace
}  // namespace mdk::test
