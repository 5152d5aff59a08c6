// mdprep bench: the techniques side by side, timed, counted and judged by brute force; and what is
// made of results that are there already.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/trace/technique.h"
#include "formats/files/file_kind.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mds/mds_file.h"
#include "preprocess/bench/comparison.h"
#include "preprocess/bench/measurement.h"
#include "preprocess/bench/rays.h"
#include "preprocess/bench/report.h"
#include "preprocess/bench/scene_frames.h"
#include "preprocess/bench/scene_rays.h"
#include "preprocess/boxes/model_assembly.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/progress_bar.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDocumentBytes = std::size_t{16} << 20;
constexpr CountRange kFrameRange{1, 100000};
constexpr CountRange kRoundRange{1, 1000};

struct BenchArguments {
  std::vector<std::string> inputs;
  bool rays = false;
  BenchConfig config;
  std::vector<std::string> from, compare;
  std::string commit, command;
  std::string json, csv, html, markdown;  ///< files; empty: not asked for
  std::vector<std::string> quoting;       ///< documents whose marked texts are replaced
  ViewOptions view;
  MachineOptions machine;
  MessageOptions messages;
};

// --- measuring ---

std::uint32_t parse_judged(std::string_view text) {
  if (text == "none") return 0;
  return text == "all" ? BenchConfig().judged : parse_count(text, kFrameRange);
}

ModelBench bench_file(const std::string& path, const ViewOptions& view, BenchConfig config,
                      ProgressSink& progress) {
  const MdkFile file(path);
  const ModelView& model = file.model();
  config.request.camera = choose_camera(view, model.bounds);
  config.request.width = view.size.width;
  config.request.height = view.size.height;
  config.request.shading = view.shading;
  config.request.samples = view.samples;
  config.request.occlusion_rays = view.occlusion_rays;
  ModelBench result;
  result.file = path;
  result.triangles = model.triangle_count();
  result.keys = model.key_count();
  result.clusters = model.cluster_count();
  result.between_keys = model.holds_between_keys;
  result.predicted_cost = predicted_cost(model);
  result.bake = read_bake_facts(path, result.triangles, result.keys, result.clusters);
  result.techniques = bench_techniques(model, config, progress);
  return result;
}

/// The options that decide what is measured, in a fixed order, files without their folders.
std::string command_line(const BenchArguments& arguments, Command& command) {
  std::string line = "mdprep bench";
  for (const std::string& input : arguments.inputs)
    line.append(" ").append(fs::path(input).filename().string());
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

BenchResults measure(const BenchArguments& arguments, Command& command, Interrupts& interrupts) {
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  for (const std::string& input : arguments.inputs) MdkFile{input};  // refuse any before timing one
  const LoopCheck check = interrupts.defer();
  BenchRun run{{std::string(isa_in_use()), thread_count(), arguments.view.size.width,
                arguments.view.size.height, std::string(shading_id(arguments.view.shading))},
               {}};
  const double share = 1.0 / static_cast<double>(arguments.inputs.size());
  for (const std::string& input : arguments.inputs) {
    const double done = static_cast<double>(run.models.size()) * share;
    ProgressPart part(progress, done, done + share);
    run.models.push_back(bench_file(input, arguments.view, arguments.config, part));
  }
  return {this_machine(),
          this_program(arguments.commit),
          arguments.command.empty() ? command_line(arguments, command) : arguments.command,
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

bool is_scene(const std::string& path) { return lower_extension(path) == ".mds"; }

// --- single rays ---

void measure_rays(const BenchArguments& arguments, Interrupts& interrupts) {
  if (arguments.inputs.empty() || !arguments.from.empty() || !arguments.compare.empty() ||
      !arguments.csv.empty() || !arguments.html.empty() || !arguments.markdown.empty() ||
      !arguments.quoting.empty())
    throw Error(ErrorCode::kUsage,
                "--rays takes .mdk and .mds files and writes a table and --json");
  const MachineLimits limits(arguments.machine);
  check_outputs(arguments);
  for (const std::string& input : arguments.inputs)
    if (!is_scene(input)) MdkFile{input};
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  const LoopCheck check = interrupts.defer();
  const double share = 1.0 / static_cast<double>(arguments.inputs.size());
  std::vector<RayBench> models;
  for (const std::string& input : arguments.inputs) {
    const double done = static_cast<double>(models.size()) * share;
    ProgressPart part(progress, done, done + share);
    models.push_back(is_scene(input) ? bench_scene_rays(input, {}, part)
                                     : bench_rays(input, {}, part));
  }
  print_rays(std::cout, models);
  if (!arguments.json.empty()) write_text_file(arguments.json, rays_json(models));
  for (const RayBench& model : models)
    for (const RayBenchRow& row : model.rows)
      if (row.mismatches > 0)
        throw Error(ErrorCode::kInternal,
                    model.file + ": " + row.row + " differs from brute force for " +
                        std::to_string(row.mismatches) +
                        " rays; this is a bug, please report it with the file");
}

// --- frames of scenes ---

void measure_scenes(const BenchArguments& arguments, Interrupts& interrupts) {
  if (!std::ranges::all_of(arguments.inputs, is_scene) || !arguments.from.empty() ||
      !arguments.csv.empty() || !arguments.html.empty() || !arguments.markdown.empty() ||
      !arguments.quoting.empty())
    throw Error(ErrorCode::kUsage,
                "scenes are measured without models beside them, to a table and --json");
  const MachineLimits limits(arguments.machine);
  check_outputs(arguments);
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  const LoopCheck check = interrupts.defer();
  std::vector<SceneBench> scenes;
  for (const std::string& input : arguments.inputs) {
    BenchConfig config = arguments.config;
    {
      const MdsFile file(input);
      Aabb bounds;
      for (std::uint32_t i = 0; i < file.stage().instance_count(); ++i)
        bounds.extend(file.stage().box_always(i));
      config.request.camera = choose_camera(arguments.view, bounds);
    }
    config.request.width = arguments.view.size.width;
    config.request.height = arguments.view.size.height;
    config.request.shading = arguments.view.shading;
    config.request.samples = arguments.view.samples;
    scenes.push_back(bench_scene(input, config, progress));
  }
  print_scenes(std::cout, scenes);
  if (!arguments.json.empty()) write_text_file(arguments.json, scenes_json(scenes));
  for (const SceneBench& scene : scenes)
    for (const SceneTechniqueBench& technique : scene.techniques)
      if (technique.hit_mismatches > 0)
        throw Error(ErrorCode::kInternal,
                    scene.file + ": " + technique.id + " differs from brute force in " +
                        std::to_string(technique.hit_mismatches) +
                        " pixels; this is a bug, please report it with the file");
}

void run_bench(const BenchArguments& arguments, Command& command, Interrupts& interrupts) {
  if (arguments.rays) return measure_rays(arguments, interrupts);
  if (std::ranges::any_of(arguments.inputs, is_scene)) return measure_scenes(arguments, interrupts);
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
  check_outputs(arguments);

  const BenchResults results =
      is_measuring ? measure(arguments, command, interrupts) : read_all(arguments);
  for (const BenchRun& run : results.runs) print_run(run);
  write_outputs(arguments, results);
  if (is_measuring) require_no_mismatches(results.runs.front());
}

// --- options ---

void add_measuring_options(Command& command, BenchConfig& config) {
  command.add_value("--techniques", "all|ID,...",
                    "all, which leaves brute-force out, or some of\n" + technique_ids() +
                        "\n(default: all). all,-ID,... leaves some out. Brute force judges the "
                        "hits in any case.",
                    "all", config.techniques, parse_techniques);
  command.add_value("--frames", "N",
                    "How many keys to render, spread evenly over all clips, 1 to " +
                        std::to_string(kFrameRange.highest) +
                        ";\nno more than there are (default: 20).",
                    "20", config.frames, count_in(kFrameRange));
  command.add_value("--rounds", "N",
                    "How often each frame is timed, 1 to " + std::to_string(kRoundRange.highest) +
                        "; the fastest counts (default: 3).",
                    "3", config.rounds, count_in(kRoundRange));
  command.add_value("--judge", "all|N|none",
                    "How many of the frames brute force judges, which is slow on large models\n"
                    "(default: all).",
                    "all", config.judged, parse_judged);
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
  command.add_text("--json", "FILE", "Write medians and every frame as JSON (mdprep-bench/1).",
                   arguments.json);
  command.add_text("--csv", "FILE", "Write the medians as CSV.", arguments.csv);
  command.add_text(
      "--html", "FILE",
      "Write tables and plots as one page that needs nothing else. Put NAME.json, the\n"
      "report of the bake, beside NAME.mdk for what baking cost.",
      arguments.html);
  command.add_text("--markdown", "FILE.md",
                   "Write the same as a document, and its pictures into a folder beside it.",
                   arguments.markdown);
  command.add_texts(OptionKind::kSome, "--quote", "FILE...",
                    "Replace the texts in documents that stand between the markers\n"
                    "<!-- bench: techniques MODEL... --> and <!-- end of bench -->.",
                    arguments.quoting);
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
  command.add_flag(
      "--rays",
      "Time single rays instead, at times of their own and many at one time, on one\n"
      "thread and on all; beside Embree's, where it was built in. 20,000 rays of each\n"
      "kind, medians of 11 rounds. Takes --json (mdk-rays/1), --threads and --isa.",
      arguments->rays);
  add_measuring_options(command, arguments->config);
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
