#include "tests/formats/mdk/mdk_file.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "common/base/error.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/mdk/sample_model.h"

namespace mdk::test {
namespace {

template <class T, class List>
void expect_same(std::string_view name, std::span<const T> mapped, const List& original) {
  ASSERT_EQ(mapped.size(), original.size()) << name;
  if (original.empty()) return;
  EXPECT_EQ(std::memcmp(mapped.data(), original.data(), mapped.size_bytes()), 0) << name;
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(mapped.data()) % 64, 0u) << name;
}

}  // namespace

std::string MdkFileTest::written(const ModelStorage& storage) {
  write_mdk(storage.view(), path_);
  return path_;
}

Bytes MdkFileTest::sample_bytes() { return read_bytes(written(sample_model())); }

void MdkFileTest::expect_refused(const Bytes& bytes, const std::string& words) {
  write_bytes(path_, bytes);
  expect_error(ErrorCode::kBadInput, words, [&] { MdkFile file(path_); });
}

void expect_same_model(const ModelView& mapped, const ModelStorage& original) {
  EXPECT_EQ(mapped.vertex_count, original.vertex_count);
  EXPECT_EQ(mapped.rest_key, original.rest_key);
  EXPECT_EQ(mapped.holds_between_keys, original.holds_between_keys);
  EXPECT_EQ(mapped.bounds, original.bounds);
  EXPECT_EQ(mapped.rest_diagonal, original.rest_diagonal);
  EXPECT_THAT(mapped.clips, testing::ElementsAreArray(original.clips));
  EXPECT_EQ(mapped.poses.kind, original.poses.kind);
  ModelView::for_each_array(
      [](const ModelArray& row, const auto& a, const auto& b) { expect_same(row.name, a, b); },
      mapped, original);
}

}  // namespace mdk::test
