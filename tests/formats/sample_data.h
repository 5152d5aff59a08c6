// Animations made by others, where they are at hand: MDK_TEST_DATA names their folder.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace mdk::test {

/// Skips its tests where there is no sample data.
class SampleData : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("MDK_TEST_DATA");
    folder_ = folder ? std::filesystem::path(folder)
                     : std::filesystem::path(MDK_SOURCE_DIR) / "../shared/data";
    if (!std::filesystem::is_directory(folder_))
      GTEST_SKIP() << "no sample data; set MDK_TEST_DATA";
  }

  std::string need(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

}  // namespace mdk::test
