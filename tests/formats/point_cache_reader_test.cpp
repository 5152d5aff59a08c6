#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "formats/mesh/point_cache.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/point_cache_builder.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;

constexpr std::uint32_t kPoints = 3, kFrames = 4;

/// A different number in each place.
std::vector<Vec3f> points(std::uint32_t count) {
  std::vector<Vec3f> all(count);
  for (std::uint32_t i = 0; i < count; ++i)
    all[i] = {static_cast<float>(i), 0.25f * static_cast<float>(i), -1.5f - static_cast<float>(i)};
  return all;
}

class PointCacheReader : public testing::Test {
 protected:
  PointCache read(const Bytes& bytes, std::uint32_t vertices = kPoints, double fps = 30) {
    const std::string path = folder_.file("cache");
    write_bytes(path, bytes);
    return read_point_cache(path, {fps, vertices}, progress_);
  }
  void expect_bad(const Bytes& bytes, const std::string& words) {
    expect_error(ErrorCode::kBadInput, words, [&] { read(bytes); });
  }
  const Bytes pc2_ = pc2_bytes(kFrames, points(kPoints* kFrames));
  const Bytes mdd_ = mdd_bytes({2, 2.5, 4, 4.125}, points(kPoints* kFrames));

  TempFolder folder_;
  SilentProgress progress_;
};

Bytes with_word(Bytes bytes, std::size_t at, std::uint32_t word, std::endian order) {
  Bytes replacement;
  append_word(replacement, word, order);
  std::copy(replacement.begin(), replacement.end(), bytes.begin() + static_cast<long>(at));
  return bytes;
}

TEST_F(PointCacheReader, FramesOfAPc2FollowItsRateAndTheFps) {
  const PointCache cache = read(pc2_bytes(kFrames, points(kPoints * kFrames), 2), kPoints, 8);
  EXPECT_THAT(cache.key_times, ElementsAre(0, 0.25, 0.5, 0.75));
  EXPECT_THAT(cache.positions, testing::ElementsAreArray(points(kPoints * kFrames)));
}

TEST_F(PointCacheReader, FramesOfAnMddHaveTimesOfTheirOwnFromTheFirst) {
  const PointCache cache = read(mdd_);
  EXPECT_THAT(cache.key_times, ElementsAre(0, 0.5, 2, 2.125));
  EXPECT_THAT(cache.positions, testing::ElementsAreArray(points(kPoints * kFrames)));
}

TEST_F(PointCacheReader, ManyFramesComeInTheirOrder) {
  constexpr std::uint32_t kMany = 1000;
  EXPECT_THAT(read(pc2_bytes(kMany, points(kPoints * kMany))).positions,
              testing::ElementsAreArray(points(kPoints * kMany)));
}

TEST_F(PointCacheReader, ACacheOfAnotherMeshIsRefused) {
  for (const Bytes& bytes : {pc2_, mdd_})
    expect_error(ErrorCode::kBadInput, "moves 3 points, but the mesh has 4 vertices",
                 [&] { read(bytes, 4); });
}

TEST_F(PointCacheReader, ACutAtAnyLengthIsRefused) {
  for (const Bytes& whole : {pc2_, mdd_})
    for (std::size_t size = 0; size < whole.size(); ++size) {
      SCOPED_TRACE(size);
      expect_bad({whole.begin(), whole.begin() + static_cast<long>(size)}, "cache: ");
    }
}

TEST_F(PointCacheReader, CountsThatPromiseTooMuchAllocateNothing) {
  constexpr auto kLittle = std::endian::little, kBig = std::endian::big;
  for (const std::uint32_t count : {5u, 0x7fffffffu, 0x80000000u, 0xffffffffu, 0x55555556u}) {
    SCOPED_TRACE(count);
    expect_bad(with_word(pc2_, 28, count, kLittle), "is cut short: it has 4 of its");
    expect_bad(with_word(mdd_, 0, count, kBig), "is cut short: it has 4 of its");
    // Even where the mesh had so many vertices.
    expect_error(ErrorCode::kBadInput, "is cut short",
                 [&] { read(with_word(pc2_, 16, count, kLittle), count); });
  }
  expect_bad(with_word(pc2_, 28, 0, kLittle), "has no frames");
  expect_bad(with_word(mdd_, 0, 0, kBig), "has no frames");
  expect_bad(with_word(pc2_, 16, 0, kLittle), "has no frames or no points");
}

TEST_F(PointCacheReader, HeadersThatMakeNoSenseAreRefused) {
  constexpr auto kLittle = std::endian::little;
  expect_bad(with_word(pc2_, 12, 2, kLittle), "is version 2 of PC2");
  for (const float rate : {0.f, -1.f, std::nanf(""), std::numeric_limits<float>::infinity()})
    expect_bad(pc2_bytes(kFrames, points(kPoints * kFrames), rate), "sample rate");
  for (const float second : {2.f, 1.f, std::nanf(""), std::numeric_limits<float>::infinity()})
    expect_bad(mdd_bytes({2, second, 4, 5}, points(kPoints * kFrames)), "frame 1 is not later");
}

TEST_F(PointCacheReader, TheFirstFrameThatIsNotFiniteIsNamed) {
  for (const float wrong : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    std::vector<Vec3f> broken = points(kPoints * kFrames);
    broken[5].y = broken[11].z = wrong;
    expect_bad(pc2_bytes(kFrames, broken), "frame 1 has a coordinate that is not a finite number");
    expect_bad(mdd_bytes({0, 1, 2, 3}, broken), "frame 1 has a coordinate");
  }
}

TEST_F(PointCacheReader, MissingFilesAreIoErrors) {
  expect_error(ErrorCode::kIo, "none.pc2", [&] {
    read_point_cache(folder_.file("none.pc2"), {30, kPoints}, progress_);
  });
}

}  // namespace
}  // namespace mdk::test
