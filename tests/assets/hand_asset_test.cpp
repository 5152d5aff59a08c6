// The committed hand: what the program makes, a sound mesh, a sound skin, clips that loop.
#include "assets/hand_asset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "common/base/parallel.h"
#include "formats/gltf/reader.h"
#include "tests/assets/glb_content.h"
#include "tests/assets/mesh_topology.h"

namespace mdk {
namespace {

const char* const kPath = MDK_SOURCE_DIR "/assets/hand.glb";

GlbContent committed() { return parse_glb(read_bytes(kPath)); }

std::vector<TriangleIndices> triangles_of(const GlbContent& glb) {
  const std::vector<double> indices = glb.indices();
  std::vector<TriangleIndices> triangles;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    triangles.push_back({static_cast<std::uint32_t>(indices[i]),
                         static_cast<std::uint32_t>(indices[i + 1]),
                         static_cast<std::uint32_t>(indices[i + 2])});
  return triangles;
}

std::vector<Vec3d> positions_of(const GlbContent& glb) {
  const std::vector<double> p = glb.attribute("POSITION");
  std::vector<Vec3d> positions;
  for (std::size_t i = 0; i < p.size(); i += 3) positions.push_back({p[i], p[i + 1], p[i + 2]});
  return positions;
}

/// "index" for joint "index_2"; empty for joints of the palm and the arm.
std::string digit_of(const std::string& joint) {
  for (const char* digit : {"thumb", "index", "middle", "ring", "little"})
    for (const char* bone : {"_1", "_2", "_3"})
      if (joint == std::string(digit) + bone) return digit;
  return {};
}

TEST(HandAsset, CommittedFileIsWhatTheProgramMakes) {
  EXPECT_EQ(difference(committed(), parse_glb(encode_glb(make_hand_scene()))), "")
      << "run \"make_sample hand assets\" and commit the new assets/hand.glb";
}

TEST(HandAsset, HasThePromisedSize) {
  EXPECT_LT(read_bytes(kPath).size(), 2u << 20);
  const GlbContent glb = committed();
  EXPECT_GE(glb.indices().size() / 3, 15000u);
  EXPECT_LE(glb.indices().size() / 3, 17000u);
  EXPECT_EQ(glb.json["skins"][0]["joints"].size(), 20u);
}

TEST(HandAsset, IsOneClosedSurfaceWithoutHandles) {
  const GlbContent glb = committed();
  const auto triangles = triangles_of(glb);
  const auto positions = positions_of(glb);
  EXPECT_EQ(unmatched_edges(triangles), 0u);
  EXPECT_EQ(pinched_vertices(triangles, positions.size()), 0u);
  // Fingers that touch would make a handle.
  EXPECT_EQ(euler_characteristic(triangles, positions.size()), 2);
  const double litres = enclosed_volume(triangles, positions) * 1e3;
  EXPECT_GT(litres, 0.3);
  EXPECT_LT(litres, 1.0);
}

TEST(HandAsset, NormalsAreUnitVectorsThatLookOutwards) {
  const GlbContent glb = committed();
  const auto positions = positions_of(glb);
  const std::vector<double> n = glb.attribute("NORMAL");
  std::vector<Vec3d> facing(positions.size());
  for (const auto& [a, b, c] : triangles_of(glb))
    for (const auto v : {a, b, c})
      facing[v] += cross(positions[b] - positions[a], positions[c] - positions[a]);
  std::size_t inward = 0;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3d normal{n[3 * v], n[3 * v + 1], n[3 * v + 2]};
    EXPECT_NEAR(length(normal), 1, 1e-4);
    inward += dot(normal, facing[v]) <= 0;
  }
  EXPECT_EQ(inward, 0u);
}

TEST(HandAsset, SkinWeightsSumToOneAndNameJoints) {
  const GlbContent glb = committed();
  const auto joints = glb.attribute("JOINTS_0"), weights = glb.attribute("WEIGHTS_0");
  ASSERT_EQ(joints.size(), weights.size());
  for (std::size_t i = 0; i < weights.size(); i += 4) {
    EXPECT_EQ(weights[i] + weights[i + 1] + weights[i + 2] + weights[i + 3], 65535);
    std::set<double> used;
    for (std::size_t k = i; k < i + 4; ++k) {
      EXPECT_LT(joints[k], 20);
      if (weights[k] == 0) continue;
      EXPECT_TRUE(used.insert(joints[k]).second) << "a joint twice";
    }
  }
}

TEST(HandAsset, NoFingerMovesAnotherFinger) {
  const GlbContent glb = committed();
  const auto joints = glb.attribute("JOINTS_0"), weights = glb.attribute("WEIGHTS_0");
  std::size_t on_digits = 0;
  for (std::size_t i = 0; i < weights.size(); i += 4) {
    std::set<std::string> digits;
    bool beyond_web = false;
    for (std::size_t k = i; k < i + 4; ++k) {
      if (weights[k] == 0) continue;
      const auto node = glb.json["skins"][0]["joints"][static_cast<std::size_t>(joints[k])];
      const std::string name = glb.json["nodes"][node.get<std::size_t>()]["name"];
      const std::string digit = digit_of(name);
      if (!digit.empty()) digits.insert(digit);
      beyond_web |= !digit.empty() && (name.ends_with("_2") || name.ends_with("_3"));
    }
    if (!beyond_web) continue;
    ++on_digits;
    EXPECT_EQ(digits.size(), 1u) << "vertex " << i / 4;
  }
  EXPECT_GT(on_digits, 2000u);
}

class HandMotion : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    SilentProgress progress;
    sequence_ = new PoseSequence(read_gltf(kPath, {}, progress).sequence);
  }
  static void TearDownTestSuite() {
    delete sequence_;
    sequence_ = nullptr;
  }

  static double volume(std::uint32_t key) {
    std::vector<TriangleIndices> triangles;
    for (const Triangle& t : sequence_->triangles) triangles.push_back({t.v[0], t.v[1], t.v[2]});
    std::vector<Vec3d> positions;
    for (const Vec3f& p : sequence_->pose(key)) positions.push_back(to_double(p));
    return enclosed_volume(triangles, positions);
  }

  static PoseSequence* sequence_;
};
PoseSequence* HandMotion::sequence_ = nullptr;

TEST_F(HandMotion, HasThreeClipsOfThirtyKeysASecond) {
  ASSERT_EQ(sequence_->clips.size(), 3u);
  EXPECT_EQ(sequence_->clips[0].name, "grasp");
  EXPECT_EQ(sequence_->clips[0].key_count, 61u);
  EXPECT_EQ(sequence_->clips[1].name, "count");
  EXPECT_EQ(sequence_->clips[1].key_count, 121u);
  EXPECT_EQ(sequence_->clips[2].name, "beckon");
  EXPECT_EQ(sequence_->clips[2].key_count, 30u);
}

TEST_F(HandMotion, EndsEachClipWhereItBeganAndMovesBetween) {
  for (const Clip& clip : sequence_->clips) {
    const auto first = sequence_->pose(clip.first_key);
    const auto last = sequence_->pose(clip.first_key + clip.key_count - 1);
    const auto middle = sequence_->pose(clip.first_key + clip.key_count / 2);
    float gap = 0, travel = 0;
    for (std::size_t v = 0; v < first.size(); ++v) {
      gap = std::max(gap, length(last[v] - first[v]));
      travel = std::max(travel, length(middle[v] - first[v]));
    }
    EXPECT_LT(gap, 1e-5f) << clip.name;
    EXPECT_GT(travel, 0.05f) << clip.name;
  }
}

TEST_F(HandMotion, KeepsItsVolumeInEveryPose) {
  const auto glb = committed();
  const double rest = enclosed_volume(triangles_of(glb), positions_of(glb));
  for (std::uint32_t key = 0; key < sequence_->key_count(); key += 5) {
    EXPECT_GT(volume(key), 0.90 * rest) << "key " << key;
    EXPECT_LT(volume(key), 1.05 * rest) << "key " << key;
  }
}

}  // namespace
}  // namespace mdk
