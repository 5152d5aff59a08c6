// Export of a clip: which keys, real pictures by the real mdprep, and a cancel that leaves nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "formats/mdk/writer.h"
#include "tests/formats/temp_folder.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/picture/export.h"

namespace mdk::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Exporting : public testing::Test {
 protected:
  Exporting() : before_(fs::current_path()) {
    write_mdk(waving_bar().view(), folder_.file("bar.mdk"));
    fs::current_path(folder_.path());
    file_ = std::make_shared<const MdkFile>("bar.mdk");
    order_.picture.file = file_;
    order_.picture.request.width = order_.picture.request.height = 24;
    order_.picture.request.camera = {{1, 2, 9}, {0, 0, 0}, {0, 1, 0}, 40};
    order_.keys = {2, 4};
    order_.stem = "bar";
  }
  ~Exporting() override { fs::current_path(before_); }

  ExportResult wait() {
    for (int i = 0; i < 3000; ++i) {
      if (auto result = export_.take_result()) return *result;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "no end";
    return {};
  }

  TempFolder folder_;
  fs::path before_;
  std::shared_ptr<const MdkFile> file_;
  ExportOrder order_;
  SequenceExport export_{[] {}};
};

TEST_F(Exporting, MakesAPictureForEachKeyInANewFolder) {
  for (const char* name : {"bar-frames-0001", "bar-frames-0002"}) {
    export_.start(order_);
    const ExportResult result = wait();
    ASSERT_FALSE(result.error) << result.error->what();
    EXPECT_THAT(result.sentence, HasSubstr(name));
    for (const char* key : {"0002", "0003", "0004"})
      EXPECT_TRUE(fs::is_regular_file(fs::path(name) / (std::string("bar_") + key + ".png")));
    EXPECT_EQ(std::distance(fs::directory_iterator(name), fs::directory_iterator()), 3);
  }
}

TEST_F(Exporting, NeedsNoFileThatStillHasAName) {
  fs::remove("bar.mdk");
  export_.start(order_);
  EXPECT_FALSE(wait().error);
  EXPECT_TRUE(fs::is_regular_file("bar-frames-0001/bar_0003.png"));
  EXPECT_FALSE(fs::exists("bar.mdk"));
}

TEST_F(Exporting, ACancelLeavesNothing) {
  order_.picture.request.width = order_.picture.request.height = 2048;
  order_.picture.request.samples = 64;
  order_.keys = {0, 10};
  export_.start(order_);
  EXPECT_TRUE(export_.busy());
  for (int i = 0; i < 3000 && !fs::exists("bar-frames-0001"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  export_.cancel();
  EXPECT_FALSE(export_.busy());
  EXPECT_FALSE(fs::exists("bar-frames-0001"));
  EXPECT_THAT(wait().sentence, HasSubstr("cancelled"));
}

TEST_F(Exporting, MdprepsSentenceComesThroughWhereItFails) {
  order_.keys = {7, 5000};
  export_.start(order_);
  const ExportResult result = wait();
  ASSERT_TRUE(result.error);
  EXPECT_EQ(result.error->code(), ErrorCode::kUsage);
  EXPECT_FALSE(fs::exists("bar-frames-0001"));
}

TEST_F(Exporting, FindsTheKeysOfARange) {
  const ModelView& model = file_->model();  // "wave": 11 keys, 0.1 s apart; then "nod": 5
  const auto keys = [&](std::uint32_t clip, double begin, double end) {
    const KeyRange range = keys_within(model, clip, begin, end);
    return std::pair{range.first, range.last};
  };
  EXPECT_EQ(keys(0, 0, 1), std::pair(0u, 10u));
  EXPECT_EQ(keys(0, 0.2, 0.5), std::pair(2u, 5u));
  EXPECT_EQ(keys(0, 0.21, 0.29), std::pair(3u, 3u));
  EXPECT_EQ(keys(1, 0, 0.4), std::pair(11u, 15u));
  EXPECT_EQ(keys(1, 0.41, 9), std::pair(15u, 15u));
}

}  // namespace
}  // namespace mdk::test
