// A bake that is stopped, has no room or is not alone: its output is whole, old or new, and nothing
// else stays behind.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <thread>

#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Milliseconds = std::chrono::milliseconds;

class Interruption : public testing::Test {
 protected:
  std::vector<std::string> bake_line(const std::string& fps = "30") const {
    return {"bake", source_, "-o", output_, "--fps", fps, "--progress", "always"};
  }
  /// The old output, which a bake gives that nobody disturbs.
  std::string bake(const std::string& fps) const {
    const Outcome outcome = run_mdprep(bake_line(fps));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return read_text(output_);
  }
  void expect_no_litter() const {
    EXPECT_THAT(folder_.names(), ElementsAre("a.bin", "a.gltf", "a.mdk"));
  }

  TempFolder folder_;
  const std::string source_ = folder_.file("a.gltf"), output_ = folder_.file("a.mdk");
};

class InterruptionBy : public Interruption, public testing::WithParamInterface<int> {};

TEST_P(InterruptionBy, MidwayTheOldFileStaysAndTheSentenceSaysSo) {
  write_sample_gltf(source_, {600, 64});
  write_text(output_, "old");
  ProgramRun bake(bake_line());
  for (int i = 0; i < 600 && bake.err_so_far().empty(); ++i)
    std::this_thread::sleep_for(Milliseconds(20));
  bake.send_signal(GetParam());
  const Outcome outcome = bake.wait();
  EXPECT_EQ(outcome.status, 128 + GetParam());
  EXPECT_THAT(outcome.err, HasSubstr("mdprep: interrupted; no file was left half-written\n"));
  EXPECT_TRUE(read_text(output_) == "old");
  expect_no_litter();
}

TEST_P(InterruptionBy, AtAnyMomentTheFileIsTheOldOneOrTheNewOne) {
  write_sample_gltf(source_, {12, 12});
  const auto start = std::chrono::steady_clock::now();
  const std::string fresh = bake("30");
  const auto whole = std::chrono::steady_clock::now() - start;
  constexpr int kMoments = 12;
  int stopped = 0;
  for (int i = 0; i < kMoments; ++i) {
    write_text(output_, "old");
    ProgramRun run(bake_line());
    std::this_thread::sleep_for(whole * i / (kMoments - 1));
    run.send_signal(GetParam());
    const Outcome outcome = run.wait();
    const std::string left = read_text(output_);
    EXPECT_TRUE(left == (outcome.status == 0 ? fresh : "old")) << i << ": " << outcome.err;
    stopped += outcome.status != 0;
    expect_no_litter();
  }
  EXPECT_GT(stopped, 0);
}

INSTANTIATE_TEST_SUITE_P(Signals, InterruptionBy, testing::Values(SIGINT, SIGTERM));

TEST_F(Interruption, KilledAtAnyMomentTheFileIsTheOldOneOrTheNewOne) {
  write_sample_gltf(source_, {12, 12});
  const auto start = std::chrono::steady_clock::now();
  const std::string fresh = bake("30");
  const auto whole = std::chrono::steady_clock::now() - start;
  constexpr int kMoments = 12;
  for (int i = 0; i < kMoments; ++i) {
    write_text(output_, "old");
    ProgramRun run(bake_line());
    std::this_thread::sleep_for(whole * i / (kMoments - 1));
    run.send_signal(SIGKILL);
    run.wait();
    const std::string left = read_text(output_);
    EXPECT_TRUE(left == "old" || left == fresh) << i;
  }
}

TEST_F(Interruption, OfTwoBakesToOneFileTheLastWinsWhole) {
  write_sample_gltf(source_, {12, 12});
  const std::string slow = bake("24"), fast = bake("60");
  ASSERT_FALSE(slow == fast);
  for (int turn = 0; turn < 3; ++turn) {
    ProgramRun one(bake_line("24")), other(bake_line("60"));
    EXPECT_EQ(one.wait().status, 0);
    EXPECT_EQ(other.wait().status, 0);
    const std::string left = read_text(output_);
    EXPECT_TRUE(left == slow || left == fast) << turn;
    expect_no_litter();
  }
}

/// Lets no file of this process and those it starts grow past `bytes`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit limit{bytes, old_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &old_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
};

TEST_F(Interruption, WhereFilesMayNotGrowTheOldOneStaysAndTheSentenceSaysWhy) {
  write_sample_gltf(source_);
  write_text(output_, "old");
  std::optional<FileSizeLimit> limit(4096);
  ProgramRun run({"bake", source_, "-o", output_, "-q"});
  const Outcome outcome = run.wait();
  limit.reset();
  EXPECT_EQ(outcome.status, 4);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("a.mdk: cannot be written: File too large"));
  EXPECT_TRUE(read_text(output_) == "old");
  expect_no_litter();
}

/// A small disk of memory, mounted where only this process and those it starts see it.
class SmallDisk {
 public:
  SmallDisk(const std::string& place, const char* size) : place_(place) {
    is_there_ = ::unshare(CLONE_NEWNS) == 0 &&
                ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                ::mount("mdk-test", place.c_str(), "tmpfs", 0, size) == 0;
  }
  ~SmallDisk() {
    if (is_there_) ::umount2(place_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool is_there() const { return is_there_; }
  bool make_read_only() const {
    return ::mount(nullptr, place_.c_str(), nullptr, MS_REMOUNT | MS_RDONLY, nullptr) == 0;
  }

 private:
  const std::string place_;
  bool is_there_ = false;
};

class OnASmallDisk : public testing::Test {
 protected:
  void SetUp() override {
    if (!disk_.is_there()) GTEST_SKIP() << "only root can mount a small disk";
    write_sample_gltf(source_);
    write_text(output_, "old");
  }
  Outcome bake() const { return run_mdprep({"bake", source_, "-o", output_, "-q"}); }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(place_.path()))
      names.push_back(entry.path().filename().string());
    return names;
  }

  TempFolder folder_, place_;
  SmallDisk disk_{place_.path(), "size=8k"};
  const std::string source_ = folder_.file("a.gltf"), output_ = place_.file("a.mdk");
};

TEST_F(OnASmallDisk, WhatDoesNotFitLeavesTheOldFileAndNothingElse) {
  const Outcome outcome = bake();
  EXPECT_EQ(outcome.status, 4);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("a.mdk: cannot be written: No space left on device"));
  EXPECT_TRUE(read_text(output_) == "old");
  EXPECT_THAT(names(), ElementsAre("a.mdk"));
}

TEST_F(OnASmallDisk, AReadOnlyOneIsRefusedBeforeTheWork) {
  ASSERT_TRUE(disk_.make_read_only());
  write_text(source_, "{");  // would be refused with another sentence
  const Outcome outcome = bake();
  EXPECT_EQ(outcome.status, 4);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("a.mdk: cannot be written, the folder "));
  EXPECT_TRUE(read_text(output_) == "old");
}

/// A mesh of `points` vertices, and a cache of so many frames, which takes no room on the disk.
void write_cached_mesh(const TempFolder& folder, std::uint32_t points, std::uint32_t frames) {
  std::string mesh;
  for (std::uint32_t i = 0; i < points; ++i)
    mesh += "v " + std::to_string(i % 7) + " " + std::to_string(i / 7) + " 0\n";
  write_text(folder.file("a.obj"), mesh + "f 1 2 9\n");
  std::string header("POINTCACHE2\0", 12);
  const std::uint32_t words[] = {1, points, 0, std::bit_cast<std::uint32_t>(1.0f), frames};
  header.append(reinterpret_cast<const char*>(words), sizeof words);
  write_text(folder.file("a.pc2"), header);
  std::filesystem::resize_file(folder.file("a.pc2"),
                               header.size() + std::uintmax_t{12} * points * frames);
}

TEST_F(Interruption, AnInputThatIsCutShortWhileItIsReadIsNamed) {
  constexpr int kAttempts = 20;  // it may be read already when this comes to it
  Outcome outcome;
  for (int i = 0; i < kAttempts && outcome.status != 4; ++i) {
    write_cached_mesh(folder_, 3000, 6000);
    ProgramRun run({"bake", folder_.file("a.obj"), folder_.file("a.pc2"), "-o", output_, "-q",
                    "--decompose", "none"});
    for (int wait = 0; wait < 5000 && !run.maps(folder_.file("a.pc2")); ++wait)
      std::this_thread::sleep_for(Milliseconds(1));
    std::filesystem::resize_file(folder_.file("a.pc2"), 100);
    outcome = run.wait();
  }
  EXPECT_EQ(outcome.status, 4);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("a.pc2: was cut short, or its disk failed, while it was"));
  EXPECT_THAT(folder_.names(), ElementsAre("a.obj", "a.pc2"));
}

TEST_F(Interruption, NeitherInputNorItsBufferIsEverOverwritten) {
  write_sample_gltf(source_);
  for (const char* name : {"a.gltf", "a.bin"}) {
    const std::string before = read_text(folder_.file(name));
    const Outcome outcome = run_mdprep({"bake", source_, "-o", folder_.file(name), "-q"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr(std::string(name) + ": is the input; give the output"));
    EXPECT_TRUE(read_text(folder_.file(name)) == before) << name;
  }
  EXPECT_THAT(folder_.names(), ElementsAre("a.bin", "a.gltf"));
}

}  // namespace
}  // namespace mdk::test
