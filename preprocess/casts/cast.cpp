#include "preprocess/casts/cast.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "formats/files/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

fs::path absolute_path(const std::string& path) { return fs::absolute(path).lexically_normal(); }

/// The names of a model's clips, for a message; the first few.
std::string clip_names(const ModelView& model) {
  constexpr std::size_t kShown = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(kShown, model.clips.size()); ++i)
    names += (i == 0 ? "" : ", ") + mdk::quoted(model.clips[i].name);
  return model.clips.size() > kShown ? names + ", …" : names;
}

}  // namespace

Error cast_error(const std::string& file, const CastPlace& place, const std::string& sentence) {
  if (place.line == 0) return bad_input(file, sentence);
  return bad_input(file, "line " + std::to_string(place.line) + ", column " +
                             std::to_string(place.column) + ": " + sentence);
}

SceneBuilder::SceneBuilder(const std::string& output)
    : folder_(absolute_path(output).parent_path().string()) {}

std::uint32_t SceneBuilder::model(const std::string& path) {
  const std::string whole = absolute_path(path).string();
  if (const auto found = by_path_.find(whole); found != by_path_.end()) return found->second;
  const auto index = static_cast<std::uint32_t>(opened_.size());
  opened_.push_back({path, std::make_unique<MdkFile>(path)});
  by_path_.emplace(whole, index);
  scene_.model_count = index + 1;
  return index;
}

std::uint32_t SceneBuilder::model_of_cast(const std::string& cast, const CastPlace& place,
                                          const std::string& name) {
  try {
    return model((fs::path(cast).parent_path() / name).string());
  } catch (const Error& error) {
    throw Error(error.code(), cast_error(cast, place, error.what()).what());
  }
}

std::vector<std::string> SceneBuilder::model_paths() const {
  std::vector<std::string> paths;
  for (const OpenModel& model : opened_) paths.push_back(model.path);
  return paths;
}

std::vector<SceneModelFile> SceneBuilder::model_files() const {
  std::vector<SceneModelFile> files;
  for (const OpenModel& model : opened_) {
    const std::string name = absolute_path(model.path).lexically_relative(folder_).generic_string();
    if (!is_utf8(name))
      throw bad_input(model.path, "a scene can only name files in UTF-8; rename the file");
    files.push_back({name, model.file->content_hash()});
  }
  return files;
}

std::string SceneBuilder::add_path(const std::vector<PathKey>& keys, PathEnds ends,
                                   std::uint32_t& path) {
  // A scene of this path alone, so that the fault is the same as ever.
  SceneStorage alone;
  alone.paths = {{0, static_cast<std::uint32_t>(keys.size()), ends}};
  alone.path_keys = keys;
  std::string fault = scene_fault(alone.view());
  if (!fault.empty()) {
    constexpr std::string_view kBefore = "path_keys: ";
    if (fault.starts_with(kBefore)) fault.erase(0, kBefore.size());
    return fault.replace(fault.find(" of path 0"), std::string_view(" of path 0").size(), "");
  }
  if (scene_.path_keys.size() + keys.size() > kMaxLinks)
    throw Error(ErrorCode::kOverLimit, "a scene may have no more than 2^32 - 1 keys of paths");
  path = static_cast<std::uint32_t>(scene_.paths.size());
  scene_.paths.push_back({static_cast<std::uint32_t>(scene_.path_keys.size()),
                          static_cast<std::uint32_t>(keys.size()), ends});
  scene_.path_keys.insert(scene_.path_keys.end(), keys.begin(), keys.end());
  return {};
}

std::string SceneBuilder::add(const Actor& actor) {
  const ModelView& model = view(actor.model);
  std::uint32_t clip = 0;
  if (actor.clip) {
    const auto found = std::ranges::find(model.clips, *actor.clip, &Clip::name);
    if (found == model.clips.end())
      return "the model has no clip " + mdk::quoted(*actor.clip) + "; it has " + clip_names(model);
    clip = static_cast<std::uint32_t>(found - model.clips.begin());
  }
  const auto role = roles_.try_emplace({actor.model, clip}, scene_.roles.size()).first->second;
  if (role == scene_.roles.size()) scene_.roles.push_back({actor.model, clip});
  if (!std::isfinite(actor.start) || !std::isfinite(static_cast<float>(actor.speed)))
    return "its start and its speed must be finite numbers";
  for (const auto& row : actor.map.m)
    for (const float entry : row)
      if (!(std::abs(entry) <= 0x1p60f)) return "its place or its scale is beyond 2^60";
  if (!(unevenness(actor.map) <= kMaxUnevenness))
    return "its transform is flat: a scale of 0, or scales by more than 2^16 apart";
  if (scene_.instances.size() >= kMaxCount)
    throw Error(ErrorCode::kOverLimit, "a scene may have no more than 2^30 - 1 instances");

  SceneInstance instance;
  instance.map = actor.map;
  instance.start = actor.start;
  instance.speed = static_cast<float>(actor.speed);
  instance.bits = SceneInstance::make_bits(role, actor.wrap, actor.path.has_value());
  SceneLabel label;
  label.id = actor.id.value_or(static_cast<std::int64_t>(scene_.instances.size()));
  label.mask = actor.mask;
  label.tint = actor.tint;
  label.path = actor.path.value_or(0);
  scene_.instances.push_back(instance);
  scene_.labels.push_back(label);
  return {};
}

const SceneStorage& SceneBuilder::finish() {
  if (scene_.instances.empty())
    throw Error(ErrorCode::kBadInput, "a scene needs at least one instance; the casts have none");
  double first = 0, last = 0;
  if (!scene_.path_keys.empty()) {
    first = std::ranges::min(scene_.path_keys, {}, &PathKey::time).time;
    last = std::ranges::max(scene_.path_keys, {}, &PathKey::time).time;
  } else {
    for (const SceneRole& role : scene_.roles)
      last = std::max(last, view(role.model).clip_seconds(view(role.model).clips[role.clip]));
  }
  scene_.first_time = first;
  scene_.last_time = last;
  return scene_;
}

Affine3f upright_map(const Vec3d& at, double heading, double scale, UpAxis up) {
  const double c = std::cos(heading) * scale, s = std::sin(heading) * scale;
  Affine3d map;
  if (up == UpAxis::kY)
    map = {{{c, 0, s, at.x}, {0, scale, 0, at.y}, {-s, 0, c, at.z}}};
  else
    map = {{{c, -s, 0, at.x}, {s, c, 0, at.y}, {0, 0, scale, at.z}}};
  return to_float(map);
}

void set_heading(double heading, UpAxis up, float (&rotation)[4]) {
  std::fill(rotation, rotation + 4, 0.0f);
  rotation[up == UpAxis::kY ? 1 : 2] = static_cast<float>(std::sin(heading / 2));
  rotation[3] = static_cast<float>(std::cos(heading / 2));
}

}  // namespace mdk
