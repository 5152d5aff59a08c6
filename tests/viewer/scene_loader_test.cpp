// From paths to models: opened, baked by the real mdprep, cancelled, loaded again.
#include "viewer/scene/scene_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "formats/mdk/writer.h"
#include "tests/formats/temp_folder.h"
#include "tests/viewer/obj_sources.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/scene/mdprep_process.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

void write_text(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

/// As if it had been written later.
void touch(const std::string& path) {
  namespace fs = std::filesystem;
  fs::last_write_time(path, fs::last_write_time(path) + std::chrono::seconds(5));
}

template <class Condition>
bool soon(const Condition& condition) {
  for (int i = 0; i < 3000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class SceneLoading : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(scratch_);
    ::setenv("TMPDIR", scratch_.c_str(), 1);
  }
  void TearDown() override { ::unsetenv("TMPDIR"); }

  LoadedScene load(std::vector<std::string> paths) {
    loader_.load(std::move(paths));
    return wait();
  }
  LoadedScene wait() {
    std::optional<LoadedScene> scene;
    EXPECT_TRUE(soon([&] { return (scene = loader_.take_loaded()).has_value(); }));
    return scene.value_or(LoadedScene{});
  }

  TempFolder folder_;
  std::string scratch_ = folder_.file("scratch");
  SceneLoader loader_{[] {}};
};

TEST_F(SceneLoading, OpensABakedFile) {
  const std::string path = folder_.file("bar.mdk");
  write_mdk(waving_bar().view(), path);
  const LoadedScene scene = load({path});
  ASSERT_TRUE(scene.file);
  EXPECT_EQ(scene.paths, std::vector{path});
  EXPECT_FALSE(scene.is_again);
}

TEST_F(SceneLoading, BakesASourceFileAndLeavesNothingBehind) {
  const std::string path = folder_.file("square.obj");
  write_text(path, kSquare);
  const LoadedScene scene = load({path});
  ASSERT_TRUE(scene.file) << scene.error->what();
  EXPECT_EQ(scene.file->model().triangle_count(), 2u);
  EXPECT_EQ(scene.paths, std::vector{path});
  EXPECT_TRUE(std::filesystem::is_empty(scratch_));
}

TEST_F(SceneLoading, GivesMdprepsSentenceAndStatusForABadSource) {
  const std::string path = folder_.file("bad.glb");
  write_text(path, "no model");
  const LoadedScene scene = load({path});
  ASSERT_TRUE(scene.error);
  EXPECT_EQ(scene.error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(scene.error->what(), StartsWith(path + ": "));
  EXPECT_TRUE(std::filesystem::is_empty(scratch_));
}

TEST_F(SceneLoading, ABakeCanBeCancelled) {
  const std::string path = folder_.file("sheet.obj");
  write_text(path, large_obj(400));
  loader_.load({path});
  ASSERT_TRUE(soon([&] { return loader_.progress().has_value(); }));
  EXPECT_EQ(loader_.progress()->name, "sheet.obj");
  loader_.cancel();
  EXPECT_FALSE(loader_.busy());
  EXPECT_FALSE(loader_.progress());
  EXPECT_FALSE(loader_.take_loaded());
  EXPECT_TRUE(std::filesystem::is_empty(scratch_));
}

TEST_F(SceneLoading, AFileThatChangesIsLoadedAgainAndOneThatDoesNotIsNot) {
  const std::string path = folder_.file("square.obj");
  write_text(path, kSquare);
  ASSERT_TRUE(load({path}).file);
  loader_.look_for_changes();
  EXPECT_FALSE(loader_.busy());
  write_text(path, std::string(kSquare) + "v 2 2 1\nf 2 5 3\n");
  loader_.look_for_changes();
  EXPECT_TRUE(loader_.busy());
  const LoadedScene scene = wait();
  EXPECT_TRUE(scene.is_again);
  ASSERT_TRUE(scene.file);
  EXPECT_EQ(scene.file->model().triangle_count(), 3u);
}

TEST_F(SceneLoading, WhatComesAfterItCouldNotBeOpenedIsOpenedAsIfAskedForAnew) {
  const std::string path = folder_.file("bar.mdk");
  EXPECT_TRUE(load({path}).error);
  loader_.look_for_changes();
  EXPECT_FALSE(loader_.busy());
  write_mdk(waving_bar().view(), path);
  loader_.look_for_changes();
  LoadedScene scene = wait();
  ASSERT_TRUE(scene.file);
  EXPECT_FALSE(scene.is_again);
  touch(path);
  loader_.look_for_changes();
  scene = wait();
  ASSERT_TRUE(scene.file);
  EXPECT_TRUE(scene.is_again);
}

TEST_F(SceneLoading, WhatIsOpenIsWatchedAfterAnotherFileCouldNotBeOpened) {
  const std::string open = folder_.file("bar.mdk"), missing = folder_.file("missing.mdk");
  write_mdk(waving_bar().view(), open);
  ASSERT_TRUE(load({open}).file);
  EXPECT_TRUE(load({missing}).error);
  touch(open);
  loader_.look_for_changes();
  const LoadedScene scene = wait();
  EXPECT_EQ(scene.paths, std::vector{open});
  EXPECT_TRUE(scene.is_again);
  loader_.look_for_changes();
  EXPECT_FALSE(loader_.busy());
}

TEST_F(SceneLoading, ACancelledFileIsForgottenAndWhatIsOpenIsWatched) {
  const std::string open = folder_.file("bar.mdk"), other = folder_.file("sheet.obj");
  write_mdk(waving_bar().view(), open);
  write_text(other, large_obj(400));
  ASSERT_TRUE(load({open}).file);
  loader_.load({other});
  ASSERT_TRUE(soon([&] { return loader_.progress().has_value(); }));
  loader_.cancel();
  touch(other);
  loader_.look_for_changes();
  EXPECT_FALSE(loader_.busy());
  touch(open);
  loader_.look_for_changes();
  const LoadedScene scene = wait();
  EXPECT_EQ(scene.paths, std::vector{open});
  EXPECT_TRUE(scene.is_again);
}

TEST_F(SceneLoading, GarbageOverWhatIsOpenIsSaidOnce) {
  const std::string path = folder_.file("bar.mdk");
  write_mdk(waving_bar().view(), path);
  ASSERT_TRUE(load({path}).file);
  write_text(path, "garbage");
  loader_.look_for_changes();
  EXPECT_TRUE(wait().error);
  loader_.look_for_changes();
  EXPECT_FALSE(loader_.busy());
  std::filesystem::remove(path);
  write_mdk(waving_bar().view(), path);
  loader_.look_for_changes();
  const LoadedScene scene = wait();
  EXPECT_TRUE(scene.file);
  EXPECT_TRUE(scene.is_again);
}

TEST(MdprepProgressText, IsReadFromTheBarAndFromNothingElse) {
  const auto bar =
      parse_mdprep_progress("\x1b[K[##########--------------]  42 %  decompose, 0:12 left");
  ASSERT_TRUE(bar);
  EXPECT_DOUBLE_EQ(bar->fraction, 0.42);
  EXPECT_EQ(bar->text, " 42 %  decompose, 0:12 left");
  for (const char* line : {"", "[", "[###] ", "[###] soon", "mdprep: walk.glb: is cut", "42 %"})
    EXPECT_FALSE(parse_mdprep_progress(line)) << line;
}

}  // namespace
}  // namespace mdk::test
