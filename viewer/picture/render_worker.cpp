#include "viewer/picture/render_worker.h"

#include <exception>
#include <utility>

#include "common/trace/technique.h"

namespace mdk {

bool same_picture(const RenderJob& a, const RenderJob& b) {
  return a.file == b.file && a.technique == b.technique && a.request.at == b.request.at &&
         a.request.camera == b.request.camera && a.request.width == b.request.width &&
         a.request.height == b.request.height && a.request.shading == b.request.shading &&
         a.request.samples == b.request.samples &&
         a.request.occlusion_rays == b.request.occlusion_rays && a.pose == b.pose;
}

RenderWorker::RenderWorker(std::function<void()> on_finished)
    : on_finished_(std::move(on_finished)), thread_([this] { run(); }) {}

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
  return working_ || waiting_.has_value();
}

void RenderWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
    if (stopping_) return;
    RenderJob job = *std::exchange(waiting_, std::nullopt);
    working_ = true;
    lock.unlock();
    FinishedFrame frame = render(std::move(job));
    lock.lock();
    working_ = false;
    finished_ = std::move(frame);
    lock.unlock();
    on_finished_();
    lock.lock();
  }
}

FinishedFrame RenderWorker::render(RenderJob job) {
  FinishedFrame frame;
  try {
    const std::string_view id = technique_table()[job.technique].id;
    if (job.file != open_file_) {
      renderer_.reset();
      open_file_ = job.file;
    }
    if (!renderer_) renderer_ = std::make_unique<Renderer>(open_file_->model(), id);
    if (renderer_->technique_id() != id) renderer_->set_technique(id);
    FrameRequest request = job.request;
    request.pose = job.pose ? &*job.pose : nullptr;
    frame.stats = renderer_->render(request);
    frame.structure_bytes = renderer_->structure_bytes();
    frame.note = renderer_->technique_note();
    frame.heat = renderer_->heat_scale();
    const auto pixels = renderer_->pixels();
    frame.pixels.assign(pixels.begin(), pixels.end());
  } catch (const std::exception& failure) {
    frame.error = failure.what();
    renderer_.reset();  // whatever state it was left in
  }
  frame.job = std::move(job);
  return frame;
}

}  // namespace mdk
