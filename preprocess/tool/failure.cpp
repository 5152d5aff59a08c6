#include "preprocess/tool/failure.h"

#include <atomic>
#include <csignal>
#include <new>

#include "common/base/error.h"
#include "common/base/text.h"

namespace mdk {
namespace {

// A signal handler can reach nothing but a variable of static storage.
std::atomic<int> pending_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void remember_signal(int signal_number) { pending_signal = signal_number; }

}  // namespace

LoopCheck Interrupts::defer() {
  struct sigaction action = {};
  action.sa_handler = remember_signal;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return LoopCheck([] {
    if (const int signal_number = pending_signal) throw Interrupted(signal_number);
  });
}

Failure describe_failure(const std::exception_ptr& thrown) {
  constexpr const char* kPleaseReport = "internal fault, please report it: ";
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    return {error.exit_status(), printable_line(error.what())};
  } catch (const Interrupted& interrupted) {
    return {interrupted.exit_status(), "interrupted; no file was left half-written"};
  } catch (const std::bad_alloc&) {
    return {static_cast<int>(ErrorCode::kOverLimit),
            "not enough memory, the machine's or what --memory-limit allows; allow more, or try a "
            "smaller input, fewer clips or a smaller picture"};
  } catch (const std::exception& fault) {
    return {static_cast<int>(ErrorCode::kInternal), std::string(kPleaseReport) + fault.what()};
  } catch (...) {
    return {static_cast<int>(ErrorCode::kInternal), std::string(kPleaseReport) + "unknown"};
  }
}

}  // namespace mdk
