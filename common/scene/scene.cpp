// What a scene may hold: checked once, for files and for scenes made by programs alike.
#include "common/scene/scene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>

#include "common/base/parallel.h"
#include "mdk/error.h"

namespace mdk {
namespace {

constexpr std::size_t kPerChunk = 4096;
constexpr double kMaxEntry = 0x1p60;

std::string number(std::uint64_t value) { return std::to_string(value); }

bool is_moderate(float value) { return std::abs(value) <= kMaxEntry; }  // not so for NaN

bool is_moderate(const Vec3f& v) {
  return is_moderate(v.x) && is_moderate(v.y) && is_moderate(v.z);
}

/// The largest row sum of the sizes of m^T m, of linear parts: the squared largest stretch is at
/// most that.
double squared_stretch(const Affine3d& m) {
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    for (int j = 0; j < 3; ++j) sum += std::abs(dot(m.column(i), m.column(j)));
    most = std::max(most, sum);
  }
  return most;
}

double scale_unevenness(const Vec3f& scale) {
  const auto [least, most] = std::minmax({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)});
  return static_cast<double>(most) / static_cast<double>(least);
}

/// The fault of the first item that has one, or nothing; `fault_of(i)` is called in parallel.
template <class FaultOf>
std::string first_fault(std::size_t count, const FaultOf& fault_of) {
  std::atomic<std::size_t> first = count;
  parallel_chunks(count, kPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && i < first; ++i) {
      if (fault_of(i) == nullptr) continue;
      std::size_t seen = first;
      while (i < seen && !first.compare_exchange_weak(seen, i)) {
      }
      return;
    }
  });
  return first == count ? std::string() : number(first) + fault_of(first);
}

const char* key_fault(const SceneView& scene, const ScenePath& path, std::size_t k) {
  const PathKey& key = scene.path_keys[k];
  const PathKey& before = scene.path_keys[k == path.first_key ? k : k - 1];
  if (!std::isfinite(key.time)) return " has a time that is not finite";
  if (k != path.first_key && !(key.time > before.time)) return " is not later than the one before";
  if (!is_moderate(key.translation)) return " is farther than 2^60 from the origin";
  double square = 0;
  for (const float q : key.rotation) square += static_cast<double>(q) * static_cast<double>(q);
  if (!(square >= 0.99 && square <= 1.01)) return " has a rotation that is not a unit quaternion";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float size = std::abs(key.scale[axis]);
    if (!(size >= 0x1p-60 && size <= 0x1p60)) return " has a scale beyond 2^-60 to 2^60";
    if (std::signbit(key.scale[axis]) != std::signbit(before.scale[axis]))
      return " has a scale of another sign than the one before";
  }
  if (scale_unevenness(key.scale) > kMaxUnevenness)
    return " scales the axes by more than 2^16 apart";
  return nullptr;
}

std::string path_fault(const SceneView& scene) {
  std::uint64_t next = 0;
  for (std::size_t p = 0; p < scene.paths.size(); ++p) {
    const ScenePath& path = scene.paths[p];
    if (path.first_key != next || path.key_count == 0 ||
        path.key_count > scene.path_keys.size() - next) {
      return "paths: path " + number(p) + " has not the keys that follow those of the one before";
    }
    if (path.ends > PathEnds::kLoop) return "paths: path " + number(p) + " ends in an unknown way";
    next += path.key_count;
  }
  if (next != scene.path_keys.size()) return "path_keys: there are more than the paths have";
  std::string fault;
  for (std::size_t p = 0; p < scene.paths.size() && fault.empty(); ++p) {
    const ScenePath& path = scene.paths[p];
    for (std::size_t k = path.first_key; k < std::size_t{path.first_key} + path.key_count; ++k)
      if (const char* const wrong = key_fault(scene, path, k))
        return "path_keys: key " + number(k - path.first_key) + " of path " + number(p) + wrong;
  }
  return fault;
}

}  // namespace

SceneView SceneStorage::view() const {
  SceneView scene;
  scene.model_count = model_count;
  scene.first_time = first_time;
  scene.last_time = last_time;
  for_each_array([](std::uint32_t, const char*, auto& to, const auto& from) { to = from; }, scene,
                 *this);
  return scene;
}

double unevenness(const Affine3f& map) {
  const Affine3d m = to_double(map);
  const double determinant = m.determinant();
  if (!(std::abs(determinant) > 0)) return std::numeric_limits<double>::infinity();
  const double ratio = std::sqrt(squared_stretch(m) * squared_stretch(inverse(m)));
  return std::isfinite(ratio) ? ratio : std::numeric_limits<double>::infinity();
}

std::string scene_fault(const SceneView& scene) {
  if (!(std::isfinite(scene.first_time) && std::isfinite(scene.last_time) &&
        scene.first_time <= scene.last_time))
    return "scene: its first and last time are no stretch of time";
  for (const std::uint64_t count : {scene.roles.size(), scene.instances.size(), scene.paths.size()})
    if (count > kMaxCount) return "scene: more than 2^30 - 1 roles, instances or paths";
  if (scene.path_keys.size() > kMaxLinks) return "path_keys: 2^32 or more";
  if (scene.roles.size() > SceneInstance::kMaxRoles) return "roles: more than 2^29";
  if (scene.labels.size() != scene.instances.size())
    return count_fault("labels", scene.labels.size(), scene.instances.size());
  for (std::size_t r = 0; r < scene.roles.size(); ++r)
    if (scene.roles[r].model >= scene.model_count)
      return "roles: role " + number(r) + " is of a model that does not exist";
  if (std::string fault = path_fault(scene); !fault.empty()) return fault;

  std::vector<double> path_unevenness;
  for (const ScenePath& path : scene.paths) {
    double most = 1;
    for (const PathKey& key : scene.keys_of(path))
      most = std::max(most, scale_unevenness(key.scale));
    path_unevenness.push_back(most);
  }
  const auto instance_fault = [&](std::size_t i) -> const char* {
    const SceneInstance& instance = scene.instances[i];
    const SceneLabel& label = scene.labels[i];
    if (instance.role() >= scene.roles.size()) return " has a role that does not exist";
    if (instance.wrap() > ClipWrap::kPingPong) return " wraps its clip in an unknown way";
    if (!std::isfinite(instance.start) || !std::isfinite(instance.speed))
      return " has a start or a speed that is not finite";
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        if (!is_moderate(instance.map.m[row][column]))
          return " has a map with an entry that is not finite, or beyond 2^60";
    double uneven = unevenness(instance.map);
    if (instance.has_path()) {
      if (label.path >= scene.paths.size()) return " is on a path that does not exist";
      uneven *= path_unevenness[label.path];
    } else if (label.path != 0) {
      return " has no path, and yet the number of one";
    }
    if (!(uneven <= kMaxUnevenness))
      return " is flat: its map has no inverse, or scales the axes by more than 2^16 apart";
    if (label.reserved != 0) return " has a reserved field that is not 0";
    return nullptr;
  };
  const std::string fault = first_fault(scene.instances.size(), instance_fault);
  return fault.empty() ? fault : "instances: instance " + fault;
}

std::string role_fault(const SceneView& scene, std::span<const Model> models) {
  if (models.size() != scene.model_count)
    return count_fault("models", models.size(), scene.model_count);
  for (std::size_t r = 0; r < scene.roles.size(); ++r) {
    const SceneRole& role = scene.roles[r];
    if (role.clip >= models[role.model].clip_count()) {
      return "roles: role " + number(r) + " plays clip " + number(role.clip) +
             " of a model that has " + number(models[role.model].clip_count());
    }
  }
  return {};
}

}  // namespace mdk
