// Files appear whole or not at all.
#include "formats/files/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>

#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::span<const std::byte> raw(const Bytes& bytes) { return std::as_bytes(std::span(bytes)); }

/// Lets no file of this process grow past `bytes`, as a full disk would.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  void (*old_handler_)(int);
  rlimit old_limit_{};
};

/// Gives up root's right to write everywhere, where the test runs as root.
class PlainUser {
 public:
  PlainUser() {
    if (::geteuid() == 0) dropped_ = ::seteuid(65534) == 0;
  }
  ~PlainUser() {
    if (dropped_) {
      EXPECT_EQ(::seteuid(0), 0);
    }
  }
  PlainUser(const PlainUser&) = delete;
  PlainUser& operator=(const PlainUser&) = delete;

 private:
  bool dropped_ = false;
};

class AtomicFileTest : public testing::Test {
 protected:
  TempFolder folder_;
  std::string path_ = folder_.file("out.bin");
  Bytes old_{'o', 'l', 'd'}, new_{'n', 'e', 'w', 'e', 'r'};
};

TEST_F(AtomicFileTest, AppearsOnlyWhenCommitted) {
  AtomicFile file(path_);
  file.write(raw(new_));
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_EQ(std::filesystem::path(file.temporary_path()).parent_path(), folder_.path());
  file.write(raw(old_));
  file.commit();
  EXPECT_EQ(file.temporary_path(), "");
  EXPECT_EQ(read_bytes(path_), (Bytes{'n', 'e', 'w', 'e', 'r', 'o', 'l', 'd'}));
  EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
}

TEST_F(AtomicFileTest, LeavesTheOldFileAndNothingElseWhenGivenUp) {
  write_bytes(path_, old_);
  {
    AtomicFile file(path_);
    file.write(raw(new_));
    EXPECT_EQ(folder_.names().size(), 2u);
  }
  EXPECT_EQ(read_bytes(path_), old_);
  EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
}

TEST_F(AtomicFileTest, ReplacesTheOldFile) {
  write_bytes(path_, old_);
  AtomicFile file(path_);
  file.write(raw(new_));
  EXPECT_EQ(read_bytes(path_), old_);
  file.commit();
  EXPECT_EQ(read_bytes(path_), new_);
}

TEST_F(AtomicFileTest, KeepsTheOldFileWhenTheDiskIsFull) {
  write_bytes(path_, old_);
  {
    const FullDisk full(1000);
    AtomicFile file(path_);
    file.write(raw(Bytes(900, 1)));
    expect_error(ErrorCode::kIo, "out.bin: cannot be written: File too large",
                 [&] { file.write(raw(Bytes(900, 2))); });
  }
  EXPECT_EQ(read_bytes(path_), old_);
  EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
}

TEST_F(AtomicFileTest, LeavesNothingInAFolderItMayNotWriteTo) {
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0555), 0);
  {
    const PlainUser user;
    expect_error(ErrorCode::kIo, "Permission denied", [&] { AtomicFile file(path_); });
  }
  ASSERT_EQ(::chmod(folder_.path().c_str(), 0755), 0);
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(AtomicFileTest, RefusesPathsThatCannotBeFiles) {
  write_bytes(path_, old_);
  const auto refused = [](const std::string& path, const char* words) {
    expect_error(ErrorCode::kIo, words, [&] { AtomicFile file(path); });
  };
  refused(folder_.file("none/out.bin"), "No such file or directory");
  refused(folder_.file("out.bin/x"), "Not a directory");
  refused(folder_.path(), "it is a folder");
  refused(folder_.path() + "/", "it names no file");
  refused("", "it names no file");
  refused(folder_.file(std::string(300, 'n')), "File name too long");
  refused("/dev/null", "not a regular file");
  EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
}

TEST_F(AtomicFileTest, LeavesAnOldFileOfTheSameContentAloneWhereAsked) {
  const auto day_one = std::filesystem::file_time_type::clock::now() - std::chrono::hours(24);
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{3'000'001}}) {
    Bytes content(size, 7);
    write_bytes(path_, content);
    std::filesystem::last_write_time(path_, day_one);
    const auto write = [&](Overwrite overwrite) {
      AtomicFile file(path_, overwrite);
      file.write(raw(content));
      file.commit();
      EXPECT_EQ(read_bytes(path_), content);
      EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
      return std::filesystem::last_write_time(path_);
    };
    EXPECT_EQ(write(Overwrite::kIfChanged), day_one) << size;
    if (size > 0) {
      content.back() ^= 1;
      EXPECT_GT(write(Overwrite::kIfChanged), day_one) << size;
      std::filesystem::last_write_time(path_, day_one);
    }
    EXPECT_GT(write(Overwrite::kAlways), day_one) << size;
  }
}

TEST_F(AtomicFileTest, OnlyTemporariesWithoutALivingWriterAreRemoved) {
  const std::string ours = folder_.file(".out.bin.tmp-4711-0");
  write_bytes(ours, old_);
  for (const char* other :
       {".out.bin", ".tmp-1-1", ".a.tmp-1", ".a.tmp-x-1", ".a.tmp--1", "a.tmp-1-1"})
    write_bytes(folder_.file(other), old_);
  AtomicFile living(path_);
  EXPECT_EQ(remove_abandoned_temporaries(folder_.path()), 1u);
  EXPECT_FALSE(std::filesystem::exists(ours));
  EXPECT_EQ(folder_.names().size(), 7u);
  living.write(raw(new_));
  living.commit();
  EXPECT_EQ(read_bytes(path_), new_);
  EXPECT_EQ(remove_abandoned_temporaries(folder_.file("none")), 0u);
}

TEST_F(AtomicFileTest, TakesTheLongestNameThereIs) {
  const std::string name(255, 'n');
  AtomicFile file(folder_.file(name));
  file.commit();
  EXPECT_THAT(folder_.names(), ElementsAre(name));
}

TEST_F(AtomicFileTest, TwoWritersOfOneNameStayApartAndTheLastWins) {
  AtomicFile first(path_);
  std::optional<AtomicFile> second(std::in_place, path_);
  EXPECT_NE(first.temporary_path(), second->temporary_path());
  first.write(raw(old_));
  second->write(raw(new_));
  first.commit();
  EXPECT_EQ(read_bytes(path_), old_);
  second->commit();
  EXPECT_EQ(read_bytes(path_), new_);
  EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
}

TEST_F(AtomicFileTest, GivesUpWhereTheNameBecameAFolderMeanwhile) {
  {
    AtomicFile file(path_);
    file.write(raw(new_));
    std::filesystem::create_directory(path_);
    expect_error(ErrorCode::kIo, "out.bin: cannot take its name", [&] { file.commit(); });
  }
  EXPECT_THAT(folder_.names(), ElementsAre("out.bin"));
}

}  // namespace
}  // namespace mdk::test
