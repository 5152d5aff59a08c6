#include "preprocess/cli/bench/setting.h"

#include <unistd.h>

#include <fstream>

namespace mdk {
namespace {

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "unknown processor";
}

}  // namespace

BenchMachine this_machine() {
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  return {processor_name(), cores > 0 ? static_cast<int>(cores) : 1};
}

BenchProgram this_program(const std::string& commit) { return {MDK_VERSION, commit, MDK_COMPILER}; }

}  // namespace mdk
