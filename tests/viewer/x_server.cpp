#include "tests/viewer/x_server.h"

#include <poll.h>
#include <unistd.h>

#include <stdexcept>

namespace mdk::test {

XServer::XServer() {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("cannot make a pipe");
  ChildSetup setup;
  setup.command = {"Xvfb",      "-displayfd", std::to_string(ends[1]),
                   "-screen",   "0",          "1280x800x24",
                   "-nolisten", "tcp"};
  process_ = std::make_unique<ChildProcess>(setup, ends[1]);
  close(ends[1]);
  display_.assign(1, ':');
  char digit = 0;
  constexpr int kPatienceMs = 20000;
  pollfd ready{ends[0], POLLIN, 0};
  while (poll(&ready, 1, kPatienceMs) > 0 && read(ends[0], &digit, 1) == 1 && digit != '\n')
    display_ += digit;
  close(ends[0]);
  if (digit != '\n') throw std::runtime_error("Xvfb does not come up");
}

}  // namespace mdk::test
