#include "preprocess/cli/interrupt.h"

#include <csignal>

namespace mdk {
namespace {

// A signal handler can reach nothing but a variable of static storage.
volatile std::sig_atomic_t pending_signal = 0;

extern "C" void remember_signal(int signal_number) { pending_signal = signal_number; }

}  // namespace

void defer_interrupts() {
  struct sigaction action = {};
  action.sa_handler = remember_signal;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void throw_if_interrupted() {
  if (pending_signal != 0) throw Interrupted(pending_signal);
}

}  // namespace mdk
