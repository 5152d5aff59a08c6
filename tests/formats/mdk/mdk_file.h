// What tests of writing and of reading .mdk files share.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "common/motion/model.h"
#include "tests/formats/mdk/mdk_image.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {

class MdkFileTest : public testing::Test {
 protected:
  /// Its name.
  std::string written(const ModelStorage& storage);
  Bytes sample_bytes();
  /// That a file of these bytes is refused as bad input, with a sentence that has these words.
  void expect_refused(const Bytes& bytes, const std::string& words);

  TempFolder folder_;
  std::string path_ = folder_.file("walk.mdk");
};

/// Byte by byte, and each list where a file of such sections has to have it.
void expect_same_model(const ModelView& mapped, const ModelStorage& original);

}  // namespace mdk::test
