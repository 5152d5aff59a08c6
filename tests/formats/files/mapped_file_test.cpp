#include "formats/files/mapped_file.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

/// Reads the last byte of a file that is cut to nothing while it is mapped.
void read_what_is_gone(const std::string& path) {
  name_lost_mappings();
  const MappedFile file(path);
  std::filesystem::resize_file(path, 0);
  const volatile std::byte* const last = &file.bytes().back();
  [[maybe_unused]] const std::byte gone = *last;
}

TEST(LostMappingsDeathTest, AFileThatIsCutShortWhileItIsMappedIsNamed) {
  const TempFolder folder;
  const std::string path = folder.file("cut.bin");
  write_text(path, std::string(10000, 'x'));
  EXPECT_EXIT(
      read_what_is_gone(path), testing::ExitedWithCode(4),
      "^mdk_tests: /[^\n]*/cut\\.bin: was cut short, or its disk failed, while it was being "
      "read; run this again when nobody writes to it\n$");
}

TEST(LostMappingsDeathTest, NamesAreFitForATerminal) {
  const TempFolder folder;
  const std::string path = folder.file("a\x1b[31mb.bin");
  write_text(path, std::string(10000, 'x'));
  EXPECT_EXIT(read_what_is_gone(path), testing::ExitedWithCode(4), "/a\\?\\[31mb\\.bin: was cut");
}

TEST(LostMappingsDeathTest, ABusErrorThatIsSentEndsTheProcessAsEver) {
  EXPECT_EXIT(
      {
        name_lost_mappings();
        std::raise(SIGBUS);
      },
      testing::KilledBySignal(SIGBUS), "^$");
}

}  // namespace
}  // namespace mdk::test
