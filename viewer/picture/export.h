// Export: what leaves the viewer: names for pictures, the mdprep command that makes one again, and
// a clip as numbered pictures or as a film, rendered by mdprep in the background.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "viewer/picture/render_worker.h"
#include "viewer/scene/mdprep_task.h"
#include "viewer/state/settings.h"

namespace mdk {

/// "hand-0001.png", or the first number that is free in the current folder. Throws Error (kIo)
/// where none is.
std::string free_picture_name(const std::string& stem);

/// "mdprep render walk.mdk -o walk.png --clip ... --camera ...", words quoted as a shell needs it:
/// the same pixels as the job's, to the last one. `path` is what is open: for a source file, the
/// .mdk beside it is named. `clip` and `time` (seconds) are what the job's moment stands for.
std::string render_command(const RenderJob& job, const std::string& path, const std::string& clip,
                           double time);

/// The options of "mdprep render" that say how: size, technique, shading, camera.
std::vector<std::string> render_options(const RenderJob& job);

/// In single quotes unless it is plain enough to stand alone.
std::string shell_word(const std::string& word);

/// Keys of the model, both inclusive.
struct KeyRange {
  std::uint32_t first = 0, last = 0;
};

/// The keys of a clip within [begin, end], in seconds from its start; the nearest one at least.
KeyRange keys_within(const ModelView& model, std::uint32_t clip, double begin, double end);

struct ExportOrder {
  RenderJob picture;  ///< how each is made; its moment does not count
  KeyRange keys;
  ExportKind kind = ExportKind::kPictures;
  std::string stem;  ///< what names begin with
};

/// How an export ended: a sentence for the user, or an error.
struct ExportResult {
  std::string sentence;
  std::optional<Error> error;
};

class SequenceExport {
 public:
  /// `on_news` is called from a thread of its own when progress() or take_result() have something
  /// new.
  explicit SequenceExport(std::function<void()> on_news)
      : task_(MdprepTask::Ending::kTidy, std::move(on_news)) {}

  /// Begins, unless one is in work: pictures go to a new folder "STEM-frames-0001", a film to a new
  /// "STEM-0001.mp4", both in the current folder.
  void start(ExportOrder order);
  /// Waits until nothing is left of what was begun.
  void cancel() { task_.cancel(); }
  bool busy() const { return task_.busy(); }

  /// Nothing where mdprep is not at work.
  std::optional<MdprepProgress> progress() const { return task_.progress(); }
  std::optional<ExportResult> take_result();

 private:
  std::string render(const ExportOrder& order);

  std::optional<ExportResult> result_;  // the task's while that is busy
  MdprepTask task_;
};

/// Whether films can be made here: ffmpeg is in the path.
bool can_export_films();

}  // namespace mdk
