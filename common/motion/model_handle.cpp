// The public Model: a view, what owns its memory, and checks of the numbers that programs pass.
#include "common/motion/model_handle.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/motion/posed_mesh.h"
#include "mdk/error.h"

namespace mdk {

struct Model::Data {
  std::shared_ptr<const void> owner;
  ModelView view;
};

namespace {

/// "clip 99 is not among the model's 2 clips".
void require_index(std::uint32_t index, std::size_t count, const std::string& noun) {
  if (index < count) return;
  throw Error(ErrorCode::kUsage, noun + " " + std::to_string(index) + " is not among the model's " +
                                     std::to_string(count) + " " + noun + "s");
}

}  // namespace

Model ModelHandle::make(const ModelView& view, std::shared_ptr<const void> owner) {
  return Model(std::make_shared<const Model::Data>(Model::Data{std::move(owner), view}));
}
const ModelView& ModelHandle::view(const Model& model) { return model.data_->view; }

Model::Model(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

std::uint32_t Model::vertex_count() const { return data_->view.vertex_count; }
std::uint32_t Model::triangle_count() const { return data_->view.triangle_count(); }
std::uint32_t Model::key_count() const { return data_->view.key_count(); }
std::uint32_t Model::clip_count() const {
  return static_cast<std::uint32_t>(data_->view.clips.size());
}

std::uint32_t Model::cluster_count() const { return data_->view.cluster_count(); }
std::uint32_t Model::material_count() const {
  return static_cast<std::uint32_t>(data_->view.appearance.materials.size());
}

std::array<float, 4> Model::material_color(std::uint32_t index) const {
  require_index(index, material_count(), "material");
  const float* color = data_->view.appearance.materials[index].base_color;
  return {color[0], color[1], color[2], color[3]};
}

ClipInfo Model::clip(std::uint32_t index) const {
  require_index(index, clip_count(), "clip");
  const Clip& clip = data_->view.clips[index];
  return {clip.name, data_->view.clip_seconds(clip), clip.first_key, clip.key_count};
}

std::optional<std::uint32_t> Model::find_clip(const std::string& name) const {
  const auto found = std::ranges::find(data_->view.clips, name, &Clip::name);
  if (found == data_->view.clips.end()) return {};
  return static_cast<std::uint32_t>(found - data_->view.clips.begin());
}

Aabb Model::bounds() const { return data_->view.bounds; }
Aabb Model::clip_bounds(std::uint32_t clip) const {
  require_index(clip, clip_count(), "clip");
  return mdk::clip_bounds(data_->view, clip);
}

KeyInterval Model::locate_time(std::uint32_t clip, double seconds) const {
  require_index(clip, clip_count(), "clip");
  if (!std::isfinite(seconds)) throw Error(ErrorCode::kUsage, "a time must be finite, in seconds");
  return mdk::locate_time(data_->view, clip, seconds);
}
KeyInterval Model::locate_time(std::uint32_t index, double seconds, ClipWrap wrap) const {
  require_index(index, clip_count(), "clip");
  if (!std::isfinite(seconds)) throw Error(ErrorCode::kUsage, "a time must be finite, in seconds");
  return mdk::locate_time(
      data_->view, index,
      wrapped_time(seconds, data_->view.clip_seconds(data_->view.clips[index]), wrap));
}
KeyInterval Model::at_key(std::uint32_t key) const {
  require_index(key, key_count(), "key");
  return mdk::at_key(key);
}

double Model::key_time(std::uint32_t key) const {
  require_index(key, key_count(), "key");
  return data_->view.key_times[key];
}

std::vector<Vec3f> Model::vertices(const KeyInterval& time) const {
  const ModelView& view = data_->view;
  if (!has_time(view, time))
    throw Error(ErrorCode::kUsage, "the time is none of the model's: keys " +
                                       std::to_string(time.key0) + " and " +
                                       std::to_string(time.key1));
  PosedMesh mesh(view);
  mesh.set_time(time);
  const auto positions = mesh.positions();
  return {positions.begin(), positions.end()};
}

std::array<std::uint32_t, 3> Model::triangle(std::uint32_t triangle) const {
  require_index(triangle, triangle_count(), "triangle");
  const Triangle& t = data_->view.triangles[triangle];
  return {t.v[0], t.v[1], t.v[2]};
}

std::uint32_t Model::source_triangle(std::uint32_t triangle) const {
  require_index(triangle, triangle_count(), "triangle");
  return data_->view.source_triangles[triangle];
}

}  // namespace mdk
