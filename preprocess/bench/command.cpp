// mdprep bench: the techniques side by side, timed, counted and judged by brute force; and what is
// made of results that are there already.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/trace/technique.h"
#include "formats/mdk_view.h"
#include "preprocess/bench/comparison.h"
#include "preprocess/bench/measurement.h"
#include "preprocess/bench/report.h"
#include "preprocess/cli/commands.h"
#include "preprocess/cli/common_options.h"
#include "preprocess/cli/interrupt.h"
#include "preprocess/cli/number_text.h"
#include "preprocess/cli/output_paths.h"
#include "preprocess/cli/progress_bar.h"
#include "preprocess/cli/text_file.h"
#include "preprocess/cli/view_options.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDocumentBytes = std::size_t{16} << 20;
constexpr CountRange kFrameRange{1, 100000};
constexpr CountRange kRoundRange{1, 1000};

struct BenchArguments {
  std::vector<std::string> inputs;
  std::string techniques = "all";
  std::string frames = "20";
  std::string rounds = "3";
  std::string judge = "all";
  std::vector<std::string> from, compare;
  std::string commit, command;
  std::string json, csv, html, markdown;  ///< files; empty: not asked for
  std::vector<std::string> quoting;       ///< documents whose marked texts are replaced
  ViewOptions view;
  MachineOptions machine;
  MessageOptions messages;
};

// --- measuring ---

/// All that can be refused before the first file is opened; the camera depends on the model.
BenchConfig parse_config(const BenchArguments& arguments) {
  BenchConfig config;
  const ImageSize size = parse_image_size(arguments.view.size);
  config.request.width = size.width;
  config.request.height = size.height;
  if (!arguments.view.camera.empty()) parse_camera(arguments.view.camera);
  choose_shading(arguments.view, config.request);
  config.techniques = parse_techniques(arguments.techniques);
  config.frames = parse_count("--frames", arguments.frames, kFrameRange);
  config.rounds = parse_count("--rounds", arguments.rounds, kRoundRange);
  if (arguments.judge == "none") config.judged = 0;
  if (arguments.judge != "none" && arguments.judge != "all")
    config.judged = parse_count("--judge", arguments.judge, kFrameRange);
  return config;
}

ModelBench bench_file(const std::string& path, const ViewOptions& view, BenchConfig config,
                      ProgressSink& progress) {
  const MdkFile file(path);
  const Model& model = file.model();
  config.request.camera =
      choose_camera(view, model.bounds, {config.request.width, config.request.height});
  ModelBench result{path, model.triangle_count(), model.key_count(), model.cluster_count(), {}, {}};
  result.bake = read_bake_facts(path, result.triangles, result.keys, result.clusters);
  result.techniques = bench_techniques(model, config, progress);
  return result;
}

/// The options that decide what is measured, in a fixed order, files without their folders.
std::string command_line(const BenchArguments& arguments) {
  std::string line = "mdprep bench";
  for (const std::string& input : arguments.inputs)
    line += " " + fs::path(input).filename().string();
  line += " --techniques " + arguments.techniques + " --size " + arguments.view.size +
          " --frames " + arguments.frames + " --rounds " + arguments.rounds + " --judge " +
          arguments.judge + " --threads " + arguments.machine.threads;
  if (arguments.machine.isa != "best") line += " --isa " + arguments.machine.isa;
  if (arguments.view.shading != "diffuse") line += " --shading " + arguments.view.shading;
  if (arguments.view.samples != "1") line += " --samples " + arguments.view.samples;
  if (arguments.view.occlusion_rays != ViewOptions().occlusion_rays)
    line += " --ao " + arguments.view.occlusion_rays;
  if (!arguments.view.camera.empty()) line += " --camera \"" + arguments.view.camera + "\"";
  return line;
}

BenchResults measure(const BenchArguments& arguments, const BenchConfig& config) {
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  for (const std::string& input : arguments.inputs) MdkFile{input};  // refuse any before timing one
  const DeferredInterrupts interrupts;
  BenchRun run{{std::string(isa_in_use()), thread_count(), config.request.width,
                config.request.height, arguments.view.shading},
               {}};
  const double share = 1.0 / static_cast<double>(arguments.inputs.size());
  for (const std::string& input : arguments.inputs) {
    const double done = static_cast<double>(run.models.size()) * share;
    ProgressPart part(progress, done, done + share);
    run.models.push_back(bench_file(input, arguments.view, config, part));
  }
  return {this_machine(),
          this_program(arguments.commit),
          arguments.command.empty() ? command_line(arguments) : arguments.command,
          {std::move(run)}};
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

// --- results ---

BenchResults read_all(const BenchArguments& arguments) {
  BenchResults results;
  for (const std::string& path : arguments.from) merge_results(results, read_results(path), path);
  if (!arguments.command.empty()) results.command = arguments.command;
  return results;
}

/// Refuses what cannot be written, before any time is spent.
void check_outputs(const BenchArguments& arguments) {
  const std::string files[] = {arguments.json, arguments.csv, arguments.html, arguments.markdown};
  require_distinct_files("", files);
  for (const std::string& input : arguments.inputs) require_distinct_files(input, files);
  for (const std::string& file : files)
    if (!file.empty()) require_writable_place(file);
  if (!arguments.markdown.empty() && fs::path(arguments.markdown).extension().string() != ".md")
    throw Error(ErrorCode::kUsage,
                "--markdown " + arguments.markdown +
                    ": the name must end in .md; pictures go into the folder of that name");
}

/// All texts are made before the first file is written.
void write_outputs(const BenchArguments& arguments, const BenchResults& results) {
  std::vector<TextFile> files;
  if (!arguments.json.empty()) files.push_back({arguments.json, results_json(results)});
  if (!arguments.csv.empty()) files.push_back({arguments.csv, csv_text(csv_table(results))});
  if (!arguments.html.empty()) files.push_back({arguments.html, html_page(make_report(results))});
  const fs::path document(arguments.markdown);
  if (!document.empty())
    for (TextFile& file : markdown_pages(make_report(results), document.stem().string()))
      files.push_back({(document.parent_path() / file.name).string(), std::move(file.text)});
  for (const std::string& quoting : arguments.quoting)
    files.push_back(
        {quoting, with_quotes(read_text_file(quoting, kMaxDocumentBytes), results, quoting)});

  if (!document.empty()) {
    std::error_code problem;
    const fs::path folder = fs::path(document).replace_extension();
    fs::create_directory(folder, problem);
    if (problem) throw io_error(folder.string(), "cannot be made: " + problem.message());
  }
  for (const TextFile& file : files) write_text_file(file.name, file.text);
}

/// A row for each technique, then the techniques' notes.
void print_run(const BenchRun& run) {
  print_table(std::cout, printed_table(run));
  for (const ModelBench& model : run.models)
    for (const TechniqueBench& technique : model.techniques)
      if (!technique.note.empty())
        std::cout << model.name() << " " << technique.id << ": " << technique.note << "\n";
}

void run_bench(const BenchArguments& arguments) {
  const bool is_measuring = arguments.from.empty();
  if (!arguments.compare.empty()) {
    if (!arguments.inputs.empty() || !is_measuring)
      throw Error(ErrorCode::kUsage, "--compare takes two results and no other files");
    return print_comparison(std::cout, compare_results(read_results(arguments.compare.at(0)),
                                                       read_results(arguments.compare.at(1))));
  }
  if (arguments.inputs.empty() == is_measuring)
    throw Error(
        ErrorCode::kUsage,
        "give the .mdk files to measure, or results with --from; see 'mdprep bench --help'");
  const MachineLimits limits(arguments.machine);
  progress_style(arguments.messages);
  const BenchConfig config = parse_config(arguments);
  check_outputs(arguments);

  const BenchResults results = is_measuring ? measure(arguments, config) : read_all(arguments);
  for (const BenchRun& run : results.runs) print_run(run);
  write_outputs(arguments, results);
  if (is_measuring) require_no_mismatches(results.runs.front());
}

// --- options ---

/// Adds options that have an argument.
auto option_adder(CLI::App& command) {
  return [&](const char* name, const char* argument, auto& value, const std::string& help) {
    return command.add_option(name, value, help)->type_name(argument);
  };
}

void add_measuring_options(CLI::App& command, BenchArguments& arguments) {
  const auto add = option_adder(command);
  add("--techniques", "all|ID,...", arguments.techniques,
      "all, which leaves brute-force out, or some of\n" + technique_ids() +
          "\n(default: all). all,-ID,... leaves some out. Brute force judges the hits in any "
          "case.");
  add("--frames", "N", arguments.frames,
      "How many keys to render, spread evenly over all clips, 1 to " +
          std::to_string(kFrameRange.highest) + ";\nno more than there are (default: 20).");
  add("--rounds", "N", arguments.rounds,
      "How often each frame is timed, 1 to " + std::to_string(kRoundRange.highest) +
          "; the fastest counts (default: 3).");
  add("--judge", "all|N|none", arguments.judge,
      "How many of the frames brute force judges, which is slow on large models\n"
      "(default: all).");
}

void add_result_options(CLI::App& command, BenchArguments& arguments) {
  const auto add = option_adder(command);
  add("--from", "RESULT.json...", arguments.from,
      "Measure nothing: take the results that --json wrote. Several become one: other\n"
      "models, instruction sets and threads stand side by side, and more of the same\n"
      "count as further rounds.")
      ->expected(1, -1);
  add("--compare", "OLD.json NEW.json", arguments.compare,
      "Measure nothing: print how the second of two results differs from the first,\n"
      "as ratios with their spread. What lies within the spread is called the same.")
      ->expected(2);
  add("--json", "FILE", arguments.json, "Write medians and every frame as JSON (mdprep-bench/1).");
  add("--csv", "FILE", arguments.csv, "Write the medians as CSV.");
  add("--html", "FILE", arguments.html,
      "Write tables and plots as one page that needs nothing else. Put NAME.json, the\n"
      "report of the bake, beside NAME.mdk for what baking cost.");
  add("--markdown", "FILE.md", arguments.markdown,
      "Write the same as a document, and its pictures into a folder beside it.");
  add("--quote", "FILE...", arguments.quoting,
      "Replace the texts in documents that stand between the markers\n"
      "<!-- bench: techniques MODEL... --> and <!-- end of bench -->.")
      ->expected(1, -1);
  add("--commit", "TEXT", arguments.commit, "What results give as the version measured.");
  add("--command", "TEXT", arguments.command,
      "What results give as the command that made them (default: this one).");
}

}  // namespace

CommandBody add_bench_command(CLI::App& command) {
  const auto arguments = std::make_shared<BenchArguments>();
  command.add_option("FILE", arguments->inputs, ".mdk files made by 'mdprep bake'.")
      ->type_name("")
      ->expected(1, -1);
  add_measuring_options(command, *arguments);
  add_view_options(command, arguments->view);
  add_result_options(command, *arguments);
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  command.footer(
      "Prints a table of medians over the frames on stdout. image ms, the time to image, is\n"
      "pose + update + trace + shade; its middle half is over the animation. Counts come from a\n"
      "pass of their own.\n"
      "Example:\n"
      "  mdprep bench hand.mdk --size 1024x1024 --threads 1 --json hand.json --html hand.html\n"
      "  mdprep bench *.mdk --techniques fuzzy-bvh,rebuild-bvh --frames 50\n"
      "  mdprep bench --compare old.json new.json");
  return [arguments](CommandContext&) { run_bench(*arguments); };
}

}  // namespace mdk
