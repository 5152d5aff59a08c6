#include "viewer/scene/scene_loader.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "common/base/parallel.h"
#include "formats/file_kind.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

/// A folder for one file that is mapped at once and need not have a name any longer.
class ScratchFolder {
 public:
  ScratchFolder() : path_((fs::temp_directory_path() / "mdview-XXXXXX").string()) {
    if (!::mkdtemp(path_.data()))
      throw Error(ErrorCode::kIo, path_ + ": cannot be made: " + std::strerror(errno));
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string file(const std::string& name) const { return (fs::path(path_) / name).string(); }

 private:
  std::string path_;
};

constexpr std::uint64_t kMostCopiedBytes = std::uint64_t{32} << 20;

/// A small file is copied first, so that what others write into it in place, by cp for instance,
/// pulls nothing away from under the picture. Large ones are mapped as they are.
std::shared_ptr<const MdkFile> open_baked(const std::string& path) {
  auto file = std::make_shared<const MdkFile>(path);  // errors name this one
  if (file->file_bytes() > kMostCopiedBytes) return file;
  try {
    const ScratchFolder folder;
    const std::string copy = folder.file(fs::path(path).filename().string());
    fs::copy_file(path, copy);
    return std::make_shared<const MdkFile>(copy);
  } catch (const Error&) {
  } catch (const fs::filesystem_error&) {
  }
  return file;  // where there is no room for a copy
}

}  // namespace

std::vector<SceneLoader::FileStamp> SceneLoader::stamps_of(const std::vector<std::string>& paths) {
  std::vector<FileStamp> stamps;
  for (const std::string& path : paths) {
    FileStamp stamp;
    std::error_code none;
    stamp.time = fs::last_write_time(path, none);
    stamp.bytes = fs::file_size(path, none);
    stamps.push_back(stamp);
  }
  return stamps;
}

void SceneLoader::load(std::vector<std::string> paths) {
  cancel();
  paths_ = std::move(paths);
  start(Reason::kAskedFor);
}

void SceneLoader::start(Reason reason) {
  stamps_ = stamps_of(paths_);
  cancelled_ = false;
  busy_ = true;
  thread_ = std::thread([this, paths = paths_, reason, threads = thread_count()] {
    const ThreadLimit limit(threads);
    run(paths, reason);
  });
}

void SceneLoader::cancel() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    if (process_) process_->kill();
  }
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(mutex_);
  loaded_.reset();
}

void SceneLoader::wait(double seconds) {
  std::unique_lock lock(mutex_);
  done_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return !busy_; });
}

std::optional<SceneLoader::Progress> SceneLoader::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::optional<LoadedScene> SceneLoader::take_loaded() {
  const std::lock_guard lock(mutex_);
  return std::exchange(loaded_, std::nullopt);
}

void SceneLoader::look_for_changes() {
  if (paths_.empty() || busy_ || stamps_of(paths_) == stamps_) return;
  if (thread_.joinable()) thread_.join();
  start(Reason::kChanged);
}

void SceneLoader::run(const std::vector<std::string>& paths, Reason reason) {
  LoadedScene scene;
  scene.path = paths.front();
  scene.is_again = reason == Reason::kChanged;
  try {
    scene.file = open(paths);
  } catch (const Error& error) {
    scene.error = error;
  } catch (const std::exception& error) {
    scene.error = Error(ErrorCode::kInternal, paths.front() + ": " + error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    process_.reset();
    progress_.reset();
    if (!cancelled_) loaded_ = std::move(scene);
    busy_ = false;
  }
  done_.notify_all();
  on_news_();
}

std::shared_ptr<const MdkFile> SceneLoader::open(const std::vector<std::string>& paths) {
  return paths.size() == 1 && file_kind(paths.front()) == FileKind::kBaked
             ? open_baked(paths.front())
             : bake(paths);
}

std::shared_ptr<const MdkFile> SceneLoader::bake(const std::vector<std::string>& paths) {
  const fs::path source(paths.front());
  const ScratchFolder folder;
  const std::string baked = folder.file(source.stem().string() + ".mdk");
  std::vector<std::string> arguments = {"-o", baked, "--"};
  arguments.insert(arguments.end(), paths.begin(), paths.end());
  const auto process = std::make_shared<MdprepProcess>("bake", arguments);
  {
    const std::lock_guard lock(mutex_);
    process_ = process;
    progress_ = Progress{source.filename().string(), {}};
    if (cancelled_) process->kill();
  }
  on_news_();
  while (auto news = process->next_progress()) {
    const std::lock_guard lock(mutex_);
    progress_->bake = *std::move(news);
    on_news_();
  }
  process->finish();
  return std::make_shared<const MdkFile>(baked);
}

}  // namespace mdk
