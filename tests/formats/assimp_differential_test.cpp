// Two readers of glTF, ours and Assimp's, must make the same poses of a file. What comes through
// Assimp has other vertices and another order of triangles: each of ours is looked for among its
// triangles by the way its corners take through the clips.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

#include "common/base/error.h"
#include "formats/assimp/reader.h"
#include "formats/files/file_kind.h"
#include "formats/gltf/reader.h"
#include "tests/formats/gltf_builder.h"
#include "tests/formats/sample_data.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

namespace fs = std::filesystem;

/// Of the diagonal of all poses: Assimp multiplies matrices in single precision.
constexpr double kTolerance = 2e-5;
constexpr std::uint32_t kMostKeys = 12;
constexpr double kFps = 8;

/// Files of which Assimp 5.2 gives other poses, and why.
constexpr const char* kNoFloats = "weights or tracks that are integers are taken for floats";
constexpr const char* kNoCurves = "CUBICSPLINE and STEP tracks run straight between their keys";
constexpr const char* kNamesakes =
    "joints are found by their names, which nodes of meshes have, too (none, once they differ)";
const std::map<std::string, std::string> kKnownDifferences = {
    {"hand.glb", kNoFloats},
    {"robot.glb", kNamesakes},
    {"Animation_SamplerType_02.gltf", kNoFloats},
    {"AnimatedMorphCube_quantized/AnimatedMorphCube.gltf", kNoFloats},
    {"Fox_gltfpack_quantized.glb", kNoFloats},
    {"01_morphed_cube.gltf", kNoCurves},
    {"03_all_animations.gltf", kNoCurves},
    {"Animation_Node_04.gltf", kNoCurves},
    {"InterpolationTest.glb", kNoCurves},
};

/// A triangle's corners at all keys that are compared.
using Path = std::vector<Vec3f>;

std::vector<std::uint32_t> compared_keys(const PoseSequence& s) {
  std::vector<std::uint32_t> keys;
  const std::uint32_t count = std::min(kMostKeys, s.key_count());
  for (std::uint32_t i = 0; i < count; ++i)
    keys.push_back(count == 1 ? 0 : i * (s.key_count() - 1) / (count - 1));
  return keys;
}

std::vector<Path> paths_of(const PoseSequence& s) {
  const std::vector<std::uint32_t> keys = compared_keys(s);
  std::vector<Path> paths(s.triangles.size());
  for (std::size_t t = 0; t < paths.size(); ++t)
    for (const std::uint32_t key : keys)
      for (const std::uint32_t v : s.triangles[t].v) paths[t].push_back(s.pose(key)[v]);
  return paths;
}

double diagonal_of(const std::vector<Path>& paths) {
  Vec3d low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};
  for (const Path& path : paths)
    for (const Vec3f& p : path)
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], static_cast<double>(p[a]));
        high[a] = std::max(high[a], static_cast<double>(p[a]));
      }
  return length(high - low);
}

/// The largest distance between corners, the second path's begun at its corner `turn`.
double distance(const Path& a, const Path& b, std::size_t turn) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const std::size_t j = i / 3 * 3 + (i + turn) % 3;
    largest = std::max(largest, length(to_double(a[i]) - to_double(b[j])));
  }
  return largest;
}

/// Triangles by the cell that their middle is in at the first key.
class Grid {
 public:
  using Cell = std::array<std::int64_t, 3>;

  Grid(const std::vector<Path>& paths, double size) : paths_(paths), size_(size) {
    for (std::size_t t = 0; t < paths.size(); ++t) cells_[cell_of(paths[t])].push_back(t);
  }

  /// Distance to the nearest triangle that is not taken, which then is; 1e30 where none is about.
  double take_nearest(const Path& path) {
    const Cell middle = cell_of(path);
    double least = 1e30;
    std::vector<std::size_t>* from = nullptr;
    std::size_t at = 0;
    for (std::int64_t i = 0; i < 27; ++i) {
      const auto cell =
          cells_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (cell == cells_.end()) continue;
      for (std::size_t k = 0; k < cell->second.size(); ++k)
        for (std::size_t turn = 0; turn < 3; ++turn)
          if (const double d = distance(path, paths_[cell->second[k]], turn); d < least) {
            least = d;
            from = &cell->second;
            at = k;
          }
    }
    if (from != nullptr) from->erase(from->begin() + static_cast<std::ptrdiff_t>(at));
    return least;
  }

 private:
  Cell cell_of(const Path& path) const {
    Cell cell{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double sum = static_cast<double>(path[0][a]) + static_cast<double>(path[1][a]) +
                         static_cast<double>(path[2][a]);
      cell[a] = std::llround(std::floor(sum / 3 / size_));
    }
    return cell;
  }

  const std::vector<Path>& paths_;
  const double size_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

/// In a sentence what differs; empty where nothing does.
std::string difference(const PoseSequence& ours, const PoseSequence& theirs, double& largest) {
  if (ours.triangles.size() != theirs.triangles.size())
    return std::to_string(ours.triangles.size()) + " triangles here, " +
           std::to_string(theirs.triangles.size()) + " there";
  if (ours.clips.size() != theirs.clips.size())
    return std::to_string(ours.clips.size()) + " clips here, " +
           std::to_string(theirs.clips.size()) + " there";
  for (std::size_t c = 0; c < ours.clips.size(); ++c)
    if (ours.clips[c].key_count != theirs.clips[c].key_count)
      return "clip " + std::to_string(c) + " has " + std::to_string(ours.clips[c].key_count) +
             " keys here, " + std::to_string(theirs.clips[c].key_count) + " there";
  const std::vector<Path> here = paths_of(ours), there = paths_of(theirs);
  const double diagonal = diagonal_of(here);
  Grid grid(there, std::max(4 * kTolerance * diagonal, 1e-12));
  std::size_t far = 0;
  for (const Path& path : here) {
    const double off = grid.take_nearest(path);
    far += !(off <= kTolerance * diagonal);
    largest = std::max(largest, off / diagonal);
  }
  char text[120];
  std::snprintf(text, sizeof text, "%zu of %zu triangles are off by up to %.2g of the diagonal",
                far, here.size(), largest);
  return far == 0 ? std::string() : text;
}

struct Comparison {
  std::string difference;  ///< empty: none
  std::string reader;      ///< "Assimp 5.2.4"
  double largest = 0;      ///< distance of a triangle to its like, of the diagonal
};

Comparison compare(const std::string& path) {
  ReadOptions options;
  options.fps = kFps;
  SilentProgress silent;
  PoseSequence ours;
  try {
    ours = read_gltf(path, options, silent).sequence;
  } catch (const Error&) {
    return {};  // what our reader refuses is held by other tests
  }
  try {
    const ReadResult theirs = read_with_assimp(path, options, silent);
    Comparison result{{}, theirs.read_through, 0};
    result.difference = difference(ours, theirs.sequence, result.largest);
    return result;
  } catch (const Error& error) {
    return {std::string("Assimp: ") + error.what(), {}, 0};
  }
}

/// Why the file is listed above; empty where it is not.
std::string known_reason(const fs::path& file) {
  for (const auto& [end, reason] : kKnownDifferences)
    if (file.generic_string().ends_with("/" + end)) return reason;
  return {};
}

/// The file is alike in both readers, or listed. Another Assimp may have learnt what is listed.
/// Returns its largest distance, where it is not listed.
double expect_alike_or_listed(const fs::path& file) {
  const Comparison found = compare(file.string());
  const std::string reason = known_reason(file);
  if (reason.empty()) {
    EXPECT_EQ(found.difference, "") << file;
    return found.largest;
  }
  if (found.reader.starts_with("Assimp 5.2")) {
    EXPECT_NE(found.difference, "") << file << " is listed (" << reason << ") and is alike";
  }
  return 0;
}

/// A skinned triangle on a joint that turns and grows, and one that two morph targets move.
std::string skinned_and_morphed() {
  GltfBuilder b;
  const std::string positions =
      std::to_string(b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const std::string joints =
      std::to_string(b.accessor<std::uint8_t>("VEC4", {0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}));
  const std::string weights =
      std::to_string(b.accessor<float>("VEC4", {1, 0, 0, 0, 0.25f, 0.75f, 0, 0, 1, 0, 0, 0}));
  const std::string first = std::to_string(b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 0, 0, 0, 0}));
  const std::string second = std::to_string(b.accessor<float>("VEC3", {0, 0, 0, 2, 0, 0, 0, 3, 0}));
  b.mesh("\"POSITION\": " + positions + ", \"JOINTS_0\": " + joints +
         ", \"WEIGHTS_0\": " + weights);
  b.mesh("\"POSITION\": " + positions,
         ", \"targets\": [{\"POSITION\": " + first + "}, {\"POSITION\": " + second + "}]");
  b.add("nodes", "{\"name\": \"skinned\", \"mesh\": 0, \"skin\": 0, \"translation\": [0, 0, 9]}");
  b.add("nodes", "{\"name\": \"hip\", \"translation\": [10, 0, 0], \"children\": [2]}");
  b.add("nodes", "{\"name\": \"knee\", \"translation\": [0, 5, 0]}");
  b.add("nodes", "{\"name\": \"morphed\", \"mesh\": 1, \"translation\": [0, 0, 4]}");
  const int inverse_binds =
      b.accessor<float>("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0,  1,  //
                                 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, -3, 1});
  b.add("skins",
        "{\"joints\": [1, 2], \"inverseBindMatrices\": " + std::to_string(inverse_binds) + "}");
  b.add("scenes", "{\"nodes\": [0, 1, 3]}");
  b.set("scene", "0");
  const int times = b.accessor<float>("SCALAR", {1, 2, 3});
  b.animation(2, "rotation", times,
              b.accessor<float>("VEC4", {0, 0, 0, 1, 0.6f, 0, 0, 0.8f, 0, 0.6f, 0, 0.8f}));
  b.animation(3, "weights", times, b.accessor<float>("SCALAR", {0, 0, 1, 0.5f, 0.25f, 1}));
  return b.glb();
}

class AssimpDifference : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_assimp()) GTEST_SKIP() << "Assimp was not there when this was built";
  }
};

TEST_F(AssimpDifference, SkinsAndMorphTargetsTakeTheSamePosesInBothReaders) {
  const TempFolder folder;
  write_text(folder.file("both.glb"), skinned_and_morphed());
  const Comparison found = compare(folder.file("both.glb"));
  EXPECT_THAT(found.reader, testing::StartsWith("Assimp"));
  EXPECT_EQ(found.difference, "");
}

TEST_F(AssimpDifference, OurOwnSamplesTakeTheSamePosesInBothReaders) {
  for (const char* name : {"hand.glb", "ball.glb"})
    expect_alike_or_listed(fs::path(MDK_SOURCE_DIR) / "assets" / name);
}

class AssimpDifferenceOfData : public SampleData {};

TEST_F(AssimpDifferenceOfData, FilesTakeTheSamePosesButForThoseAssimpIsKnownToMiss) {
  if (!has_assimp()) GTEST_SKIP() << "Assimp was not there when this was built";
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder_))
    if (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf")
      files.push_back(entry.path());
  std::ranges::sort(files);
  double largest = 0;
  for (const fs::path& file : files) largest = std::max(largest, expect_alike_or_listed(file));
  std::printf("%zu files, %.2g of the diagonal at most\n", files.size(), largest);
}

}  // namespace
}  // namespace mdk::test
