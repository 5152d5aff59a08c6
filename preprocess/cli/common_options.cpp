#include "preprocess/cli/common_options.h"

#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

constexpr CountRange kThreadRange{1, 1024};

int parse_threads(const std::string& text) {
  if (text == "all") return 0;
  return static_cast<int>(parse_count("--threads", text, kThreadRange));
}

}  // namespace

void add_machine_options(CLI::App& command, MachineOptions& options) {
  command
      .add_option("--threads", options.threads,
                  "How many threads to use, 1 to 1024, or all (default: all).\n"
                  "Results do not depend on it.")
      ->type_name("all|N");
  std::string here;
  for (std::string_view isa : available_isas()) here += " " + std::string(isa);
  command
      .add_option("--isa", options.isa,
                  "Use no more than this instruction set (default: the best there is;\n"
                  "this machine has" +
                      here + ").")
      ->type_name("sse4|avx2|avx512|neon");
}

MachineLimits::MachineLimits(const MachineOptions& options)
    : threads_(parse_threads(options.threads)) {
  if (options.isa != "best") limit_isa(options.isa);
}

void add_message_options(CLI::App& command, MessageOptions& options) {
  command.add_flag("-q,--quiet", options.quiet, "No progress, no summary, no notes.");
  command
      .add_option("--progress", options.progress,
                  "auto: a bar where stderr is a terminal, plain lines otherwise;\n"
                  "always: a bar in any case; never: nothing (default: auto).")
      ->type_name("auto|always|never");
}

void add_verbose_option(CLI::App& command, MessageOptions& options) {
  command.add_flag("-v,--verbose", options.verbose, "Tell more on stderr.")->excludes("--quiet");
}

ProgressStyle progress_style(const MessageOptions& options) {
  const bool known =
      options.progress == "auto" || options.progress == "always" || options.progress == "never";
  if (!known)
    throw Error(ErrorCode::kUsage,
                "--progress " + options.progress + ": expected auto, always or never");
  if (options.quiet || options.progress == "never") return ProgressStyle::kNone;
  if (options.progress == "always" || isatty(STDERR_FILENO) != 0) return ProgressStyle::kBar;
  return ProgressStyle::kLines;
}

}  // namespace mdk
