// Casts: lists of who stands where in a scene and does what, in several formats (docs/scenes.md).
// SceneBuilder takes them one by one, whichever reader they come from.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.h"
#include "common/scene/scene.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mds/mds_file.h"
#include "formats/mds/writer.h"

namespace mdk {

enum class UpAxis { kY, kZ };

/// What files do not say.
struct CastOptions {
  std::vector<std::string> models;  ///< of those that name none: one, taken in turns
  std::string clip;                 ///< of those that name none; empty: each model's first
  std::optional<double> fps;        ///< of trajectories: frames a second
  UpAxis up = UpAxis::kY;
  double scale = 1;              ///< of those that say none
  std::optional<double> stride;  ///< metres a second that the clip walks at speed 1
};

/// Where something stands in a text, from 1; line 0: in the file as a whole.
struct CastPlace {
  std::uint64_t line = 0, column = 0;
};

/// "crowd.csv: line 3, column 7: no such model".
Error cast_error(const std::string& file, const CastPlace& place, const std::string& sentence);

/// One instance, before its clip is known by number.
struct Actor {
  std::uint32_t model = 0;            ///< of SceneBuilder::model()
  std::optional<std::string> clip;    ///< none: the model's first
  Affine3f map;                       ///< world_from_model, or path_from_model
  std::optional<std::uint32_t> path;  ///< of SceneBuilder::path()
  double start = 0, speed = 1;
  ClipWrap wrap = ClipWrap::kLoop;
  std::uint32_t tint = 0xffffffff, mask = 0xffffffff;
  std::optional<std::int64_t> id;  ///< none: how many there are before it
};

class SceneBuilder {
 public:
  /// Models are named by their way from the folder of `output`, a .mds to be.
  explicit SceneBuilder(const std::string& output);

  /// Opens a model, or finds it among those that are open. Throws Error: kIo, kBadInput.
  std::uint32_t model(const std::string& path);
  /// One that a cast names, at a place in it: errors name that place, too.
  std::uint32_t model_of_cast(const std::string& cast, const CastPlace& place,
                              const std::string& name);
  const ModelView& view(std::uint32_t model) const { return opened_[model].file->model(); }
  const std::string& model_path(std::uint32_t model) const { return opened_[model].path; }
  std::uint32_t model_count() const { return static_cast<std::uint32_t>(opened_.size()); }

  /// What is wrong with a path, as the end of a sentence, or nothing; then it is there.
  std::string add_path(const std::vector<PathKey>& keys, PathEnds ends, std::uint32_t& path);
  /// What is wrong with an instance, as a sentence, or nothing; then it is added.
  std::string add(const Actor& actor);

  std::size_t instance_count() const { return scene_.instances.size(); }
  std::vector<std::string> model_paths() const;

  /// Sets what a viewer plays: all of the paths, or else the longest clip once. The scene as it
  /// stands. Throws Error (kBadInput) where there are no instances.
  const SceneStorage& finish();
  /// Names and contents of the models.
  std::vector<SceneModelFile> model_files() const;

 private:
  struct OpenModel {
    std::string path;
    std::unique_ptr<MdkFile> file;
  };

  std::string folder_;
  std::vector<OpenModel> opened_;
  std::map<std::string, std::uint32_t> by_path_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> roles_;
  SceneStorage scene_;
};

// The readers: each adds all that one file holds. They throw Error: kIo, kBadInput with a sentence
// that names line and column. `notes`: sentences about what was left out or found.
void read_json_cast(const std::string& file, SceneBuilder& scene);
void read_csv_cast(const std::string& file, const CastOptions& options, SceneBuilder& scene);
void read_trajectories(const std::string& file, const CastOptions& options, SceneBuilder& scene,
                       std::vector<std::string>& notes);

/// world_from_model of something that stands at a place, turned about the up axis by `heading`
/// radians, counter-clockwise seen from above, and scaled.
Affine3f upright_map(const Vec3d& at, double heading, double scale, UpAxis up);
/// The same turn as a quaternion x, y, z, w.
void set_heading(double heading, UpAxis up, float (&rotation)[4]);

/// The speed over the ground, in lengths of the model a second, at which a clip that walks in place
/// would walk: that of vertices while they touch the ground. Nothing where none does for long, or
/// the clip stands still. Cost: O(keys * vertices).
std::optional<double> stride_speed(const ModelView& model, std::uint32_t clip, UpAxis up);

}  // namespace mdk
