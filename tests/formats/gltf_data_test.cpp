#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "formats/gltf/compression.h"
#include "formats/gltf/reader.h"
#include "tests/formats/gltf_builder.h"
#include "tests/formats/sample_data.h"

namespace mdk::test {
namespace {

namespace fs = std::filesystem;

class GltfData : public SampleData {};

TEST_F(GltfData, EveryFileIsReadOrRefusedForAFeatureThatIsNamed) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    if (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    try {
      // A low rate: what is looked for is in the structure, not in the number of keys.
      const PoseSequence s = read_file(file.string(), 2).sequence;
      EXPECT_GT(s.triangles.size(), 0u);
      EXPECT_GT(s.vertex_count, 0u);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      EXPECT_THAT(error.what(), testing::HasSubstr("needs the extension"));
      EXPECT_THAT(error.what(), testing::HasSubstr(file.filename().string()));
    }
  }
}

TEST_F(GltfData, TrianglesAndClipsAreThoseTheirMakersDeclare) {
  struct Known {
    const char* name;
    std::size_t triangles;
    std::uint32_t most_vertices;  ///< before equal ones are joined
    std::size_t clips;
    double seconds;  ///< of the first clip, from its first key
  };
  const Known all[] = {
      {"khronos/BrainStem.glb", 61666, 34159, 1, 34.88},
      {"khronos/CesiumMan.glb", 4672, 3273, 1, 1.958},
      {"khronos/CesiumMilkTruck.glb", 3624, 4823, 1, 1.25},
      {"khronos/Fox.glb", 576, 1728, 3, 3.42},
      {"khronos/InterpolationTest.glb", 110, 220, 9, 1.625},
      {"khronos/AnimatedMorphSphere.glb", 960, 1876, 1, 7.2},
      {"cal3d/cally.glb", 3342, 1844, 7, 0.03},
      {"cal3d/skeleton.glb", 4604, 2527, 7, 11.23},
      {"cal3d/paladin.glb", 3422, 2235, 7, 0.03},
      {"characters/kaykit_Knight.glb", 6952, 7024, 76, 1.17},
      {"characters/quaternius_Tank4.glb", 11402, 15021, 4, 0.79},
  };
  for (const Known& known : all) {
    if (!fs::exists(need(known.name))) continue;
    SCOPED_TRACE(known.name);
    const PoseSequence s = read_file(need(known.name), 4).sequence;
    EXPECT_EQ(s.triangles.size(), known.triangles);
    EXPECT_LE(s.vertex_count, known.most_vertices);
    EXPECT_EQ(s.clips.size(), known.clips);
    if (std::string(known.name).find("Knight") == std::string::npos) {
      EXPECT_NEAR(s.key_times[s.clips[0].key_count - 1], known.seconds, 0.006);
    }
  }
}

TEST_F(GltfData, QuantizedFilesMoveLikeTheirOriginals) {
  const std::string plain = need("khronos/Fox.glb"),
                    packed = need("khronos/Fox_gltfpack_quantized.glb");
  if (!fs::exists(plain) || !fs::exists(packed)) GTEST_SKIP() << "the fox is not there";
  const PoseSequence a = read_file(plain, 5, {"Run"}).sequence;
  const PoseSequence b = read_file(packed, 5, {"Run"}).sequence;
  // The packer reorders vertices and ends a little later: compare boxes of poses, in a fox of 155.
  for (std::uint32_t key = 0; key + 1 < std::min(a.key_count(), b.key_count()); ++key) {
    const auto corners = [&](const PoseSequence& s) {
      Vec3f lo = s.pose(key)[0], hi = lo;
      for (const Vec3f& p : s.pose(key))
        for (std::size_t c = 0; c < 3; ++c) {
          lo[c] = std::min(lo[c], p[c]);
          hi[c] = std::max(hi[c], p[c]);
        }
      return std::pair(lo, hi);
    };
    const auto [lo_a, hi_a] = corners(a);
    const auto [lo_b, hi_b] = corners(b);
    EXPECT_LT(length(lo_a - lo_b), 0.3f) << key;
    EXPECT_LT(length(hi_a - hi_b), 0.3f) << key;
  }
}

/// Point cache, version 1: a 32-byte header, then float xyz, frame by frame.
std::vector<std::vector<Vec3f>> read_pc2(const std::string& path) {
  const Bytes bytes = read_bytes(path);
  std::int32_t points = 0, frames = 0;
  std::memcpy(&points, bytes.data() + 16, 4);
  std::memcpy(&frames, bytes.data() + 28, 4);
  std::vector<std::vector<Vec3f>> all(static_cast<std::size_t>(frames),
                                      std::vector<Vec3f>(static_cast<std::size_t>(points)));
  const unsigned char* next = bytes.data() + 32;
  for (std::vector<Vec3f>& frame : all) {
    std::memcpy(frame.data(), next, frame.size() * sizeof(Vec3f));
    next += frame.size() * sizeof(Vec3f);
  }
  return all;
}

TEST_F(GltfData, ADracoFileMovesLikeItsOriginal) {
  if (!gltf::can_decode_draco()) GTEST_SKIP() << "built without Draco";
  const PoseSequence plain = read_file(need("khronos/RiggedSimple_embedded.gltf")).sequence;
  const PoseSequence draco =
      read_file(need("khronos/RiggedSimple_draco/RiggedSimple.gltf")).sequence;
  ASSERT_EQ(draco.triangles.size(), plain.triangles.size());
  ASSERT_EQ(draco.key_times, plain.key_times);
  // Draco orders vertices its own way: each must move all the time beside one of the original's.
  float worst = 0;
  for (std::uint32_t v = 0; v < draco.vertex_count; ++v) {
    float nearest = 1e9f;
    for (std::uint32_t w = 0; w < plain.vertex_count; ++w) {
      float farthest = 0;
      for (std::uint32_t k = 0; k < plain.key_count() && farthest < nearest; ++k)
        farthest = std::max(farthest, length(draco.pose(k)[v] - plain.pose(k)[w]));
      nearest = std::min(nearest, farthest);
    }
    worst = std::max(worst, nearest);
  }
  // 11 bits of a cylinder 8.4 long, and the joints' turn of what is off.
  EXPECT_LT(worst, 0.01f);
}

TEST_F(GltfData, MorphTargetsGiveThePointCacheTheyWereMadeFrom) {
  const std::string glb = need("sequences/horse_gallop.glb");
  const std::string pc2 = need("sequences/horse_gallop.pc2");
  if (!fs::exists(glb) || !fs::exists(pc2)) GTEST_SKIP() << "the horse is not there";
  const PoseSequence s = read_file(glb, 24).sequence;
  const std::vector<std::vector<Vec3f>> frames = read_pc2(pc2);
  ASSERT_EQ(s.key_count(), frames.size());
  // Vertices come in the order of first use: find each by its place in the first frame.
  ASSERT_EQ(s.vertex_count, frames[0].size());
  std::vector<std::size_t> source(s.vertex_count);
  for (std::size_t i = 0; i < source.size(); ++i) {
    float best = 1e9f;
    for (std::size_t j = 0; j < frames[0].size(); ++j) {
      const float distance = length(frames[0][j] - s.pose(0)[i]);
      if (distance < best) {
        best = distance;
        source[i] = j;
      }
    }
  }
  float worst = 0;
  for (std::uint32_t key = 0; key < s.key_count(); ++key)
    for (std::size_t i = 0; i < source.size(); ++i)
      worst = std::max(worst, length(frames[key][source[i]] - s.pose(key)[i]));
  EXPECT_LT(worst, 1e-6f);  // the horse is 1.8 long
}

}  // namespace
}  // namespace mdk::test
