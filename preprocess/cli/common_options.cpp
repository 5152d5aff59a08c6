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
  command
      .add_option("--isa", options.isa,
                  "Use no more than this instruction set (default: the best there is). One that\n"
                  "this machine lacks is refused.")
      ->type_name("sse4|avx2|avx512|neon");
  command
      .add_option("--memory-limit", options.memory_limit,
                  "Give up with status 5 rather than use more memory than this, as in 512M or\n"
                  "1.5G (default: none).")
      ->type_name("none|SIZE");
}

MachineLimits::MachineLimits(const MachineOptions& options)
    : threads_(parse_threads(options.threads)), memory_(options.memory_limit) {
  if (options.isa != "best") limit_isa(options.isa);
}

void add_message_options(CLI::App& command, MessageOptions& options) {
  command.add_flag("-q,--quiet", options.quiet, "No progress, no summary, no notes.");
  command
      .add_option(
          "--progress", options.progress,
          "auto: a bar where stderr is a terminal, plain lines otherwise; always: a bar in\n"
          "any case; plain: lines in any case, as logs want them; never: nothing\n"
          "(default: auto).")
      ->type_name("auto|always|plain|never");
}

void add_verbose_option(CLI::App& command, MessageOptions& options) {
  command.add_flag("-v,--verbose", options.verbose, "Tell more on stderr.")->excludes("--quiet");
}

ProgressStyle progress_style(const MessageOptions& options) {
  ProgressStyle style = ProgressStyle::kNone;
  if (options.progress == "auto") {
    style = isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
  } else if (options.progress == "always") {
    style = ProgressStyle::kBar;
  } else if (options.progress == "plain") {
    style = ProgressStyle::kLines;
  } else if (options.progress != "never") {
    throw Error(ErrorCode::kUsage,
                "--progress " + options.progress + ": expected auto, always, plain or never");
  }
  return options.quiet ? ProgressStyle::kNone : style;
}

}  // namespace mdk
