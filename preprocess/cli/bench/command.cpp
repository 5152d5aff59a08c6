// mdprep bench: the techniques side by side, timed, counted and judged by brute force; and what is
// made of results that are there already.
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/trace/technique.h"
#include "formats/mdk_view.h"
#include "preprocess/cli/bench/comparison.h"
#include "preprocess/cli/bench/measurement.h"
#include "preprocess/cli/bench/outputs.h"
#include "preprocess/cli/bench/result_json.h"
#include "preprocess/cli/bench/result_tables.h"
#include "preprocess/cli/bench/setting.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/tool/progress_bar.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr CountRange kFrameRange{1, 100000};
constexpr CountRange kRoundRange{1, 1000};

struct BenchArguments {
  std::vector<std::string> inputs;
  std::vector<std::string> techniques;
  std::uint32_t frames = 0, rounds = 0, judged = 0;
  std::vector<std::string> from, compare;
  std::string commit, command;
  BenchOutputs outputs;
  ViewOptions view;
  MachineOptions machine;
  MessageOptions messages;
};

std::uint32_t parse_judged(std::string_view text) {
  if (text == "none") return 0;
  return text == "all" ? kFrameRange.highest : parse_count(text, kFrameRange);
}

ModelBench bench_file(const std::string& path, const BenchArguments& arguments,
                      ProgressSink& progress) {
  const MdkFile file(path);
  const Model& model = file.model();
  BenchConfig config;
  config.techniques = arguments.techniques;
  config.keys = spread_keys(arguments.frames, model.key_count());
  config.camera = choose_camera(arguments.view, model.bounds);
  config.width = arguments.view.size.width;
  config.height = arguments.view.size.height;
  config.shading = arguments.view.shading;
  config.samples = arguments.view.samples;
  config.occlusion_rays = arguments.view.occlusion_rays;
  config.rounds = arguments.rounds;
  config.judged = arguments.judged;
  ModelBench result{path, model.triangle_count(), model.key_count(), model.cluster_count(), {}, {}};
  result.bake = read_bake_facts(path, result.triangles, result.keys, result.clusters);
  result.techniques = bench_techniques(model, config, progress);
  return result;
}

/// The options that decide what is measured, in a fixed order, files without their folders.
std::string command_line(const BenchArguments& arguments, Command& command) {
  std::string line = "mdprep bench";
  for (const std::string& input : arguments.inputs)
    line.append(" ").append(std::filesystem::path(input).filename().string());
  for (const char* name :
       {"--techniques", "--size", "--frames", "--rounds", "--judge", "--threads"})
    line.append(" ").append(name).append(" ").append(command.option(name).text());
  for (const char* name : {"--isa", "--shading", "--samples", "--ao"})
    if (const Option& option = command.option(name); option.text() != option.standard)
      line.append(" ").append(name).append(" ").append(option.text());
  if (const std::string& camera = command.option("--camera").text(); !camera.empty())
    line.append(" --camera \"").append(camera).append("\"");
  return line;
}

/// Peers may decide a pixel on an edge otherwise; ours must not.
void require_no_mismatches(const BenchRun& run) {
  for (const ModelBench& model : run.models)
    for (const TechniqueBench& technique : model.techniques)
      if (technique.hit_mismatches > 0 && find_technique(technique.id).kind != TechniqueKind::kPeer)
        throw Error(ErrorCode::kInternal,
                    model.file + ": " + technique.id + " differs from brute force in " +
                        std::to_string(technique.hit_mismatches) +
                        " pixels; this is a bug, please report it with the file");
}

BenchResults measure(const BenchArguments& arguments, Command& command, Interrupts& interrupts) {
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  for (const std::string& input : arguments.inputs) MdkFile{input};  // refuse any before timing one
  const LoopCheck check = interrupts.defer();
  BenchRun run{std::string(isa_in_use()),
               thread_count(),
               arguments.view.size.width,
               arguments.view.size.height,
               std::string(shading_id(arguments.view.shading)),
               {}};
  const double share = 1.0 / static_cast<double>(arguments.inputs.size());
  for (const std::string& input : arguments.inputs) {
    const double done = static_cast<double>(run.models.size()) * share;
    ProgressPart part(progress, done, done + share);
    run.models.push_back(bench_file(input, arguments, part));
  }
  return {this_machine(),
          this_program(arguments.commit),
          arguments.command.empty() ? command_line(arguments, command) : arguments.command,
          {std::move(run)}};
}

BenchResults read_all(const BenchArguments& arguments) {
  BenchResults results;
  for (const std::string& path : arguments.from) merge_results(results, read_results(path), path);
  if (!arguments.command.empty()) results.command = arguments.command;
  return results;
}

void run_comparison(const BenchArguments& arguments) {
  if (!arguments.inputs.empty() || !arguments.from.empty())
    throw Error(ErrorCode::kUsage, "--compare takes two results and no other files");
  print_comparison(std::cout, compare_results(read_results(arguments.compare.at(0)),
                                              read_results(arguments.compare.at(1))));
}

void run_bench(const BenchArguments& arguments, Command& command, Interrupts& interrupts) {
  if (!arguments.compare.empty()) return run_comparison(arguments);
  if (arguments.inputs.empty() == arguments.from.empty())
    throw Error(
        ErrorCode::kUsage,
        "give the .mdk files to measure, or results with --from; see 'mdprep bench --help'");
  const MachineLimits limits(arguments.machine);
  check_outputs(arguments.outputs, arguments.inputs);

  const BenchResults results =
      arguments.from.empty() ? measure(arguments, command, interrupts) : read_all(arguments);
  for (const BenchRun& run : results.runs) print_bench_table(std::cout, run);
  write_outputs(arguments.outputs, results);
  if (arguments.from.empty()) require_no_mismatches(results.runs.front());
}

void add_measuring_options(Command& command, BenchArguments& arguments) {
  command.add_value("--techniques", "all|ID,...",
                    "all, which leaves brute-force out, or some of\n" + technique_ids() +
                        "\n(default: all). all,-ID,... leaves some out. Brute force judges the "
                        "hits in any case.",
                    "all", arguments.techniques, parse_techniques);
  command.add_value("--frames", "N",
                    "How many keys to render, spread evenly over all clips, 1 to " +
                        std::to_string(kFrameRange.highest) +
                        ";\nno more than there are (default: 20).",
                    "20", arguments.frames, count_in(kFrameRange));
  command.add_value("--rounds", "N",
                    "How often each frame is timed, 1 to " + std::to_string(kRoundRange.highest) +
                        "; the fastest counts (default: 3).",
                    "3", arguments.rounds, count_in(kRoundRange));
  command.add_value("--judge", "all|N|none",
                    "How many of the frames brute force judges, which is slow on large models\n"
                    "(default: all).",
                    "all", arguments.judged, parse_judged);
}

void add_result_options(Command& command, BenchArguments& arguments) {
  command.add_texts(
      OptionKind::kSome, "--from", "RESULT.json...",
      "Measure nothing: take the results that --json wrote. Several become one: other\n"
      "models, instruction sets and threads stand side by side, and more of the same\n"
      "count as further rounds.",
      arguments.from);
  command.add_texts(OptionKind::kTwo, "--compare", "OLD.json NEW.json",
                    "Measure nothing: print how the second of two results differs from the first,\n"
                    "as ratios with their spread. What lies within the spread is called the same.",
                    arguments.compare);
  BenchOutputs& outputs = arguments.outputs;
  command.add_text("--json", "FILE", "Write medians and every frame as JSON (mdprep-bench/1).",
                   outputs.json);
  command.add_text("--csv", "FILE", "Write the medians as CSV.", outputs.csv);
  command.add_text(
      "--html", "FILE",
      "Write tables and plots as one page that needs nothing else. Put NAME.json, the\n"
      "report of the bake, beside NAME.mdk for what baking cost.",
      outputs.html);
  command.add_text("--markdown", "FILE.md",
                   "Write the same as a document, and its pictures into a folder beside it.",
                   outputs.markdown);
  command.add_texts(OptionKind::kSome, "--quote", "FILE...",
                    "Make the texts of documents anew that stand between the markers\n"
                    "<!-- bench: techniques MODEL... --> and <!-- end of bench -->.",
                    outputs.quoting);
  command.add_text("--commit", "TEXT", "What results give as the version measured.",
                   arguments.commit);
  command.add_text("--command", "TEXT",
                   "What results give as the command that made them (default: this one).",
                   arguments.command);
}

}  // namespace

void add_bench_command(Command& command) {
  const auto arguments = std::make_shared<BenchArguments>();
  command.add_texts(OptionKind::kSome, "FILE", "", ".mdk files made by 'mdprep bake'.",
                    arguments->inputs);
  add_measuring_options(command, *arguments);
  add_view_options(command, arguments->view);
  add_result_options(command, *arguments);
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  command.set_notes(
      "Prints a table of medians over the frames on stdout. image ms, the time to image, is\n"
      "pose + update + trace + shade; its middle half is over the animation. Counts come from a\n"
      "pass of their own.\n"
      "Example:\n"
      "  mdprep bench hand.mdk --size 1024x1024 --threads 1 --json hand.json --html hand.html\n"
      "  mdprep bench *.mdk --techniques fuzzy-bvh,rebuild-bvh --frames 50\n"
      "  mdprep bench --compare old.json new.json");
  command.set_body([arguments, &command](CommandContext& context) {
    run_bench(*arguments, command, context.interrupts);
  });
}

}  // namespace mdk
