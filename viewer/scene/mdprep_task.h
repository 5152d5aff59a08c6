// MdprepTask: work on a thread of its own of which mdprep does the greater part, and which can be
// cancelled at any moment.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/base/error.h"
#include "viewer/scene/mdprep_process.h"

namespace mdk {

class MdprepTask {
 public:
  /// How a cancel ends mdprep: at once, or when it has taken away what it had begun to write.
  enum class Ending { kAtOnce, kTidy };

  /// `on_news` is called from the task's thread when progress() has changed or the work is done.
  MdprepTask(Ending ending, std::function<void()> on_news)
      : ending_(ending), on_news_(std::move(on_news)) {}
  /// Cancels.
  ~MdprepTask() { cancel(); }
  MdprepTask(const MdprepTask&) = delete;
  MdprepTask& operator=(const MdprepTask&) = delete;

  /// Starts `work`, which throws nothing; cancels what is in work. What it has written is there to
  /// read once busy() is false.
  void start(std::function<void()> work);
  /// Waits until nothing is in work.
  void cancel();
  bool busy() const { return busy_; }
  /// Until nothing is in work, or `seconds` have passed.
  void wait(double seconds);
  /// Nothing where mdprep is not at work.
  std::optional<MdprepProgress> progress() const;

  /// Thrown by run_mdprep() after a cancel.
  struct Cancelled {};
  /// For the work: until mdprep has done it. Throws Error with mdprep's own sentence.
  void run_mdprep(const std::string& subcommand, const std::vector<std::string>& arguments);

 private:
  void end(MdprepProcess& process) const;

  const Ending ending_;
  std::function<void()> on_news_;
  mutable std::mutex mutex_;  // of the next three
  std::shared_ptr<MdprepProcess> process_;
  std::optional<MdprepProgress> progress_;
  bool cancelled_ = false;
  std::atomic<bool> busy_ = false;
  std::condition_variable done_;  // with the mutex: no longer busy
  std::thread thread_;
};

/// What went wrong in `work`, if anything; an internal fault is said of `subject`.
std::optional<Error> error_of(const std::string& subject, const std::function<void()>& work);

}  // namespace mdk
