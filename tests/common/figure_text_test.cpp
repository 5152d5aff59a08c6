#include <gtest/gtest.h>

#include "common/base/text.h"

namespace mdk {
namespace {

TEST(FigureText, ReadsWell) {
  EXPECT_EQ(fixed_text(12.345, 1), "12.3");
  EXPECT_EQ(fixed_text(1e300, 0).size(), 301u);
  EXPECT_EQ(grouped_text(0), "0");
  EXPECT_EQ(grouped_text(999), "999");
  EXPECT_EQ(grouped_text(1000), "1,000");
  EXPECT_EQ(grouped_text(15840), "15,840");
  EXPECT_EQ(grouped_text(1234567), "1,234,567");
  EXPECT_EQ(bytes_text(512), "512 B");
  EXPECT_EQ(bytes_text(1023), "1023 B");
  EXPECT_EQ(bytes_text(3250585), "3.1 MiB");
  EXPECT_EQ(bytes_text(3 << 20), "3.0 MiB");
}

}  // namespace
}  // namespace mdk
