#include "tests/commands/program_run.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

extern char** environ;

namespace mdk::test {

ProgramRun::ProgramRun(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {MDPREP_PATH};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const std::string out = logs_.file("out"), err = logs_.file("err");
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT, 0600);
  write_text(err, "");
  const int failed = posix_spawn(&process_, MDPREP_PATH, &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("cannot start " MDPREP_PATH);
}

void ProgramRun::send_signal(int signal_number) const { kill(process_, signal_number); }

bool ProgramRun::maps(const std::string& path) const {
  std::ifstream list("/proc/" + std::to_string(process_) + "/maps");
  for (std::string line; std::getline(list, line);)
    if (line.ends_with(path)) return true;
  return false;
}

Outcome ProgramRun::wait() {
  int status = 0;
  waitpid(process_, &status, 0);
  Outcome outcome;
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  outcome.out = read_text(logs_.file("out"));
  outcome.err = read_text(logs_.file("err"));
  return outcome;
}

Outcome run_mdprep(const std::vector<std::string>& arguments) {
  return ProgramRun(arguments).wait();
}

bool is_one_sentence(const std::string& err) {
  return err.rfind("mdprep: ", 0) == 0 && std::count(err.begin(), err.end(), '\n') == 1 &&
         err.back() == '\n';
}

}  // namespace mdk::test
