#include "tests/common/random_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/motion/model_handle.h"
#include "tests/common/random_boxes.h"

namespace mdk::test {
namespace {

class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}

  double in(double lo, double hi) { return lo + random_.unit() * (hi - lo); }
  float between(double lo, double hi) { return static_cast<float>(in(lo, hi)); }
  std::uint32_t below(std::size_t count) {
    return static_cast<std::uint32_t>(random_.below(count));
  }
  Vec3f point(double reach) {
    return {between(-reach, reach), between(-reach, reach), between(-reach, reach)};
  }
  float log_between(double lo, double hi) {
    return static_cast<float>(std::exp(in(std::log(lo), std::log(hi))));
  }

 private:
  Random random_;
};

void set_rotation(Numbers& random, float (&q)[4]) {
  double square = 0, v[4];
  do {
    square = 0;
    for (double& x : v) {
      x = random.in(-1, 1);
      square += x * x;
    }
  } while (square > 1 || square < 0.01);
  for (int i = 0; i < 4; ++i) q[i] = static_cast<float>(v[i] / std::sqrt(square));
}

Affine3f random_map(Numbers& random, float reach) {
  Affine3f map;
  do {
    const float size = random.log_between(0.01, 100);
    for (auto& row : map.m)
      for (int j = 0; j < 3; ++j) row[j] = size * random.between(-1, 1);
  } while (unevenness(map) > 50);
  const Vec3f at = random.point(reach);
  for (int i = 0; i < 3; ++i) map.m[i][3] = at[static_cast<std::size_t>(i)];
  return map;
}

}  // namespace

Model random_points(std::uint32_t vertices, std::uint64_t seed) {
  Numbers random(seed);
  auto storage = std::make_shared<ModelStorage>();
  storage->vertex_count = vertices;
  storage->clips = {{"one", 0, 5}, {"two", 5, 9}, {"still", 14, 1}};
  for (const Clip& clip : storage->clips) {
    double time = random.below(2) == 0 ? 0 : random.in(0, 0.5);
    for (std::uint32_t k = 0; k < clip.key_count; ++k, time += random.in(0.01, 0.7))
      storage->key_times.push_back(time);
  }
  const Vec3f offset = random.point(20);
  std::vector<Vec3f> positions;
  for (std::size_t key = 0; key < storage->key_times.size(); ++key) {
    Aabb& box = storage->key_boxes.emplace_back();
    for (std::uint32_t v = 0; v < vertices; ++v) {
      positions.push_back(offset + random.point(3));
      box.extend(positions.back());
      storage->bounds.extend(positions.back());
    }
  }
  storage->poses.key_positions.assign(positions.begin(), positions.end());
  auto view = std::make_shared<const ModelView>(storage->view());
  return ModelHandle::make(
      *view,
      std::make_shared<std::pair<std::shared_ptr<ModelStorage>, std::shared_ptr<const ModelView>>>(
          storage, view));
}

SceneStorage random_scene(std::span<const Model> models, std::uint32_t instances, float reach,
                          std::uint64_t seed) {
  Numbers random(seed);
  SceneStorage scene;
  scene.model_count = static_cast<std::uint32_t>(models.size());
  scene.last_time = 60;
  for (std::uint32_t m = 0; m < scene.model_count; ++m)
    for (std::uint32_t clip = 0; clip < models[m].clip_count(); ++clip)
      scene.roles.push_back({m, clip});
  for (std::uint32_t i = 0; i < instances; ++i) {
    const bool has_path = random.below(2) == 0;
    SceneInstance instance;
    instance.map = random_map(random, has_path ? 1 : reach);
    instance.start = random.in(-100, 100);
    instance.speed = random.below(8) == 0 ? 0 : random.between(-4, 4);
    instance.bits = SceneInstance::make_bits(random.below(scene.roles.size()),
                                             static_cast<ClipWrap>(random.below(3)), has_path);
    SceneLabel label;
    label.id = 1000 + i;
    label.mask = 1 + random.below(3);
    if (has_path) {
      ScenePath path{static_cast<std::uint32_t>(scene.path_keys.size()), 1 + random.below(12),
                     static_cast<PathEnds>(random.below(3))};
      label.path = static_cast<std::uint32_t>(scene.paths.size());
      const Vec3f size{random.log_between(.1, 10), random.log_between(.1, 10),
                       -random.log_between(.1, 10)};
      PathKey key;
      key.time = random.in(0, 20);
      for (std::uint32_t k = 0; k < path.key_count; ++k, key.time += random.in(0.01, 6)) {
        key.translation = random.point(reach);
        set_rotation(random, key.rotation);
        key.scale = size * random.log_between(.5, 2);
        scene.path_keys.push_back(key);
      }
      scene.paths.push_back(path);
    }
    scene.instances.push_back(instance);
    scene.labels.push_back(label);
  }
  return scene;
}

}  // namespace mdk::test
