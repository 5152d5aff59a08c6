// Document: the file that is open: from the paths that are asked for into the view's state, again
// when it changes on disk, and, baked from a source, to a file of its own.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/scene/scene_loader.h"
#include "viewer/state/view_state.h"

namespace mdk {

class Document {
 public:
  /// `state` must outlive it. `on_news` is called from a thread of its own when update() has
  /// something to do.
  Document(ViewState& state, std::function<void()> on_news)
      : state_(state), loader_(std::move(on_news)) {}

  /// A .mdk file, the source files of one animation, or a folder, whose only animation is opened,
  /// or else a menu stands open with those it holds. Throws Error where it holds none.
  void open(const std::vector<std::string>& paths);
  /// What is on its way.
  void cancel() { loader_.cancel(); }
  bool busy() const { return loader_.busy(); }
  /// Until nothing is on its way, or `seconds` have passed.
  void wait(double seconds) { loader_.wait(seconds); }

  /// Puts what was loaded since the last call into the state: a file, with what belongs to another
  /// one reset, but neither camera nor settings. Returns it, or what went wrong, if there was any.
  std::optional<LoadedScene> update();
  /// At the files on disk, now and then.
  void look_for_changes(double now);

  /// Writes what was baked beside its source, unless something is there. Returns a sentence about
  /// it. Throws Error (kIo).
  std::string keep_baked() const;

 private:
  void enter(const LoadedScene& scene);

  ViewState& state_;
  double last_look_ = 0;
  SceneLoader loader_;
};

}  // namespace mdk
