// No ray leaves a closed mesh unseen: eyes inside look through keyholes and wide angles at places
// where clusters meet, at random times. A hundred thousand rays here; more with
//
//     MDK_LEAK_RAYS=10000000 MDK_LEAK_FILES=hand.mdk:cow.mdk agreement_tests --gtest_filter='Leak*'
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>

#include "common/trace/renderer.h"
#include "formats/mdk/mdk_file.h"
#include "preprocess/pipeline.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

constexpr std::uint32_t kSide = 64;
constexpr std::uint32_t kSeed = 20061;

std::uint64_t ray_count() {
  const char* text = std::getenv("MDK_LEAK_RAYS");
  return text == nullptr ? 100'000 : std::strtoull(text, nullptr, 10);
}

/// What the generalised winding number is at a point: 1 inside a closed mesh, 0 outside.
double winding_number(const PosedMesh& mesh, const Vec3d& eye) {
  double sum = 0;
  for (const Triangle& triangle : mesh.model().triangles) {
    Vec3d v[3];
    double size[3];
    for (int k = 0; k < 3; ++k) {
      v[k] = to_double(mesh.positions()[triangle.v[k]]) - eye;
      size[k] = length(v[k]);
    }
    const double below = size[0] * size[1] * size[2] + dot(v[0], v[1]) * size[2] +
                         dot(v[1], v[2]) * size[0] + dot(v[2], v[0]) * size[1];
    sum += std::atan2(dot(v[0], cross(v[1], v[2])), below);
  }
  return sum / (2 * std::numbers::pi);
}

/// Whether every edge has two triangles that pass it in opposite directions. Vertices that stand at
/// one place count as one.
bool is_closed(const PosedMesh& mesh) {
  std::map<std::array<float, 3>, std::uint32_t> places;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  const auto place = [&](std::uint32_t v) {
    const Vec3f& p = mesh.positions()[v];
    return places.emplace(std::array{p.x, p.y, p.z}, places.size()).first->second;
  };
  for (const Triangle& t : mesh.model().triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = place(t.v[k]), b = place(t.v[(k + 1) % 3]);
      if (a != b) balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  return std::ranges::all_of(balance, [](const auto& edge) { return edge.second == 0; });
}

/// Vertices that several clusters share; all where there are none.
std::vector<std::uint32_t> border_vertices(const ModelView& model) {
  std::vector<std::uint32_t> owner(model.vertex_count, model.cluster_count()), border;
  std::vector<char> shared(model.vertex_count, 0);
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c)
    for (const Triangle& t : model.triangles.subspan(model.clusters[c].first_triangle,
                                                     model.clusters[c].triangle_count))
      for (const std::uint32_t v : t.v) {
        shared[v] |= owner[v] != model.cluster_count() && owner[v] != c;
        owner[v] = c;
      }
  for (std::uint32_t v = 0; v < model.vertex_count; ++v)
    if (shared[v]) border.push_back(v);
  if (border.empty())
    for (std::uint32_t v = 0; v < model.vertex_count; ++v) border.push_back(v);
  return border;
}

class LeakHunt {
 public:
  explicit LeakHunt(const ModelView& model) : model_(model), border_(border_vertices(model)) {}

  /// Shoots `rays` rays from inside, divided among the techniques; how many hit nothing.
  std::uint64_t leaks(std::uint64_t rays) {
    static constexpr std::string_view kTechniques[] = {"fuzzy-bvh", "fuzzy-kdtree", "decomp-refit"};
    Renderer renderer(model_, kTechniques[0]);
    std::uint64_t missed = 0, shot = 0;
    for (std::size_t image = 0; shot < rays; ++image) {
      FrameRequest request;
      request.width = request.height = kSide;
      if (!choose_view(request)) continue;
      renderer.set_technique(kTechniques[image % std::size(kTechniques)]);
      const FrameStats stats = renderer.trace(request);
      shot += stats.rays;
      missed += stats.rays - stats.hits;
    }
    return missed;
  }

 private:
  double uniform(double lo, double hi) {
    return std::uniform_real_distribution<double>(lo, hi)(random_);
  }

  /// A moment, an eye inside and a border vertex to look at; false where the eye is not inside.
  bool choose_view(FrameRequest& request) {
    const auto clip = static_cast<std::uint32_t>(random_() % model_.clips.size());
    request.at = locate_time(model_, clip, uniform(0, model_.clip_seconds(model_.clips[clip])));
    PosedMesh mesh(model_);
    mesh.set_time(request.at);
    const Vec3f target = mesh.positions()[border_[random_() % border_.size()]];
    const auto reach = static_cast<float>(uniform(0.01, 0.1)) * diagonal(model_.bounds);
    const auto any = [&] { return static_cast<float>(uniform(-1, 1)) * reach; };
    request.camera.eye = target + Vec3f{any(), any(), any()};
    request.camera.target = target;
    request.camera.up = {any(), any(), any()};
    static constexpr float kFields[] = {0.02f, 0.5f, 10, 150};
    request.camera.vertical_fov_deg = kFields[random_() % std::size(kFields)];
    return std::abs(winding_number(mesh, to_double(request.camera.eye)) - 1) < 1e-3;
  }

  const ModelView& model_;
  std::vector<std::uint32_t> border_;
  std::mt19937 random_{kSeed};
};

void expect_no_leaks(const ModelView& model, const std::string& name) {
  PosedMesh mesh(model);
  mesh.set_time(at_key(model.rest_key));
  if (!is_closed(mesh)) {
    std::cout << name << " is not closed, and left out\n";
    return;
  }
  const std::uint64_t rays = ray_count();
  EXPECT_EQ(LeakHunt(model).leaks(rays), 0u) << name << ", seed " << kSeed;
  std::cout << name << ": " << rays << " rays, " << model.cluster_count() << " clusters\n";
}

TEST(Leaks, NoRayLeavesAClosedMeshInMotion) {
  SilentProgress silent;
  DecomposeOptions options;
  options.clusters = 8;
  const test::NamedSequence scenes[] = {{"tube", test::bending_tube(60, 32, 8)},
                                        {"sphere", test::twisting_sphere(4, 8)}};
  for (const auto& [name, sequence] : scenes) {
    const DecomposeResult baked = decompose(sequence, options, silent);
    EXPECT_GT(baked.model.clusters.size(), 3u) << name;
    const ModelView model = baked.model.view();
    PosedMesh mesh(model);
    mesh.set_time(at_key(0));
    EXPECT_TRUE(is_closed(mesh)) << name;
    expect_no_leaks(model, name);
  }
}

TEST(Leaks, NoRayLeavesTheClosedMeshesOfFiles) {
  const char* files = std::getenv("MDK_LEAK_FILES");
  if (files == nullptr) GTEST_SKIP() << "MDK_LEAK_FILES names no files";
  std::istringstream list(files);
  for (std::string path; std::getline(list, path, ':');) {
    const MdkFile file(path);
    expect_no_leaks(file.model(), path);
  }
}

}  // namespace
}  // namespace mdk
