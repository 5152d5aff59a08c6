#include "preprocess/tool/progress_bar.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mdk {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ProgressBar, LineShowsPercentStageAndTimeLeft) {
  EXPECT_EQ(progress_line_text("read", 0, 0), "  0 %  read");
  EXPECT_EQ(progress_line_text("decompose", 0.25, 10), " 25 %  decompose, 0:30 left");
  EXPECT_EQ(progress_line_text("decompose", 0.5, 90), " 50 %  decompose, 1:30 left");
  EXPECT_EQ(progress_line_text("write", 1, 90), "100 %  write");
}

TEST(ProgressBar, MakesNoEstimateFromTooLittle) {
  EXPECT_THAT(progress_line_text("read", 0.01, 100), Not(HasSubstr("left")));
  EXPECT_THAT(progress_line_text("read", 0.5, 0.5), Not(HasSubstr("left")));
}

TEST(ProgressBar, BarHasOneWidth) {
  const std::string empty = progress_bar_text("x", 0, 0), full = progress_bar_text("x", 1, 0);
  EXPECT_EQ(empty.size(), full.size());
  EXPECT_THAT(empty, Not(HasSubstr("#")));
  EXPECT_THAT(full, Not(HasSubstr("-")));
}

TEST(ProgressBar, ShortWorkHasNoPlainLines) {
  std::ostringstream out;
  double now = 0;
  ProgressBar progress(out, ProgressStyle::kLines, [&] { return now; });
  for (const char* stage : {"read", "decompose", "write"}) progress.report(stage, now += 0.05);
  EXPECT_EQ(out.str(), "");
}

TEST(ProgressBar, LongWorkHasALinePerStageAndTenth) {
  std::ostringstream out;
  double now = 0;
  ProgressBar progress(out, ProgressStyle::kLines, [&] { return now; });
  for (int i = 0; i <= 1000; ++i) {
    now = i * 0.04;
    progress.report(i < 500 ? "read" : "write", i / 1000.0);
  }
  EXPECT_EQ(out.str(),
            "mdprep:   0 %  read\n"
            "mdprep:  10 %  read, 0:36 left\n"
            "mdprep:  20 %  read, 0:32 left\n"
            "mdprep:  30 %  read, 0:28 left\n"
            "mdprep:  40 %  read, 0:24 left\n"
            "mdprep:  50 %  write, 0:20 left\n"
            "mdprep:  60 %  write, 0:16 left\n"
            "mdprep:  70 %  write, 0:12 left\n"
            "mdprep:  80 %  write, 0:08 left\n"
            "mdprep:  90 %  write, 0:04 left\n"
            "mdprep: 100 %  write\n");
}

TEST(ProgressBar, StagesThatTakeTurnsDoNotFlood) {
  std::ostringstream out;
  double now = 0;
  ProgressBar progress(out, ProgressStyle::kLines, [&] { return now; });
  for (int i = 0; i < 100000; ++i) {
    now = i * 1e-4;
    progress.report(i % 2 != 0 ? "fit" : "assign", i * 1e-5);
  }
  const std::string text = out.str();
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 10 / 0.3);
  EXPECT_GE(std::count(text.begin(), text.end(), '\n'), 10);
}

TEST(ProgressBar, RedrawsAtMostTenTimesASecond) {
  std::ostringstream out;
  double now = 0;
  ProgressBar progress(out, ProgressStyle::kBar, [&] { return now; });
  for (int i = 0; i < 1000; ++i) {
    now = i * 1e-3;
    progress.report("read", i * 1e-3);
  }
  const std::string text = out.str();
  EXPECT_GE(std::count(text.begin(), text.end(), '['), 2 * 9) << "each clears with ESC [ K";
  EXPECT_LE(std::count(text.begin(), text.end(), '['), 2 * 10);
}

TEST(ProgressBar, RemovesItsBarAtTheEnd) {
  std::ostringstream out;
  { ProgressBar(out, ProgressStyle::kBar).report("read", 0.5); }
  EXPECT_THAT(out.str(), HasSubstr(" 50 %  read"));
  EXPECT_EQ(out.str().substr(out.str().size() - 4), "\r\x1b[K");
}

TEST(ProgressBar, SaysNothingWhenToldTo) {
  std::ostringstream out;
  { ProgressBar(out, ProgressStyle::kNone).report("read", 0.5); }
  EXPECT_EQ(out.str(), "");
}

TEST(ProgressBar, NeverGoesBackNorPastTheEnd) {
  std::ostringstream out;
  double now = 0;
  ProgressBar progress(out, ProgressStyle::kLines, [&] { return now; });
  for (const auto& [stage, fraction] : {std::pair{"a", -1.0},
                                        {"b", std::nan("")},
                                        {"c", 0.7},
                                        {"d", 0.1},
                                        {"e", 7.0},
                                        {"f", 0.0}}) {
    now += 0.301;
    progress.report(stage, fraction);
  }
  EXPECT_EQ(out.str(),
            "mdprep:   0 %  a\nmdprep:   0 %  b\nmdprep:  70 %  c\nmdprep:  70 %  d, 0:01 left\n"
            "mdprep: 100 %  e\nmdprep: 100 %  f\n");
}

TEST(ProgressBar, APartCoversItsShareOfTheWhole) {
  struct Recorder final : ProgressSink {
    std::vector<double> seen;
    void report(std::string_view, double fraction) override { seen.push_back(fraction); }
  } whole;
  ProgressPart part(whole, 0.5, 0.75);
  part.report("x", 0);
  part.report("x", 0.5);
  part.report("x", 1);
  EXPECT_THAT(whole.seen, testing::ElementsAre(0.5, 0.625, 0.75));
}

}  // namespace
}  // namespace mdk
