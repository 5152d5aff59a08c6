#include "viewer/picture/render_worker.h"

#include <exception>
#include <utility>

#include "common/base/parallel.h"
#include "common/trace/technique.h"
#include "viewer/picture/shown_picture.h"

namespace mdk {
namespace {

/// Thrown through the loops over a frame. Not an error: nobody waits for it.
struct Abandoned {};

}  // namespace

bool same_picture(const RenderJob& a, const RenderJob& b) {
  return a.file == b.file && a.technique == b.technique && a.against == b.against &&
         a.part == b.part && a.request.at == b.request.at && a.request.camera == b.request.camera &&
         a.request.width == b.request.width && a.request.height == b.request.height &&
         a.request.shading == b.request.shading && a.request.samples == b.request.samples &&
         a.request.occlusion_rays == b.request.occlusion_rays && a.pose == b.pose;
}

bool outdates(const RenderJob& next, const RenderJob& old) {
  const auto pixels = [](const RenderJob& job) {
    return std::uint64_t{job.request.width} * job.request.height;
  };
  return next.file != old.file || next.technique != old.technique || next.against != old.against ||
         next.part != old.part || pixels(next) < pixels(old) || (old.survey && !next.survey);
}

RenderWorker::RenderWorker(std::function<void()> on_finished)
    : on_finished_(std::move(on_finished)), thread_([this, threads = thread_count()] {
        const ThreadLimit limit(threads);
        run();
      }) {}

RenderWorker::~RenderWorker() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void RenderWorker::request(RenderJob job) {
  {
    const std::lock_guard lock(mutex_);
    outdated_ = in_work_ && outdates(job, *in_work_);
    waiting_ = std::move(job);
  }
  wake_.notify_one();
}

std::optional<FinishedFrame> RenderWorker::take_finished() {
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, std::nullopt);
}

bool RenderWorker::busy() const {
  const std::lock_guard lock(mutex_);
  return in_work_ || waiting_;
}

void RenderWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
    if (stopping_) return;
    in_work_ = std::exchange(waiting_, std::nullopt);
    outdated_ = false;
    lock.unlock();
    std::optional<FinishedFrame> frame = render(*in_work_);
    lock.lock();
    in_work_.reset();
    if (!frame) continue;
    finished_ = std::move(frame);
    lock.unlock();
    on_finished_();
    lock.lock();
  }
}

void RenderWorker::check() const {
  if (stopping_ || (outdated_ && since_begun_.seconds() > kPatienceSeconds)) throw Abandoned{};
}

std::optional<FinishedFrame> RenderWorker::render(RenderJob job) {
  since_begun_ = {};
  const LoopCheck checked([this] { check(); });
  FinishedFrame frame;
  try {
    if (job.file != open_file_ || job.part != open_part_) {
      drop_renderers();
      open_file_ = job.file;
      open_part_ = job.part;
    }
    static_cast<TracedFrame&>(frame) = trace(renderer_, job, job.technique);
    if (!job.survey) frame.triangles = triangles_of(renderer_->hits());
    if (job.against) {
      frame.second = trace(second_renderer_, job, *job.against);
      frame.difference = difference_of(
          {frame.pixels, frame.second->pixels, job.request.width, job.request.height});
    }
  } catch (const Abandoned&) {
    drop_renderers();
    return {};
  } catch (const std::exception& failure) {
    frame.error = failure.what();
    drop_renderers();
  }
  frame.job = std::move(job);
  return frame;
}

void RenderWorker::drop_renderers() {
  renderer_.reset();
  second_renderer_.reset();
}

TracedFrame RenderWorker::trace(std::unique_ptr<Renderer>& renderer, const RenderJob& job,
                                std::size_t technique) {
  const std::string_view id = technique_table()[technique].id;
  const ModelView& model = open_part_ ? open_part_->model() : open_file_->model();
  if (!renderer) renderer = std::make_unique<Renderer>(model, id);
  if (renderer->technique_id() != id) renderer->set_technique(id);
  FrameRequest request = job.request;
  request.pose = job.pose ? &*job.pose : nullptr;
  TracedFrame frame;
  frame.technique = technique;
  frame.width = request.width;
  frame.height = request.height;
  frame.camera = request.camera;
  frame.moment = {request.at, job.pose};
  frame.stats = renderer->render(request);
  frame.structure_bytes = renderer->structure_bytes();
  frame.note = renderer->technique_note();
  frame.heat = renderer->heat_scale();
  const auto pixels = renderer->pixels();
  frame.pixels.assign(pixels.begin(), pixels.end());
  return frame;
}

}  // namespace mdk
