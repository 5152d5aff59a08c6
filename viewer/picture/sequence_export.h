// SequenceExport: a clip or part of it as numbered pictures or as a film, rendered by mdprep in the
// background while the viewer goes on.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/base/error.h"
#include "viewer/picture/render_worker.h"
#include "viewer/scene/mdprep_process.h"
#include "viewer/state/view_state.h"

namespace mdk {

/// Keys of the model, both inclusive.
struct KeyRange {
  std::uint32_t first = 0, last = 0;
};

/// The keys of a clip within [begin, end], in seconds from its start; the nearest one at least.
KeyRange keys_within(const Model& model, std::uint32_t clip, double begin, double end);

struct ExportOrder {
  RenderJob picture;  ///< how each is made; its moment does not count
  KeyRange keys;
  ExportKind kind = ExportKind::kPictures;
  std::string stem;  ///< what names begin with
};

/// How an export ended: a sentence for the user, or an error. Neither after a cancel.
struct ExportResult {
  std::string sentence;
  std::optional<Error> error;
};

class SequenceExport {
 public:
  /// `on_news` is called from a thread of its own when progress() or take_result() have something
  /// new.
  explicit SequenceExport(std::function<void()> on_news) : on_news_(std::move(on_news)) {}
  /// Cancels.
  ~SequenceExport() { cancel(); }
  SequenceExport(const SequenceExport&) = delete;
  SequenceExport& operator=(const SequenceExport&) = delete;

  /// Begins, unless one is in work: pictures go to a new folder "STEM-frames-0001", a film to a new
  /// "STEM-0001.mp4", both in the present folder.
  void start(ExportOrder order);
  /// Waits until nothing is left of what was begun.
  void cancel();
  bool busy() const { return busy_; }

  /// Nothing where no export is in work.
  std::optional<MdprepProgress> progress() const;
  std::optional<ExportResult> take_result();

 private:
  void run(const ExportOrder& order);
  std::string render(const ExportOrder& order);
  void wait_for(const std::vector<std::string>& arguments);

  std::function<void()> on_news_;
  mutable std::mutex mutex_;  // of the next four
  std::shared_ptr<MdprepProcess> process_;
  std::optional<MdprepProgress> progress_;
  std::optional<ExportResult> result_;
  bool cancelled_ = false;
  std::atomic<bool> busy_ = false;
  std::thread thread_;
};

/// Whether films can be made here: ffmpeg is in the path.
bool can_export_films();

}  // namespace mdk
