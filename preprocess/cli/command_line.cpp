#include "preprocess/cli/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <span>

#include "common/base/error.h"
#include "formats/mdk_sections.h"
#include "preprocess/cli/commands.h"
#include "preprocess/cli/tool_version.h"

namespace mdk {
namespace {

constexpr const char* kExitStatuses =
    "Exit status: 0 done, 1 internal fault (please report), 2 wrong use, 3 bad input,\n"
    "4 cannot read or write, 5 over a limit.\n"
    "Messages go to stderr, data to stdout. 'mdprep SUBCOMMAND --help' tells more.";

struct Subcommand {
  CLI::App* app;
  CommandBody run;
  OptionText options;
};

/// CLI11's sentence with what to do about it.
std::string usage_sentence(const std::string& problem, const CLI::App& app) {
  std::string sentence = problem;
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  const auto chosen = app.get_subcommands();
  const std::string help =
      chosen.empty() ? "mdprep --help" : "mdprep " + chosen.front()->get_name() + " --help";
  return sentence + "; see '" + help + "'";
}

std::vector<Subcommand> add_subcommands(CLI::App& app) {
  std::vector<Subcommand> subcommands;
  const auto add = [&](const char* name, const char* summary,
                       CommandBody (*add_options)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, summary);
    command->set_help_flag("-h,--help", "Print this and exit.");
    CommandBody run = add_options(*command);
    subcommands.push_back({command, std::move(run), OptionText(*command)});
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
  add("batch", "Turn a list of bakes, verifies and renders into jobs for ninja, make or Slurm.",
      add_batch_command);
  add("job", "Run one job of a batch where it is needed, and keep a record of it.",
      add_job_command);
  return subcommands;
}

}  // namespace

struct CommandLine::State {
  CLI::App app{"mdprep prepares animated meshes for ray tracing, and renders and measures them.",
               "mdprep"};
  std::vector<Subcommand> subcommands;

  State() {
    app.set_help_flag("-h,--help", "Print this and exit.");
    app.set_version_flag("--version", "mdprep " + version_text(tool_version()))
        ->description("Print the version and exit.");
    app.require_subcommand(1);
    app.footer(kExitStatuses);
    subcommands = add_subcommands(app);
  }
  const Subcommand& chosen() const {
    return *std::find_if(subcommands.begin(), subcommands.end(),
                         [](const Subcommand& s) { return s.app->parsed(); });
  }
};

CommandLine::CommandLine() : state_(std::make_unique<State>()) {}
CommandLine::~CommandLine() = default;

bool CommandLine::parse(const std::vector<std::string>& words) {
  try {
    state_->app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& problem) {
    if (problem.get_exit_code() != 0)
      throw Error(ErrorCode::kUsage, usage_sentence(problem.what(), state_->app));
    state_->app.exit(problem);
    return false;
  }
  return true;
}

std::string CommandLine::name() const { return state_->chosen().app->get_name(); }

std::string CommandLine::option_text(OptionScope scope) const {
  return state_->chosen().options.text(scope);
}

void CommandLine::run(CommandContext& context) const {
  const std::string content = option_text(OptionScope::kContent);
  context.options_hash = checksum_of(std::as_bytes(std::span(content)));
  state_->chosen().run(context);
}

const CLI::App& CommandLine::app() const { return state_->app; }

}  // namespace mdk
