#include "tests/formats/mds/sample_scene.h"

#include <algorithm>
#include <cmath>

#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/formats/mdk/sample_model.h"

namespace mdk::test {

SceneStorage sample_scene() {
  SceneStorage scene;
  scene.model_count = 2;
  scene.last_time = 10;
  scene.roles = {{0, 0}, {0, 1}, {1, 0}};
  for (std::uint32_t i = 0; i < 5; ++i) {
    SceneInstance instance;
    instance.map.m[0][3] = static_cast<float>(i);
    instance.start = 0.25 * i;
    instance.speed = i == 1 ? -0.5f : 1.0f;
    instance.bits = SceneInstance::make_bits(i % 3, static_cast<ClipWrap>(i % 3), i == 1 || i >= 3);
    scene.instances.push_back(instance);
    SceneLabel label;
    label.id = 100 + i;
    label.path = i == 4 ? 1 : 0;
    scene.labels.push_back(label);
  }
  scene.paths = {{0, 3, PathEnds::kLoop}, {3, 2, PathEnds::kHide}};
  scene.path_keys = {{0, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}},
                     {2, {4, 0, 0}, {0, 0.6f, 0, 0.8f}, {1, 2, 1}},
                     {5, {4, 0, 4}, {0, -1, 0, 0}, {1, 1, 1}},
                     {1, {0, 0, 0}, {0, 0, 0, 1}, {1, 1, -1}},
                     {3, {0, 9, 0}, {0, 0, 0, 1}, {1, 1, -1}}};
  return scene;
}

std::vector<SceneModelFile> write_sample_models(const std::string& folder) {
  const auto write = [&](const ModelStorage& model, const std::string& name) {
    const std::string path = folder + "/" + name;
    write_mdk(model.view(), path);
    return SceneModelFile{name, MdkFile(path).content_hash()};
  };
  return {write(sample_model(), "a.mdk"), write(sample_rig_model(), "b.mdk")};
}

double walk_scene(const Stage& of_file) {
  SceneStorage copy;
  copy.model_count = of_file.scene().model_count;
  SceneView::for_each_array([](std::uint32_t, const char*, auto& to,
                               const auto& from) { to.assign(from.begin(), from.end()); },
                            copy, of_file.scene());
  const Stage stage(copy.view(), {of_file.models().begin(), of_file.models().end()});
  double digest = 0;
  const auto add_box = [&](const Aabb& box) {
    for (std::size_t axis = 0; axis < 3 && !box.empty(); ++axis)
      digest += static_cast<double>(box.hi[axis]) - static_cast<double>(box.lo[axis]);
  };
  for (std::uint32_t i = 0; i < std::min(stage.instance_count(), 8u); ++i) {
    for (const double time : {-1e18, -3.0, 0.0, 0.7, 2.0, 4.5, 9.0, 1e300}) {
      const KeyInterval at = stage.key_interval(i, time);
      digest += at.key0 + stage.clip_time(i, time) + stage.is_shown(i, time);
      digest += stage.model_from_world(i, time).m[0][0] + stage.unevenness(i);
      add_box(stage.box_at(i, time));
      add_box(stage.box_over(i, time, time + 1));
    }
    add_box(stage.box_always(i));
  }
  return digest;
}

}  // namespace mdk::test
