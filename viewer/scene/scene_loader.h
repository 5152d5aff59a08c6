// SceneLoader: from paths to an open model, on a thread of its own. Source files are baked first;
// a file that changes on disk is loaded again.
#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/error.h"
#include "formats/mdk_view.h"
#include "viewer/scene/mdprep_process.h"

namespace mdk {

/// A model, or why there is none.
struct LoadedScene {
  std::shared_ptr<const MdkFile> file;  ///< null: there is an error
  std::optional<Error> error;
  std::string path;       ///< what was asked for: the .mdk file or the first source file
  bool is_again = false;  ///< it was open before, and has changed on disk
};

class SceneLoader {
 public:
  /// `on_news` is called from the loader's thread when progress() or take_loaded() have something
  /// new.
  explicit SceneLoader(std::function<void()> on_news) : on_news_(std::move(on_news)) {}
  /// Cancels what is in work.
  ~SceneLoader() { cancel(); }
  SceneLoader(const SceneLoader&) = delete;
  SceneLoader& operator=(const SceneLoader&) = delete;

  /// One .mdk file, or the source files of one animation (a mesh and its point cache). Cancels what
  /// is in work.
  void load(std::vector<std::string> paths);
  void cancel();
  bool busy() const { return busy_; }
  /// Until nothing is in work, or `seconds` have passed.
  void wait(double seconds);

  struct Progress {
    std::string name;  ///< of the source file, without its folders
    MdprepProgress bake;
  };
  /// Nothing where no bake is in work.
  std::optional<Progress> progress() const;
  /// What was loaded since the last call.
  std::optional<LoadedScene> take_loaded();

  /// What was asked for last.
  const std::vector<std::string>& paths() const { return paths_; }

  /// Loads again what has changed on disk since it was loaded last. Cheap: a few file times.
  void look_for_changes();

 private:
  enum class Reason { kAskedFor, kChanged };
  struct FileStamp {
    std::filesystem::file_time_type time;
    std::uintmax_t bytes = 0;
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
  };

  void start(Reason reason);
  void run(const std::vector<std::string>& paths, Reason reason);
  std::shared_ptr<const MdkFile> open(const std::vector<std::string>& paths);
  std::shared_ptr<const MdkFile> bake(const std::vector<std::string>& paths);
  static std::vector<FileStamp> stamps_of(const std::vector<std::string>& paths);

  std::function<void()> on_news_;
  std::vector<std::string> paths_;
  std::vector<FileStamp> stamps_;

  mutable std::mutex mutex_;  // of the next four
  std::shared_ptr<MdprepProcess> process_;
  std::optional<Progress> progress_;
  std::optional<LoadedScene> loaded_;
  bool cancelled_ = false;
  std::atomic<bool> busy_ = false;
  std::condition_variable done_;  // with the mutex: no longer busy
  std::thread thread_;
};

}  // namespace mdk
