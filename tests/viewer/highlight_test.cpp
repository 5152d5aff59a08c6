// Pixels that stand out in a picture that is there already.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/trace/renderer.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/picture/shown_picture.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kGrey = 0xff606060, kRed = 0xff0000ff, kWhite = 0xffffffff;

/// 6 x 5 pixels of background with triangles 10 to 13 in a block of 4 x 3 in the middle.
std::vector<std::uint32_t> block() {
  std::vector<std::uint32_t> triangles(30, kNoHit);
  for (std::size_t y = 1; y < 4; ++y)
    for (std::size_t x = 1; x < 5; ++x) triangles[6 * y + x] = static_cast<std::uint32_t>(9 + x);
  return triangles;
}

TEST(Highlight, TintsItsTrianglesWithAWhiteEdgeAndTouchesNothingElse) {
  const Picture plain{6, 5, std::vector<std::uint32_t>(30, kGrey)};
  const auto triangles = block();
  const Picture marked = highlighted(plain, triangles, 6, {10, 4, kRed});
  for (std::size_t i = 0; i < 30; ++i) {
    const std::size_t x = i % 6, y = i / 6;
    const bool inner = y == 2 && (x == 2 || x == 3);
    if (triangles[i] == kNoHit) {
      EXPECT_EQ(marked.pixels[i], kGrey) << x << " " << y;
    } else if (inner) {
      EXPECT_GT(marked.pixels[i] & 255, marked.pixels[i] >> 8 & 255) << "reddish";
      EXPECT_NE(marked.pixels[i], kWhite);
    } else {
      EXPECT_EQ(marked.pixels[i], kWhite) << x << " " << y;
    }
  }
  const Picture last = highlighted(plain, triangles, 6, {13, 1, kRed});
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(last.pixels[i] != kGrey, triangles[i] == 13) << i;
}

TEST(Highlight, MarksBothPicturesThatStandSideBySide) {
  const Picture two{12, 5, std::vector<std::uint32_t>(60, kGrey)};
  const Picture marked = highlighted(two, block(), 6, {10, 4, kRed});
  for (std::size_t y = 0; y < 5; ++y)
    for (std::size_t x = 0; x < 6; ++x)
      EXPECT_EQ(marked.pixels[12 * y + x], marked.pixels[12 * y + 6 + x]) << x << " " << y;
  EXPECT_EQ(std::ranges::count(marked.pixels, kGrey), 2 * (30 - 12));
}

TEST(Highlight, RefusesTrianglesOfAnotherPicture) {
  const Picture plain{6, 5, std::vector<std::uint32_t>(30, kGrey)};
  EXPECT_THROW(highlighted(plain, block(), 5, {0, 1, kRed}), Error);
  EXPECT_THROW(highlighted(plain, {}, 0, {0, 1, kRed}), Error);
}

TEST(Highlight, TrianglesOfAPictureAreThoseOfItsHits) {
  const ModelStorage bar = waving_bar();
  const ModelView model = bar.view();
  Renderer renderer(model, "fuzzy-bvh");
  FrameRequest request;
  request.camera = fit_camera(model.bounds, 1);
  request.width = 53;  // no whole number of tiles
  request.height = 37;
  renderer.render(request);
  const auto triangles = triangles_of(renderer.hits());
  std::size_t hits = 0;
  for (std::uint32_t y = 0; y < request.height; ++y)
    for (std::uint32_t x = 0; x < request.width; ++x) {
      const std::uint32_t triangle = triangles[y * request.width + x];
      EXPECT_EQ(triangle, renderer.hits().triangle(x, y)) << x << " " << y;
      hits += triangle != kNoHit;
    }
  EXPECT_GT(hits, 50u);
}

TEST(Highlight, ADifferenceStaysAsItIs) {
  FinishedFrame frame;
  frame.job.request.width = 6;
  frame.job.request.height = 5;
  frame.pixels.assign(30, kGrey);
  frame.triangles = block();
  frame.second.emplace();
  frame.second->pixels = frame.pixels;
  CompareSettings settings;
  ShownPicture shown;
  for (const CompareMode mode : {CompareMode::kOff, CompareMode::kSideBySide, CompareMode::kWipe,
                                 CompareMode::kDifference}) {
    settings.mode = mode;
    shown.show(frame, settings);
    EXPECT_EQ(shown.with({10, 4, kRed}).pixels == shown.picture().pixels,
              mode == CompareMode::kDifference);
  }
}

}  // namespace
}  // namespace mdk::test
