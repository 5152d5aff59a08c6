// The same promise on files: any .mdk, seen from random places at random times.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <sstream>
#include <string>

#include "common/trace/renderer.h"
#include "formats/mdk/mdk_file.h"

namespace mdk {
namespace {

constexpr std::uint32_t kSeed = 5;

/// Views of a mesh as no one would choose them, each kind in turn.
class RandomViews {
 public:
  explicit RandomViews(const ModelView& model) : model_(model) {}

  FrameRequest next() {
    FrameRequest request;
    request.width = 100;
    request.height = 84;
    request.at = moment();
    const Aabb& bounds = model_.bounds;
    const float size = std::max(diagonal(bounds), 1e-12f);
    request.camera = fit_camera(bounds, 1.0);
    Camera& camera = request.camera;
    const Vec3f inside = point_inside();
    switch (turn_++ % 6) {
      case 0:  // from anywhere around
        camera.eye = bounds.center() + direction() * (size * between(0.6f, 3));
        camera.target = inside;
        break;
      case 1:  // from inside
        camera.eye = inside;
        camera.target = inside + direction() * size;
        camera.vertical_fov_deg = between(30, 140);
        break;
      case 2:  // through a keyhole
        camera.eye = bounds.center() + direction() * size;
        camera.target = inside;
        camera.vertical_fov_deg = between(0.2f, 4);
        break;
      case 3: {  // along a side of the bounds, as near as can be
        Vec3f along = direction();
        along[turn_ % 3] = 0;
        camera.eye = inside - along * size;
        camera.eye[turn_ % 3] = turn_ % 2 == 0 ? bounds.lo[turn_ % 3] : bounds.hi[turn_ % 3];
        camera.target = camera.eye + along * size;
        break;
      }
      case 4:  // from so far that coordinates hardly tell pixels apart
        camera.eye = bounds.center() + direction() * (size * between(300, 3000));
        camera.target = inside;
        camera.vertical_fov_deg = between(0.02f, 0.1f);
        break;
      default: {  // from a vertex, or its neighbourhood
        PosedMesh mesh(model_);
        mesh.set_time(request.at);
        const Vec3f& vertex = mesh.positions()[random_() % model_.vertex_count];
        camera.eye = vertex + direction() * (size * (turn_ % 12 < 6 ? 0.0f : 1e-4f));
        camera.target = camera.eye + direction() * size;
      }
    }
    camera.up = direction();
    return request;
  }

 private:
  float between(float lo, float hi) {
    return std::uniform_real_distribution<float>(lo, hi)(random_);
  }
  Vec3f direction() {
    for (;;) {
      const Vec3f v{between(-1, 1), between(-1, 1), between(-1, 1)};
      if (dot(v, v) > 0.01f && dot(v, v) <= 1) return normalized(v);
    }
  }
  Vec3f point_inside() {
    const Aabb& b = model_.bounds;
    return {between(b.lo.x, b.hi.x), between(b.lo.y, b.hi.y), between(b.lo.z, b.hi.z)};
  }
  KeyInterval moment() {
    if (random_() % 3 == 0)
      return at_key(static_cast<std::uint32_t>(random_() % model_.key_count()));
    const auto clip = static_cast<std::uint32_t>(random_() % model_.clips.size());
    const double seconds = model_.clip_seconds(model_.clips[clip]);
    return locate_time(model_, clip,
                       std::uniform_real_distribution<double>(0, 1)(random_) * seconds);
  }

  const ModelView& model_;
  std::mt19937 random_{kSeed};
  unsigned turn_ = 0;
};

TEST(FileAgreement, EveryTechniqueOfOursGivesBruteForcesHitsFromRandomPlaces) {
  const char* files = std::getenv("MDK_AGREEMENT_FILES");
  if (files == nullptr) GTEST_SKIP() << "MDK_AGREEMENT_FILES names no files (a.mdk:b.mdk)";
  const char* count = std::getenv("MDK_AGREEMENT_VIEWS");
  const int views = count == nullptr ? 24 : std::atoi(count);
  std::istringstream list(files);
  for (std::string path; std::getline(list, path, ':');) {
    const MdkFile file(path);
    RandomViews random(file.model());
    Renderer oracle(file.model(), "brute-force"), renderer(file.model(), "brute-force");
    std::uint64_t hits = 0;
    for (int view = 0; view < views; ++view) {
      const FrameRequest request = random.next();
      hits += oracle.trace(request).hits;
      for (const TechniqueInfo& technique : technique_table()) {
        if (technique.kind == TechniqueKind::kPeer || technique.kind == TechniqueKind::kOracle)
          continue;
        renderer.set_technique(technique.id);
        renderer.trace(request);
        EXPECT_EQ(count_mismatches(renderer.hits(), oracle.hits()), 0u)
            << path << ", " << technique.id << ", view " << view << ", seed " << kSeed;
      }
    }
    std::cout << path << ": " << views << " views, " << hits << " hits\n";
  }
}

}  // namespace
}  // namespace mdk
