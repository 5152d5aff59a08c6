// What comes through Assimp stands where the same motion stands by its formula.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <random>

#include "formats/assimp/reader.h"
#include "formats/files/file_kind.h"
#include "formats/files/image_writer.h"
#include "tests/formats/assimp_samples.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::FloatNear;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr float kTolerance = 1e-5f;  // of positions about 1 large: float matrices, multiplied

/// What stops a reader that asks whether it may go on.
struct Stop {};
class StoppingProgress final : public ProgressSink {
 public:
  void report(std::string_view, double) override { throw Stop(); }
};

class ThroughAssimp : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_assimp()) GTEST_SKIP() << "Assimp was not there when this was built";
  }

  std::string put(const std::string& name, const std::string& text) {
    write_text(folder_.file(name), text);
    return folder_.file(name);
  }
  ReadResult read(const std::string& name, double fps = 4) {
    SilentProgress silent;
    ReadOptions options;
    options.fps = fps;
    return read_with_assimp(folder_.file(name), options, silent);
  }
  void expect_refused(const std::string& name, ErrorCode code, const std::string& words) {
    expect_error(code, words, [&] { read(name); });
    expect_error(code, name + ": ", [&] { read(name); });
  }

  TempFolder folder_;
};

/// Where the bar's corners stand when its upper bone has turned by `radians`, each mapped by
/// `place`.
template <class Place>
std::vector<Vec3f> bent(double radians, const Place& place) {
  std::vector<Vec3f> corners;
  const double c = std::cos(radians), s = std::sin(radians);
  for (int y = 0; y <= 2; ++y) {
    for (int x = 0; x <= 1; ++x) {
      const double turned_x = c * x - s * (y - 1), turned_y = 1 + s * x + c * (y - 1);
      const double w = y / 2.0;
      corners.push_back(place((1 - w) * x + w * turned_x, (1 - w) * y + w * turned_y));
    }
  }
  return corners;
}

/// Every corner of the pose is one of `expected`, and each of those is there.
void expect_corners(std::span<const Vec3f> pose, const std::vector<Vec3f>& expected) {
  const auto is_near = [](const Vec3f& a, const Vec3f& b) {
    return length(to_double(a) - to_double(b)) < kTolerance;
  };
  for (const Vec3f& corner : expected) {
    bool found = false;
    for (const Vec3f& p : pose) found |= is_near(p, corner);
    EXPECT_TRUE(found) << "nothing at " << corner.x << ", " << corner.y << ", " << corner.z;
  }
  for (const Vec3f& p : pose) {
    bool found = false;
    for (const Vec3f& corner : expected) found |= is_near(p, corner);
    EXPECT_TRUE(found) << "something at " << p.x << ", " << p.y << ", " << p.z;
  }
}

/// Five keys in a second: at 0, 22.5, 45, 67.5 and 90 degrees.
template <class Place>
void expect_bending(const PoseSequence& s, const Place& place) {
  ASSERT_EQ(s.key_count(), 5u);
  EXPECT_EQ(s.triangles.size(), 4u);
  ASSERT_TRUE(s.rig);
  for (std::uint32_t k = 0; k < 5; ++k) {
    SCOPED_TRACE(k);
    EXPECT_NEAR(s.key_times[k], k / 4.0, 1e-6);
    expect_corners(s.pose(k), bent(k * std::numbers::pi / 8, place));
  }
}

Vec3f vector(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

TEST_F(ThroughAssimp, ColladaSkinsMoveAsTheirFormulaSays) {
  put("bar.dae", bending_collada());
  const ReadResult result = read("bar.dae");
  expect_bending(result.sequence, [](double x, double y) { return vector(x, y, 0); });
  EXPECT_EQ(result.sequence.clips[0].name, "bend");
}

TEST_F(ThroughAssimp, ColladaAxesAndUnitsBecomeYUpAndMetres) {
  put("bar.dae", bending_collada({"Z_UP", "0.5", ""}));
  expect_bending(read("bar.dae").sequence,
                 [](double x, double y) { return vector(x / 2, 0, -y / 2); });
}

TEST_F(ThroughAssimp, Md5MeshesMoveByTheAnimationBesideThem) {
  put("bar.md5mesh", bending_md5mesh());
  EXPECT_EQ(read("bar.md5mesh").sequence.key_count(), 1u) << "nothing is beside it";
  put("bar.md5anim", bending_md5anim());
  const ReadResult result = read("bar.md5mesh");
  expect_bending(result.sequence, [](double x, double y) { return vector(x, 0, -y); });
  EXPECT_THAT(result.dependencies, ElementsAre(EndsWith("bar.md5mesh"), EndsWith("bar.md5anim")));
}

TEST_F(ThroughAssimp, MotionCaptureIsDrawnAsItsBones) {
  put("walk.bvh", bending_bvh());
  const PoseSequence s = read("walk.bvh", 2).sequence;
  ASSERT_EQ(s.key_count(), 3u);
  const auto nearest = [&](std::uint32_t key, const Vec3f& place) {
    double least = 1e30;
    for (const Vec3f& p : s.pose(key))
      least = std::min(least, length(to_double(p) - to_double(place)));
    return least;
  };
  EXPECT_LT(nearest(0, vector(0, 3, 0)), 1e-5) << "the end of the upper bone";
  EXPECT_LT(nearest(2, vector(1, 2, 0)), 1e-5);
  EXPECT_LT(nearest(2, vector(2, 2, 0)), 1e-5) << "the end of the lower one";
}

TEST_F(ThroughAssimp, XFilesAreTurnedIntoTheRightHand) {
  put("plate.x", moving_x());
  const ReadResult result = read("plate.x", 2);
  const PoseSequence& s = result.sequence;
  ASSERT_EQ(s.key_count(), 3u);
  EXPECT_EQ(s.clips[0].name, "Slide");
  for (int k = 0; k < 3; ++k) {
    const float t = static_cast<float>(k) / 2;
    expect_corners(s.pose(static_cast<std::uint32_t>(k)),
                   {vector(2 * t, 3 * t, -4 * t), vector(1 + 2 * t, 3 * t, -4 * t),
                    vector(2 * t, 1 + 3 * t, -4 * t)});
  }
  EXPECT_THAT(result.notes, Contains(HasSubstr("name no ticks per second; 4800 are taken")));
}

TEST_F(ThroughAssimp, FbxPivotsAxesAndUnitsAreFollowed) {
  for (const int up_axis : {1, 2}) {
    SCOPED_TRACE(up_axis);
    put("plate.fbx", turning_fbx(80, up_axis));
    const PoseSequence s = read("plate.fbx").sequence;
    ASSERT_EQ(s.key_count(), 5u);
    EXPECT_EQ(s.clips[0].name, "Turn");
    for (std::uint32_t k = 0; k < 5; ++k) {
      const double angle = (90 + 20.0 * k) * std::numbers::pi / 180;
      std::vector<Vec3f> expected;
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}}) {
        const double px = 1 + std::cos(angle) * (x - 1) - std::sin(angle) * y;
        const double py = std::sin(angle) * (x - 1) + std::cos(angle) * y;
        expected.push_back(up_axis == 1 ? vector(px / 100, py / 100, 0)
                                        : vector(px / 100, 0, -py / 100));
      }
      expect_corners(s.pose(k), expected);
    }
  }
}

TEST_F(ThroughAssimp, ATurnOfMoreThanHalfACircleBetweenFbxKeysKeepsItsWay) {
  put("plate.fbx", turning_fbx(270));
  const PoseSequence s = read("plate.fbx", 8).sequence;
  // After half the time: 135 degrees, and 90 before it.
  const double angle = 225 * std::numbers::pi / 180;
  const Vec3f corner = vector((1 - std::cos(angle)) / 100, -std::sin(angle) / 100, 0);
  double nearest = 1;
  for (const Vec3f& p : s.pose(4))
    nearest = std::min(nearest, length(to_double(p) - to_double(corner)));
  EXPECT_LT(nearest, 1e-4);
}

TEST_F(ThroughAssimp, IsSaidInTheResultAndANote) {
  put("bar.dae", bending_collada());
  const ReadResult result = read("bar.dae");
  EXPECT_THAT(result.read_through, testing::StartsWith("Assimp 5"));
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("was read through Assimp 5")));
}

TEST_F(ThroughAssimp, ColoursAreSrgbAndImagesStandInTheFolder) {
  put("bar.dae", bending_collada());
  EXPECT_THAT(read("bar.dae").sequence.appearance.materials[0].base_color,
              ElementsAre(FloatNear(0.21404114f, 1e-6f), 0.0f, 1.0f, 1.0f));

  const std::uint32_t texel[] = {0xff336699u};
  write_png(folder_.file("wood 1.png"), 1, 1, texel);
  for (const char* name : {"wood%201.png", "C:\\work\\wood 1.png", "../elsewhere/wood%201.png"}) {
    put("bar.dae", bending_collada({"Y_UP", "1", name}));
    const ReadResult result = read("bar.dae");
    EXPECT_THAT(result.sequence.appearance.texels, ElementsAre(0xff336699u)) << name;
    EXPECT_THAT(result.dependencies, Contains(EndsWith("wood 1.png"))) << name;
  }
}

TEST_F(ThroughAssimp, NothingOutsideTheFolderIsOpened) {
  std::filesystem::create_directory(folder_.file("inner"));
  const std::uint32_t texel[] = {0xff336699u};
  write_png(folder_.file("wood.png"), 1, 1, texel);
  for (const std::string& name : {std::string("../wood.png"), folder_.file("wood.png")}) {
    put("inner/bar.dae", bending_collada({"Y_UP", "1", name}));
    const ReadResult result = read("inner/bar.dae");
    EXPECT_THAT(result.sequence.appearance.texels, IsEmpty()) << name;
    EXPECT_EQ(result.dependencies.size(), 1u) << name;
    EXPECT_THAT(result.notes, Contains(HasSubstr("cannot be read; the plain base colour")));
  }
}

TEST_F(ThroughAssimp, SkeletonsAreKeptWhereAskedFor) {
  put("bar.dae", bending_collada());
  SilentProgress silent;
  ReadOptions options;
  options.skeleton = true;
  const ReadResult result = read_with_assimp(folder_.file("bar.dae"), options, silent);
  ASSERT_TRUE(result.sequence.skeleton);
  const auto& names = result.sequence.skeleton->names;
  EXPECT_THAT(std::string(names.begin(), names.end()),
              testing::AllOf(HasSubstr("Hip"), HasSubstr("Knee")));
}

TEST_F(ThroughAssimp, ReadsTheSameBytesAsTheSame) {
  put("bar.dae", bending_collada());
  const ReadResult a = read("bar.dae"), b = read("bar.dae");
  EXPECT_EQ(a.sequence.positions, b.sequence.positions);
  EXPECT_EQ(a.sequence.triangles, b.sequence.triangles);
  EXPECT_EQ(a.notes, b.notes);
}

TEST_F(ThroughAssimp, WhatIsBrokenIsRefusedInOneSentence) {
  put("none.fbx", "");
  expect_refused("none.fbx", ErrorCode::kBadInput, "cannot be read by Assimp (");
  put("text.dae", "<COLLADA><asset>");
  expect_refused("text.dae", ErrorCode::kBadInput, "cannot be read by Assimp (");
  expect_refused("gone.x", ErrorCode::kIo, "there is no such file");
  expect_refused("", ErrorCode::kIo, "is not a file");
  std::string nan = bending_collada();
  nan.replace(nan.find("0 0 0 1 0 0"), 11, "0 0 0 nan 0");
  put("nan.dae", nan);
  expect_error(ErrorCode::kBadInput, "nan.dae: ", [&] { read("nan.dae"); });
}

TEST_F(ThroughAssimp, ASkeletonWithoutMeshIsRefused) {
  std::string fbx = turning_fbx(80);
  fbx.replace(fbx.find("\tC: \"OO\",10,20\n"), 15, "");
  put("bones.fbx", fbx);
  expect_refused("bones.fbx", ErrorCode::kBadInput,
                 "holds no mesh of triangles; export one with the skeleton");
}

TEST_F(ThroughAssimp, AFileThatAssimpCrashesOnIsRefused) {
  // One node within another: Assimp follows them by recursion.
  constexpr int kDepth = 400'000;
  std::string nested;
  for (int i = 0; i < kDepth; ++i) nested += "<node>";
  for (int i = 0; i < kDepth; ++i) nested += "</node>";
  std::string text = bending_collada();
  text.insert(text.find("<node id=\"body\""), nested);
  put("deep.dae", text);
  expect_refused("deep.dae", ErrorCode::kBadInput, "makes Assimp crash");
}

TEST_F(ThroughAssimp, ASmallFileCannotAskForEndlessMemory) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "a sanitizer ends the process before";
  std::string text = bending_md5mesh();
  text.replace(text.find("numverts 6"), 10, "numverts 4000000000");
  put("huge.md5mesh", text);
  expect_refused("huge.md5mesh", ErrorCode::kOverLimit, "takes Assimp more memory than");
}

TEST_F(ThroughAssimp, LeavesOffWhenItIsTold) {
  put("bar.dae", bending_collada());
  StoppingProgress stop;
  EXPECT_THROW(read_with_assimp(folder_.file("bar.dae"), {}, stop), Stop);
}

TEST_F(ThroughAssimp, AnyMutationIsReadOrRefusedInOneSentence) {
  constexpr int kMutations = 25;
  put("bar.md5anim", bending_md5anim());
  std::mt19937 random(20060901);
  std::size_t refused = 0;
  for (const auto& [name, text] : {std::pair{std::string("bar.dae"), bending_collada()},
                                   {std::string("bar.md5mesh"), bending_md5mesh()},
                                   {std::string("bar.x"), moving_x()},
                                   {std::string("bar.fbx"), turning_fbx(80)}}) {
    for (int turn = 0; turn < kMutations; ++turn) {
      std::string changed = text;
      for (int step = 0; step < 3; ++step)
        changed[random() % changed.size()] = static_cast<char>(" 09-.eN{<\"\n\xff"[random() % 12]);
      put(name, changed);
      try {
        const ReadResult result = read(name, 2);
        for (const Vec3f& p : result.sequence.positions)
          ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
      } catch (const Error& error) {
        ++refused;
        EXPECT_NE(error.code(), ErrorCode::kInternal) << error.what();
        EXPECT_THAT(error.what(), HasSubstr(name)) << turn;
        EXPECT_THAT(error.what(), Not(HasSubstr("\n"))) << turn;
      }
    }
  }
  std::printf("%zu of %d refused\n", refused, 4 * kMutations);
}

TEST(WithoutAssimp, ItsFilesAreRefusedByTheNameOfItsPackage) {
  if (has_assimp()) GTEST_SKIP() << "Assimp was there when this was built";
  SilentProgress silent;
  expect_error(ErrorCode::kBadInput, "build it where libassimp-dev is installed",
               [&] { read_with_assimp("walk.fbx", {}, silent); });
}

}  // namespace
}  // namespace mdk::test
