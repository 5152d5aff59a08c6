#include "viewer/scene/mdprep_task.h"

#include <chrono>
#include <exception>
#include <utility>

#include "common/base/parallel.h"

namespace mdk {

void MdprepTask::start(std::function<void()> work) {
  cancel();
  cancelled_ = false;
  busy_ = true;
  thread_ = std::thread([this, work = std::move(work), threads = thread_count()] {
    const ThreadLimit limit(threads);
    work();
    {
      const std::lock_guard lock(mutex_);
      process_.reset();
      progress_.reset();
      busy_ = false;
    }
    done_.notify_all();
    on_news_();
  });
}

void MdprepTask::cancel() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    if (process_) end(*process_);
  }
  if (thread_.joinable()) thread_.join();
}

void MdprepTask::end(MdprepProcess& process) const {
  ending_ == Ending::kAtOnce ? process.kill() : process.stop();
}

void MdprepTask::wait(double seconds) {
  std::unique_lock lock(mutex_);
  done_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return !busy_; });
}

std::optional<MdprepProgress> MdprepTask::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

void MdprepTask::run_mdprep(const std::string& subcommand,
                            const std::vector<std::string>& arguments) {
  const auto process = std::make_shared<MdprepProcess>(subcommand, arguments);
  std::optional<MdprepProgress> news = MdprepProgress{};
  do {
    {
      const std::lock_guard lock(mutex_);
      process_ = process;
      progress_ = std::exchange(news, std::nullopt);
      if (cancelled_) end(*process);
    }
    on_news_();
  } while ((news = process->next_progress()));
  try {
    process->finish();
  } catch (const Error&) {
    const std::lock_guard lock(mutex_);
    if (cancelled_) throw Cancelled{};
    throw;
  }
}

std::optional<Error> error_of(const std::string& subject, const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  } catch (const std::exception& fault) {
    return Error(ErrorCode::kInternal, subject + ": " + fault.what());
  }
  return {};
}

}  // namespace mdk
