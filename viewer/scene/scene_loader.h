// SceneLoader: from paths to an open model, on a thread of its own. Source files are baked first.
// What is open is loaded again when it changes on disk; what could not be opened is tried again
// when its files change, as if it were asked for anew.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "formats/mdk/mdk_file.h"
#include "viewer/scene/mdprep_task.h"

namespace mdk {

/// A model, or why there is none.
struct LoadedScene {
  std::shared_ptr<const MdkFile> file;  ///< null: there is an error
  std::optional<Error> error;
  std::vector<std::string> paths;  ///< what was asked for: the .mdk file or the source files
  bool is_again = false;           ///< it is what was open, and has changed on disk
};

class SceneLoader {
 public:
  /// `on_news` is called from the loader's thread when progress() or take_loaded() have something
  /// new.
  explicit SceneLoader(std::function<void()> on_news)
      : task_(MdprepTask::Ending::kAtOnce, std::move(on_news)) {}

  /// One .mdk file, or the source files of one animation (a mesh and its point cache). Cancels what
  /// is in work.
  void load(std::vector<std::string> paths);
  /// What was asked for and is not open is forgotten.
  void cancel();
  bool busy() const { return task_.busy(); }
  /// Until nothing is in work, or `seconds` have passed.
  void wait(double seconds) { task_.wait(seconds); }

  struct Progress {
    std::string name;  ///< of the source file, without its folders
    MdprepProgress bake;
  };
  /// Nothing where no bake is in work.
  std::optional<Progress> progress() const;
  /// What was loaded since the last call.
  std::optional<LoadedScene> take_loaded();

  /// Loads what has changed on disk since it was loaded last. Cheap: a few file times.
  void look_for_changes();

 private:
  struct FileStamp {
    std::filesystem::file_time_type time;
    std::uintmax_t bytes = 0;
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
  };
  /// Files as they were when loading them began.
  struct Source {
    std::vector<std::string> paths;
    std::vector<FileStamp> stamps;

    /// Whether they are others since the last call.
    bool take_change();
  };

  void start(const Source& source);
  std::shared_ptr<const MdkFile> open(const std::vector<std::string>& paths);
  std::shared_ptr<const MdkFile> bake(const std::vector<std::string>& paths);

  Source open_;   ///< what was opened last
  Source asked_;  ///< what is to take its place: in work, or failed
  std::string name_in_work_;
  std::optional<LoadedScene> loaded_;  // the task's while that is busy
  MdprepTask task_;
};

}  // namespace mdk
