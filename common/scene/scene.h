// SceneView: many instances of a few models, as spans: a place, a clip and a clock each. It owns
// nothing: the memory is a mapped .mds file (formats/mds) or a SceneStorage. Stage joins it with
// its models and tells where an instance is at a scene time, and boxes around it (docs/scenes.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/arrays.h"
#include "common/motion/model.h"
#include "mdk/model.h"
#include "mdk/scene.h"

namespace mdk {

/// A clip of a model that instances play. 8 bytes, as the file holds it.
struct SceneRole {
  std::uint32_t model = 0;  ///< among the scene's models
  std::uint32_t clip = 0;   ///< among the model's clips

  bool operator==(const SceneRole&) const = default;
};

/// Where an instance is and what time it has: all that a ray reads that enters it, in one cache
/// line. 64 bytes, as the file holds it.
struct SceneInstance {
  static constexpr std::uint32_t kRoleBits = 29, kMaxRoles = 1u << kRoleBits;

  /// Without a path: world_from_model. With one: path_from_model, applied before the path's
  /// transform.
  Affine3f map;
  double start = 0;        ///< clip time at scene time 0, seconds
  float speed = 1;         ///< clip seconds a scene second; 0 stands still, negative runs backwards
  std::uint32_t bits = 0;  ///< role in bits 0 to 28, wrap in 29 and 30, bit 31: it has a path

  std::uint32_t role() const { return bits & (kMaxRoles - 1); }
  ClipWrap wrap() const { return static_cast<ClipWrap>(bits >> kRoleBits & 3); }
  bool has_path() const { return (bits >> 31) != 0; }

  static std::uint32_t make_bits(std::uint32_t role, ClipWrap wrap, bool has_path) {
    return role | static_cast<std::uint32_t>(wrap) << kRoleBits |
           static_cast<std::uint32_t>(has_path) << 31;
  }
};
static_assert(sizeof(SceneInstance) == 64);

/// The rest of an instance. 24 bytes, as the file holds it.
struct SceneLabel {
  std::int64_t id = 0;              ///< the user's number
  std::uint32_t mask = 0xffffffff;  ///< a ray meets the instance where its own mask shares a bit
  std::uint32_t tint = 0xffffffff;  ///< linear RGBA, 8 bits each, red lowest: times the base colour
  std::uint32_t path = 0;           ///< of an instance that has one; else 0
  std::uint32_t reserved = 0;
};
static_assert(sizeof(SceneLabel) == 24);

/// Keys of a moving transform; several instances may share it. 12 bytes, as the file holds it.
struct ScenePath {
  std::uint32_t first_key = 0, key_count = 0;  ///< at least one
  PathEnds ends = PathEnds::kHold;
};
static_assert(sizeof(ScenePath) == 12);

/// p -> translation + rotation (scale p) at a scene time. Between two keys translation and scale
/// move linearly, and the rotation turns by the shorter way about one axis (slerp). 48 bytes, as
/// the file holds it.
struct PathKey {
  double time = 0;  ///< seconds of the scene, rising strictly along a path
  Vec3f translation;
  float rotation[4] = {0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  Vec3f scale{1, 1, 1};              ///< none 0; a component keeps its sign along a path
};
static_assert(sizeof(PathKey) == 48);

/// N instances. See ModelLists.
template <template <class> class List>
struct SceneLists {
  std::uint32_t model_count = 0;
  double first_time = 0, last_time = 0;  ///< what a viewer plays of the scene's clock

  List<SceneRole> roles;
  List<SceneInstance> instances;  ///< N
  List<SceneLabel> labels;        ///< N
  List<ScenePath> paths;
  List<PathKey> path_keys;

  /// Calls visit(four letters, name, the array of each scene), in file order.
  template <class Visit, class... Scenes>
  static void for_each_array(Visit&& visit, Scenes&... scenes) {
    visit(fourcc("ROLE"), "roles", scenes.roles...);
    visit(fourcc("INST"), "instances", scenes.instances...);
    visit(fourcc("LABL"), "labels", scenes.labels...);
    visit(fourcc("PATH"), "paths", scenes.paths...);
    visit(fourcc("PKEY"), "path_keys", scenes.path_keys...);
  }

  std::uint32_t instance_count() const { return static_cast<std::uint32_t>(instances.size()); }
};

struct SceneView : SceneLists<ConstSpan> {
  std::span<const PathKey> keys_of(const ScenePath& path) const {
    return path_keys.subspan(path.first_key, path.key_count);
  }
};

/// A scene that owns its memory.
struct SceneStorage : SceneLists<OwnedList> {
  /// Valid while this lives and is not changed.
  SceneView view() const;
};

/// What is wrong with a scene apart from its models: a sentence that begins with the name of an
/// array, or nothing. Cost: a pass over instances and keys, in parallel.
std::string scene_fault(const SceneView& scene);
/// The same for its roles, with the models at hand.
std::string role_fault(const SceneView& scene, std::span<const Model> models);
/// No less than the ratio of the largest to the smallest stretch of a linear part: 1 where a map
/// scales evenly. Infinite where it has no inverse.
double unevenness(const Affine3f& map);
/// The most that a map may have, with its path.
inline constexpr double kMaxUnevenness = 0x1p16;

/// A scene with its models: where instances are. Copies nothing; the scene's memory must outlive
/// it. All members may be called from many threads at once. Instances and times must be valid: an
/// index below N and a finite number.
///
/// The clock: clip time = start + speed * scene time in double, wrapped to the clip without error
/// (fmod), then located between keys. A clip lasts from 0 to its last key: a loop goes on smoothly
/// where its last pose is its first one.
///
/// The one agreed rounding of maps: world_from_model() is a map of floats, composed in double and
/// rounded once; model_from_world() is its inverse in double; points and vectors that are mapped by
/// it are rounded to float once (map_point, map_vector). The hit of an instance is what brute force
/// finds in its model, at its clip time, for the ray mapped like this: t stays the ray's own. Of
/// several instances the smallest t counts, ties to the lower instance, then the lower triangle.
/// Every technique gives these bits.
class Stage {
 public:
  /// Keeps the models. Throws Error (kBadInput) where a role is none of theirs. Cost: O(roles *
  /// keys).
  Stage(const SceneView& scene, std::vector<Model> models);

  const SceneView& scene() const { return scene_; }
  std::span<const Model> models() const { return models_; }
  std::uint32_t instance_count() const { return scene_.instance_count(); }
  const SceneRole& role(std::uint32_t i) const { return scene_.roles[scene_.instances[i].role()]; }
  const ModelView& model_of(std::uint32_t i) const {
    return *roles_[scene_.instances[i].role()].model;
  }
  bool is_moving(std::uint32_t i) const { return scene_.instances[i].has_path(); }

  /// False only outside of a path that hides: such an instance is not hit then.
  bool is_shown(std::uint32_t i, double time) const;
  /// Seconds in the clip, in [0, D].
  double clip_time(std::uint32_t i, double time) const;
  KeyInterval key_interval(std::uint32_t i, double time) const {
    const SceneRole& r = role(i);
    return locate_time(model_of(i), r.clip, clip_time(i, time));
  }

  Affine3f world_from_model(std::uint32_t i, double time) const;
  Affine3d model_from_world(std::uint32_t i, double time) const {
    return inverse(to_double(world_from_model(i, time)));
  }

  /// These hold every point world_from_model(v), in exact arithmetic, of the vertices as they are
  /// posed in float; empty where the instance is not shown. The world ray of a hit in the model
  /// passes within ray_slack() of them: they hold what rounding costs in the model, not what it
  /// costs on the way to it. Cost: O(1), of a path O(log keys).
  Aabb box_at(std::uint32_t i, double time) const;
  /// At every real time of a closed interval. Cost: O(keys of clip and path in the interval).
  Aabb box_over(std::uint32_t i, double from, double to) const;
  /// At all times. Cost: O(1), of a path O(its keys).
  Aabb box_always(std::uint32_t i) const;

  /// Of the instance's map at any time. Cost: O(1).
  double unevenness(std::uint32_t i) const;

 private:
  struct RoleFacts {
    const ModelView* model;
    double seconds;  ///< D
    Aabbd bounds;    ///< at all times of the clip, as posed in float
  };

  Aabbd model_box_over(std::uint32_t i, double from, double to) const;
  Aabb moving_box(const SceneInstance& instance, const ScenePath& path, const Aabbd& model_box,
                  double from, double to) const;
  const ScenePath& path_of(std::uint32_t i) const { return scene_.paths[scene_.labels[i].path]; }

  SceneView scene_;
  std::vector<Model> models_;
  std::vector<RoleFacts> roles_;
  std::vector<double> path_unevenness_;
};

/// What a key does, composed in double and rounded once.
Affine3f key_map(const PathKey& key);

inline Vec3f map_point(const Affine3d& model_from_world, const Vec3f& p) {
  return to_float(model_from_world.point(to_double(p)));
}
inline Vec3f map_vector(const Affine3d& model_from_world, const Vec3f& v) {
  return to_float(model_from_world.vector(to_double(v)));
}

/// How far, in the world, a hit of an instance may lie from the box that holds the instance, where
/// all of the box is within `reach` of the ray's origin: mapping rounds origin and direction once
/// each (common/scene/placement.cpp), and single rays count hits up to 2^-20 of their distance off.
inline double ray_slack(double unevenness, double reach) { return unevenness * reach * 0x1p-18; }

}  // namespace mdk
