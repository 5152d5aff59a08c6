#include "viewer/app/document.h"

#include <filesystem>

#include "common/base/error.h"
#include "formats/files/atomic_file.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr double kLookSeconds = 0.5;  // between looks at the files on disk

}  // namespace

void Document::open(const std::vector<std::string>& paths) {
  std::error_code failure;
  const std::string& folder = paths.front();
  if (paths.size() != 1 || !fs::is_directory(folder, failure)) {
    loader_.load(paths);
    return;
  }
  std::vector<FileChoice> choices = animations_in(folder);
  if (choices.empty())
    throw Error(ErrorCode::kBadInput,
                folder + ": this folder holds no animation; opened are " + openable_extensions() +
                    ", and .obj or .ply with a point cache or one for each key");
  if (choices.size() == 1)
    loader_.load(choices.front().paths);
  else
    state_.file_menu = FileMenu{folder, std::move(choices), ""};
}

std::optional<LoadedScene> Document::update() {
  state_.baking = loader_.progress();
  auto scene = loader_.take_loaded();
  if (scene && scene->file) enter(*scene);
  return scene;
}

void Document::enter(const LoadedScene& scene) {
  state_.file = scene.file;
  state_.path = scene.paths.front();
  state_.file_name = fs::path(state_.path).filename().string();
  state_.frames = {};
  state_.error.clear();
  const ModelView& model = state_.file->model();
  state_.clusters = ClusterView(model);
  state_.picked.reset();
  state_.residuals = {};
  state_.hand = rest_pose_of(model);
  if (scene.is_again) {
    state_.playback.set_clips(clip_times(model));
    return;
  }
  Playback playback(clip_times(model));
  playback.set_loop(state_.playback.loop());
  playback.set_speed(state_.playback.speed());
  state_.playback = std::move(playback);
  remember_file(state_.recent_files, scene.paths);
}

void Document::look_for_changes(double now) {
  if (now < last_look_ + kLookSeconds) return;
  last_look_ = now;
  loader_.look_for_changes();
}

std::string Document::keep_baked() const {
  const std::string beside = fs::path(state_.path).replace_extension(".mdk").string();
  std::error_code ignored;
  if (fs::exists(beside, ignored)) return beside + " is there already";
  AtomicFile file(beside);
  file.write(state_.file->bytes());
  file.commit();
  return "Saved " + beside + "; it opens at once";
}

}  // namespace mdk
