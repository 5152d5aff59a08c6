// mdprep bench: the techniques side by side, timed, counted and judged by brute force.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/trace/technique.h"
#include "formats/mdk_view.h"
#include "preprocess/cli/bench_report.h"
#include "preprocess/cli/bench_run.h"
#include "preprocess/cli/commands.h"
#include "preprocess/cli/common_options.h"
#include "preprocess/cli/interrupt.h"
#include "preprocess/cli/key_range.h"
#include "preprocess/cli/number_text.h"
#include "preprocess/cli/output_paths.h"
#include "preprocess/cli/progress_bar.h"
#include "preprocess/cli/text_file.h"
#include "preprocess/cli/view_options.h"

namespace mdk {
namespace {

constexpr CountRange kFrameRange{1, 100000};
constexpr CountRange kRoundRange{1, 1000};

struct BenchArguments {
  std::vector<std::string> inputs;
  std::string techniques = "all";
  std::string frames = "20";
  std::string rounds = "3";
  std::string json, csv;
  ViewOptions view;
  MachineOptions machine;
  MessageOptions messages;
};

void check_outputs(const BenchArguments& arguments) {
  const std::string outputs[] = {arguments.json, arguments.csv};
  for (const std::string& input : arguments.inputs) require_distinct_files(input, outputs);
  for (const std::string& output : outputs)
    if (!output.empty()) require_writable_place(output);
}

ModelBench bench_file(const std::string& path, const BenchArguments& arguments,
                      ProgressSink& progress) {
  const MdkFile file(path);
  const Model& model = file.model();
  const ImageSize size = parse_image_size(arguments.view.size);
  BenchConfig config;
  config.techniques = parse_techniques(arguments.techniques);
  config.keys =
      spread_keys(parse_count("--frames", arguments.frames, kFrameRange), model.key_count());
  config.camera = choose_camera(arguments.view, model.bounds, size);
  config.width = size.width;
  config.height = size.height;
  config.shading = find_shading(arguments.view.shading);
  config.rounds = parse_count("--rounds", arguments.rounds, kRoundRange);
  return {path, model.triangle_count(), model.key_count(), model.cluster_count(),
          bench_techniques(model, config, progress)};
}

/// What can be refused before the first file is opened.
void check_words(const BenchArguments& arguments) {
  parse_image_size(arguments.view.size);
  if (!arguments.view.camera.empty()) parse_camera(arguments.view.camera);
  find_shading(arguments.view.shading);
  parse_techniques(arguments.techniques);
  parse_count("--frames", arguments.frames, kFrameRange);
  parse_count("--rounds", arguments.rounds, kRoundRange);
}

/// Peers may decide a pixel on an edge otherwise; ours must not.
void require_no_mismatches(const std::vector<ModelBench>& models) {
  for (const ModelBench& model : models)
    for (const TechniqueBench& technique : model.techniques)
      if (technique.hit_mismatches > 0 && find_technique(technique.id).kind != TechniqueKind::kPeer)
        throw Error(ErrorCode::kInternal,
                    model.file + ": " + technique.id + " differs from brute force in " +
                        std::to_string(technique.hit_mismatches) +
                        " pixels; this is a bug, please report it with the file");
}

void run_bench(const BenchArguments& arguments) {
  const MachineLimits limits(arguments.machine);
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  check_words(arguments);
  check_outputs(arguments);
  for (const std::string& input : arguments.inputs) MdkFile{input};  // refuse any before timing one
  defer_interrupts();

  std::vector<ModelBench> models;
  const double share = 1.0 / static_cast<double>(arguments.inputs.size());
  for (const std::string& input : arguments.inputs) {
    const double done = static_cast<double>(models.size()) * share;
    ProgressPart part(progress, done, done + share);
    models.push_back(bench_file(input, arguments, part));
  }
  progress.clear();

  const ImageSize size = parse_image_size(arguments.view.size);
  const BenchMachine machine{std::string(isa_in_use()), thread_count(), size.width, size.height};
  print_bench_table(std::cout, models);
  if (!arguments.json.empty()) write_text_file(arguments.json, bench_json(machine, models));
  if (!arguments.csv.empty()) write_text_file(arguments.csv, bench_csv(machine, models));
  require_no_mismatches(models);
}

void add_measuring_options(CLI::App& command, BenchArguments& arguments) {
  command
      .add_option("--techniques", arguments.techniques,
                  "all, which leaves brute-force out, or some of\n" + technique_ids() +
                      "\n(default: all). Brute force judges the hits in any case.")
      ->type_name("all|ID,...");
  command
      .add_option("--frames", arguments.frames,
                  "How many keys to render, spread evenly over all clips, 1 to " +
                      std::to_string(kFrameRange.highest) +
                      ";\nno more than there are (default: 20).")
      ->type_name("N");
  command
      .add_option("--rounds", arguments.rounds,
                  "How often each frame is timed, 1 to " + std::to_string(kRoundRange.highest) +
                      "; the fastest counts (default: 3).")
      ->type_name("N");
}

}  // namespace

CommandBody add_bench_command(CLI::App& command) {
  const auto arguments = std::make_shared<BenchArguments>();
  command.add_option("FILE", arguments->inputs, ".mdk files made by 'mdprep bake'.")
      ->required()
      ->type_name("")
      ->expected(1, -1);
  add_measuring_options(command, *arguments);
  add_view_options(command, arguments->view);
  command
      .add_option("--json", arguments->json,
                  "Write medians and every frame as JSON (mdprep-bench/1).")
      ->type_name("FILE");
  command.add_option("--csv", arguments->csv, "Write the medians as CSV.")->type_name("FILE");
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  command.footer(
      "Prints a table of medians over the frames on stdout. image ms, the time to image, is\n"
      "pose + update + trace + shade. Counts come from a pass of their own.\n"
      "Example:\n"
      "  mdprep bench hand.mdk --size 1024x1024 --threads 1 --json hand.json\n"
      "  mdprep bench *.mdk --techniques fuzzy-bvh,rebuild-bvh --frames 50");
  return [arguments] { run_bench(*arguments); };
}

}  // namespace mdk
