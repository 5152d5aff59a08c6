// A fixture with the sample mesh baked once by the real mdprep.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/formats/temp_folder.h"

namespace mdk::test {

class BakedSample : public testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

  static std::string source() { return shared_->file("sample.gltf"); }
  static std::string baked() { return shared_->file("sample.mdk"); }

  TempFolder folder_;  ///< this test's own

 private:
  static TempFolder* shared_;
};

}  // namespace mdk::test
