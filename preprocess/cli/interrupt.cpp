#include "preprocess/cli/interrupt.h"

#include <atomic>
#include <csignal>

namespace mdk {
namespace {

// A signal handler can reach nothing but a variable of static storage.
std::atomic<int> pending_signal = 0;
static_assert(std::atomic<int>::is_always_lock_free);

extern "C" void remember_signal(int signal_number) { pending_signal = signal_number; }

}  // namespace

DeferredInterrupts::DeferredInterrupts() : loops_(throw_if_interrupted) {
  struct sigaction action = {};
  action.sa_handler = remember_signal;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void throw_if_interrupted() {
  if (const int signal_number = pending_signal) throw Interrupted(signal_number);
}

}  // namespace mdk
