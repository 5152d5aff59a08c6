// mdprep: parses the command line, runs one subcommand, and turns whatever goes wrong into one
// sentence on stderr and an exit status.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "preprocess/cli/commands.h"
#include "preprocess/cli/interrupt.h"

namespace mdk {
namespace {

struct Subcommand {
  CLI::App* app;
  CommandBody run;
};

constexpr const char* kExitStatuses =
    "Exit status: 0 done, 1 internal fault (please report), 2 wrong use, 3 bad input,\n"
    "4 cannot read or write, 5 over a limit.\n"
    "Messages go to stderr, data to stdout. 'mdprep SUBCOMMAND --help' tells more.";

std::vector<Subcommand> add_subcommands(CLI::App& app) {
  std::vector<Subcommand> subcommands;
  const auto add = [&](const char* name, const char* summary,
                       CommandBody (*add_options)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->set_help_flag("-h,--help", "Print this and exit.");
    subcommands.push_back({command, add_options(*command)});
  };
  add("bake", "Read an animated mesh and write one .mdk file that is all a renderer needs.",
      add_bake_command);
  add("info", "Show what is inside a .mdk file.", add_info_command);
  add("verify",
      "Check a .mdk file: checksums, links, boxes at keys and between, and that every\n"
      "technique gives brute force's hits. Exit status 3 where a check fails.",
      add_verify_command);
  add("render", "Ray trace frames of a .mdk file to PNG; needs no display.", add_render_command);
  add("bench", "Time the techniques on .mdk files.", add_bench_command);
  return subcommands;
}

/// CLI11's sentence with what to do about it.
std::string usage_sentence(const std::string& problem, const CLI::App& app) {
  std::string sentence = problem;
  for (char& c : sentence)
    if (c == '\n') c = ' ';
  const auto chosen = app.get_subcommands();
  const std::string help =
      chosen.empty() ? "mdprep --help" : "mdprep " + chosen.front()->get_name() + " --help";
  return sentence + "; see '" + help + "'";
}

int fail(int status, const std::string& sentence) {
  std::cerr << "mdprep: " << sentence << "\n";
  return status;
}

int parse_and_run(int argc, char** argv) {
  CLI::App app{"mdprep prepares animated meshes for ray tracing, and renders and measures them.",
               "mdprep"};
  app.set_help_flag("-h,--help", "Print this and exit.");
  app.set_version_flag("--version", "mdprep " MDK_VERSION)
      ->description("Print the version and exit.");
  app.require_subcommand(1);
  app.footer(kExitStatuses);
  const std::vector<Subcommand> subcommands = add_subcommands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    if (problem.get_exit_code() == 0) return app.exit(problem);  // --help, --version
    return fail(static_cast<int>(ErrorCode::kUsage), usage_sentence(problem.what(), app));
  }
  for (const Subcommand& subcommand : subcommands)
    if (subcommand.app->parsed()) subcommand.run();
  return 0;
}

/// A full disk or a closed pipe must not pass for success.
void require_stdout_written() {
  if (!std::cout.flush()) throw io_error("standard output", "cannot be written");
}

int run(int argc, char** argv) {
  try {
    const int status = parse_and_run(argc, argv);
    require_stdout_written();
    return status;
  } catch (const Error& error) {
    std::cout.flush();
    return fail(error.exit_status(), error.what());
  } catch (const Interrupted& interrupted) {
    return fail(interrupted.exit_status(), "interrupted; no file was left half-written");
  } catch (const std::bad_alloc&) {
    return fail(static_cast<int>(ErrorCode::kOverLimit),
                "not enough memory; try a smaller input, fewer clips or a smaller picture");
  } catch (const std::exception& fault) {
    return fail(static_cast<int>(ErrorCode::kInternal),
                std::string("internal fault, please report it: ") + fault.what());
  }
}

}  // namespace
}  // namespace mdk

int main(int argc, char** argv) { return mdk::run(argc, argv); }
