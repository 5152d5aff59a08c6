#include "viewer/scene/scene_loader.h"

#include <utility>

#include "formats/files/file_kind.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxCopiedBytes = std::uint64_t{32} << 20;

/// A small file is copied first, so that what others write into it in place, by cp for instance,
/// pulls nothing away from under the picture. Large ones are mapped as they are.
std::shared_ptr<const MdkFile> open_baked(const std::string& path) {
  auto file = std::make_shared<const MdkFile>(path);  // errors name this one
  if (file->file_bytes() > kMaxCopiedBytes) return file;
  try {
    const TemporaryFolder folder;
    const std::string copy = folder.file(fs::path(path).filename().string());
    fs::copy_file(path, copy);
    return std::make_shared<const MdkFile>(copy);
  } catch (const Error&) {
  } catch (const fs::filesystem_error&) {
  }
  return file;  // where there is no space for a copy
}

}  // namespace

bool SceneLoader::Source::take_change() {
  std::vector<FileStamp> now;
  for (const std::string& path : paths) {
    std::error_code none;
    now.push_back({fs::last_write_time(path, none), fs::file_size(path, none)});
  }
  return std::exchange(stamps, now) != now;
}

void SceneLoader::load(std::vector<std::string> paths) {
  cancel();
  asked_.paths = std::move(paths);
  asked_.take_change();
  if (asked_.paths == open_.paths) open_.stamps = asked_.stamps;
  start(asked_);
}

void SceneLoader::cancel() {
  task_.cancel();
  loaded_.reset();
  asked_ = {};
}

void SceneLoader::look_for_changes() {
  if (busy() || loaded_) return;
  if (open_.take_change()) {
    if (asked_.paths == open_.paths) asked_ = {};
    start(open_);
  } else if (asked_.take_change()) {
    start(asked_);
  }
}

void SceneLoader::start(const Source& source) {
  name_in_work_ = fs::path(source.paths.front()).filename().string();
  task_.start([this, paths = source.paths, is_again = &source == &open_] {
    LoadedScene scene{nullptr, {}, paths, is_again};
    try {
      scene.error = error_of(paths.front(), [&] { scene.file = open(paths); });
    } catch (const MdprepTask::Cancelled&) {
      return;
    }
    loaded_ = std::move(scene);
  });
}

std::optional<SceneLoader::Progress> SceneLoader::progress() const {
  const auto bake = task_.progress();
  return bake ? std::optional(Progress{name_in_work_, *bake}) : std::nullopt;
}

std::optional<LoadedScene> SceneLoader::take_loaded() {
  if (busy() || !loaded_) return {};
  if (loaded_->file && !loaded_->is_again) open_ = std::exchange(asked_, {});
  return std::exchange(loaded_, std::nullopt);
}

std::shared_ptr<const MdkFile> SceneLoader::open(const std::vector<std::string>& paths) {
  return paths.size() == 1 && file_kind(paths.front()) == FileKind::kBaked
             ? open_baked(paths.front())
             : bake(paths);
}

std::shared_ptr<const MdkFile> SceneLoader::bake(const std::vector<std::string>& paths) {
  const TemporaryFolder folder;
  const std::string baked = folder.file(fs::path(paths.front()).stem().string() + ".mdk");
  std::vector<std::string> arguments = {"-o", baked, "--"};
  arguments.insert(arguments.end(), paths.begin(), paths.end());
  task_.run_mdprep("bake", arguments);
  return std::make_shared<const MdkFile>(baked);
}

}  // namespace mdk
