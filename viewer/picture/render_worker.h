// RenderWorker: a thread that owns the Renderer, so that the panel never waits for a picture. One
// job waits at a time, the latest; one finished frame waits to be taken, the latest.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/trace/renderer.h"
#include "formats/mdk/mdk_file.h"
#include "viewer/state/clusters.h"
#include "viewer/state/costs.h"

namespace mdk {

/// What a job measures: a moment of the CostCurves of a clip.
struct SurveyMark {
  std::uint32_t clip = 0;
  std::size_t moment = 0;
};

/// A picture to make: of which file, how, of what.
struct RenderJob {
  std::shared_ptr<const MdkFile> file;
  std::size_t technique = 0;                 ///< row of technique_table()
  std::optional<std::size_t> against;        ///< another row: the same picture by that one as well
  std::shared_ptr<const PartialModel> part;  ///< what of the file to show; null: all
  FrameRequest request;                      ///< its pose stays null
  std::optional<SkeletonPose> pose;          ///< posed by hand: counts instead of request.at
  std::optional<SurveyMark> survey;          ///< not to be shown: measures for the cost curves
};

/// Whether both ask for the same pixels by the same technique; counting does not matter.
bool same_picture(const RenderJob& a, const RenderJob& b);

/// Whether nobody waits for `old` any more where `next` is asked for: another technique, file or
/// part of it, a coarser picture, or any picture in place of a measurement. Another moment or
/// camera is no reason: while these change without end, late pictures are better than none.
bool outdates(const RenderJob& next, const RenderJob& old);

/// What one technique made of a job.
struct TracedFrame : FrameReport {
  std::vector<std::uint32_t> pixels;  ///< sRGB RGBA, row 0 on top
};

struct FinishedFrame : TracedFrame {
  RenderJob job;
  std::vector<std::uint32_t> triangles;  ///< triangles_of() the picture
  std::string error;                     ///< a sentence where there is no picture, else empty
  std::optional<TracedFrame> second;     ///< of job.against
  PictureDifference difference;          ///< between the two
};

class RenderWorker {
 public:
  /// How long an outdated frame may go on: another one has to build its structures again.
  static constexpr double kPatienceSeconds = 0.2;

  /// `on_finished` is called from the worker's thread whenever a frame can be taken.
  explicit RenderWorker(std::function<void()> on_finished);
  /// Abandons the frame in work.
  ~RenderWorker();
  RenderWorker(const RenderWorker&) = delete;
  RenderWorker& operator=(const RenderWorker&) = delete;

  /// Starts the job when the current one is done, or outdated and late; takes the place of one that
  /// has not started.
  void request(RenderJob job);

  /// The latest frame that was finished and not yet taken. Never waits for one.
  std::optional<FinishedFrame> take_finished();

  /// Whether a job waits or is in work.
  bool busy() const;

 private:
  void run();
  /// None where it was abandoned.
  std::optional<FinishedFrame> render(RenderJob job);
  /// Ends loops over a frame that is to be abandoned.
  void check() const;
  /// They start again with the next frame, whatever state they were left in.
  void drop_renderers();
  /// By the renderer's own pose, so that both techniques of a comparison pay for one.
  TracedFrame trace(std::unique_ptr<Renderer>& renderer, const RenderJob& job,
                    std::size_t technique);

  std::function<void()> on_finished_;
  std::shared_ptr<const MdkFile> open_file_;  // the worker's own: what the renderers look at
  std::shared_ptr<const PartialModel> open_part_;
  std::unique_ptr<Renderer> renderer_, second_renderer_;
  Stopwatch since_begun_;  // the frame in work

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<RenderJob> waiting_, in_work_;
  std::optional<FinishedFrame> finished_;
  std::atomic<bool> stopping_ = false, outdated_ = false;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace mdk
