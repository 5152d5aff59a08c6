// mdprep bake: source in, one .mdk image out.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "common/base/error.h"
#include "common/base/printable_text.h"
#include "common/base/stopwatch.h"
#include "formats/mdk_writer.h"
#include "preprocess/cli/bake_report.h"
#include "preprocess/cli/commands.h"
#include "preprocess/cli/common_options.h"
#include "preprocess/cli/depfile.h"
#include "preprocess/cli/interrupt.h"
#include "preprocess/cli/job_shares.h"
#include "preprocess/cli/memory_limit.h"
#include "preprocess/cli/number_text.h"
#include "preprocess/cli/output_paths.h"
#include "preprocess/cli/progress_bar.h"
#include "preprocess/cli/source_reader.h"
#include "preprocess/cli/text_file.h"
#include "preprocess/cli/tool_version.h"
#include "preprocess/pipeline.h"

namespace mdk {
namespace {

struct BakeArguments {
  std::vector<std::string> inputs;
  std::string output, report, depfile;
  SourceOptions source;
  std::string mode = "motion";
  std::string sampling = "cycle";
  std::string joint_limit = "90";
  std::string clusters = "auto";
  std::string stop = "cost";
  std::string rest_pose = "auto";
  std::string segments = "auto";
  std::string refine = "on";
  std::string quantize = "off";
  MachineOptions machine;
  MessageOptions messages;
};

void parse_bone_options(const BakeArguments& arguments, DecomposeOptions& options) {
  if (arguments.sampling == "pose-space") {
    options.sampling = PoseSampling::kPoseSpace;
    if (options.mode != DecomposeMode::kBones)
      throw Error(ErrorCode::kUsage, "--sampling pose-space needs --decompose bones");
    if (options.segments > 1)
      throw Error(ErrorCode::kUsage,
                  "--segments " + arguments.segments +
                      ": a pose space has no time to be cut; leave --segments out");
  } else if (arguments.sampling != "cycle") {
    throw Error(ErrorCode::kUsage,
                "--sampling " + arguments.sampling + ": expected cycle or pose-space");
  }
  options.joint_limit_degrees = parse_real("--joint-limit", arguments.joint_limit);
  if (!(options.joint_limit_degrees >= 0 && options.joint_limit_degrees <= 180))
    throw Error(ErrorCode::kUsage,
                "--joint-limit " + arguments.joint_limit + ": expected degrees from 0 to 180");
}

DecomposeOptions parse_decompose_options(const BakeArguments& arguments) {
  DecomposeOptions options;
  if (arguments.mode == "none") {
    options.mode = DecomposeMode::kNone;
  } else if (arguments.mode == "bones") {
    options.mode = DecomposeMode::kBones;
  } else if (arguments.mode != "motion") {
    throw Error(ErrorCode::kUsage,
                "--decompose " + arguments.mode + ": expected motion, bones or none");
  }
  if (arguments.clusters != "auto")
    options.clusters = parse_count("--clusters", arguments.clusters, {});
  if (arguments.stop != "cost") {
    options.stop_percent = parse_real("--stop", arguments.stop);
    if (!(*options.stop_percent > 0 && *options.stop_percent < 100))
      throw Error(ErrorCode::kUsage, "--stop " + arguments.stop +
                                         ": expected cost, or a percentage above 0 and below 100");
  }
  if (arguments.rest_pose != "auto")
    options.rest_key = parse_count("--rest-pose", arguments.rest_pose, {0, 0xffffffffu});
  if (arguments.quantize != "off") {
    options.quantize = parse_real("--quantize", arguments.quantize);
    if (!(*options.quantize > 0 && *options.quantize < 1))
      throw Error(ErrorCode::kUsage, "--quantize " + arguments.quantize +
                                         ": expected off, or an error above 0 and below 1");
  }
  if (arguments.segments != "auto")
    options.segments = parse_count("--segments", arguments.segments, {});

  parse_bone_options(arguments, options);
  if (arguments.refine != "on" && arguments.refine != "off")
    throw Error(ErrorCode::kUsage, "--refine " + arguments.refine + ": expected on or off");
  options.refine = arguments.refine == "on";

  if (options.clusters > 0 && options.stop_percent)
    throw Error(ErrorCode::kUsage,
                "--clusters N and --stop PCT contradict each other; give one of them");
  if (options.mode == DecomposeMode::kNone && (options.clusters > 1 || options.stop_percent))
    throw Error(ErrorCode::kUsage,
                "--decompose none makes one cluster per mesh; leave --clusters and --stop out");
  if (options.mode == DecomposeMode::kBones && (options.clusters > 0 || options.stop_percent))
    throw Error(ErrorCode::kUsage,
                "--decompose bones makes a cluster for each bone; leave --clusters and --stop out");
  return options;
}

/// As on the command line.
std::string joined_inputs(const BakeArguments& arguments) {
  std::string text = arguments.inputs.front();
  for (std::size_t i = 1; i < arguments.inputs.size(); ++i) text += " " + arguments.inputs[i];
  return text;
}

void print_notes(const BakeArguments& arguments, const std::vector<std::string>& notes) {
  if (arguments.messages.quiet || notes.empty()) return;
  if (arguments.messages.verbose) {
    for (const std::string& note : notes)
      std::cerr << "mdprep: note: " << printable_line(note) << "\n";
  } else {
    std::cerr << "mdprep: " << printable_line(joined_inputs(arguments)) << ": " << notes.size()
              << (notes.size() == 1 ? " note" : " notes")
              << " on what was left out or is not as asked; -v shows them\n";
  }
}

void print_steps(const std::vector<ClusteringStep>& steps) {
  for (const ClusteringStep& step : steps)
    std::cerr << "mdprep: " << step.clusters << " clusters: residual "
              << fixed_text(step.residual_rms * 100, 4) << " % rms, cost "
              << fixed_text(step.sah_cost, 2) << "\n";
}

void keep_inputs(const BakeArguments& arguments, const std::vector<std::string>& inputs) {
  const std::string outputs[] = {arguments.output, arguments.report, arguments.depfile};
  for (const std::string& input : inputs) require_distinct_files(input, outputs);
}

void check_places(const BakeArguments& arguments) {
  require_writable_place(arguments.output);
  if (!arguments.report.empty()) require_writable_place(arguments.report);
  if (!arguments.depfile.empty()) require_writable_place(arguments.depfile);
}

/// Before any of the long work: what is certain to be needed once all keys are known. Decomposing
/// takes tables of its own, at most as large as the keys.
void require_memory(const BakeArguments& arguments, const PoseSequence& sequence,
                    const MemoryLimit& limit) {
  constexpr std::uint64_t kLargestTables = std::uint64_t{32} << 20;
  const std::uint64_t keys = sequence.positions.size() * sizeof(Vec3f);
  const std::uint64_t needed = limit.counted_bytes() + std::min(keys / 2, kLargestTables);
  if (limit.bytes() == 0 || needed <= limit.bytes()) return;
  throw Error(ErrorCode::kOverLimit,
              joined_inputs(arguments) + ": " + grouped_text(sequence.key_count()) + " keys of " +
                  grouped_text(sequence.vertex_count) + " vertices need at least " +
                  bytes_text(needed) + ", --memory-limit " + arguments.machine.memory_limit +
                  " is less; allow more, or bake fewer clips");
}

/// Lists that a good part of the limit would go on.
std::uint64_t min_scratch_bytes(const MemoryLimit& limit) {
  constexpr std::uint64_t kShare = 16, kMin = std::uint64_t{16} << 20;
  return limit.bytes() == 0 ? 0 : std::max(limit.bytes() / kShare, kMin);
}

/// decompose, whose sentences on what it was given do not know where that came from.
DecomposeResult decompose_source(const BakeArguments& arguments, PoseSequence sequence,
                                 const DecomposeOptions& options, ProgressSink& progress) {
  try {
    return decompose(std::move(sequence), options, progress);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    throw bad_input(joined_inputs(arguments), error.what());
  }
}

void run_bake(const BakeArguments& arguments, CommandContext& context) {
  const MachineLimits limits(arguments.machine);
  const DecomposeOptions options = parse_decompose_options(arguments);
  parse_source_options(arguments.source);
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  const Source source_files = find_source(arguments.inputs);
  keep_inputs(arguments, source_files.files.files);
  check_places(arguments);
  const ScratchSpace scratch(std::filesystem::path(arguments.output).parent_path().string(),
                             min_scratch_bytes(limits.memory()));
  const DeferredInterrupts interrupts;

  BakeOutcome outcome{joined_inputs(arguments), arguments.output, {}, {}, 0, 0, 0};
  Stopwatch total, stage;
  const JobEnds ends = predict_job_ends(source_files, options);
  ProgressPart reading(progress, 0, ends.read);
  SourceOptions reading_options = arguments.source;
  reading_options.skeleton = options.sampling == PoseSampling::kPoseSpace;
  reading_options.scratch = scratch;
  ReadResult source = read_source(source_files, reading_options, reading);
  keep_inputs(arguments, source.dependencies);
  outcome.read_through = source.read_through;
  outcome.seconds.read = stage.lap();
  require_memory(arguments, source.sequence, limits.memory());

  ProgressPart decomposing(progress, ends.read, ends.decomposed);
  const DecomposeResult result =
      decompose_source(arguments, std::move(source.sequence), options, decomposing);
  outcome.seconds.decompose = result.stats.decompose_seconds;
  outcome.seconds.build = result.stats.build_seconds;

  ProgressPart writing(progress, ends.decomposed, 1);
  stage.lap();
  const Model model = result.model.view();
  const MdkOrigin origin{
      tool_version(), context.options_hash,
      source.read_through.empty() ? SourceReader::kMdprep : SourceReader::kAssimp};
  outcome.file_bytes = write_mdk(model, arguments.output, {origin, context.overwrite, &writing});
  outcome.seconds.write = stage.lap();
  outcome.seconds.total = total.seconds();
  outcome.peak_memory_bytes = peak_memory_bytes();
  outcome.scratch_bytes = scratch.peak_bytes();

  context.inputs = source.dependencies;
  context.unread = source.unread;
  context.outputs = {arguments.output};
  context.report = bake_report_json(model, result.stats, outcome);
  if (!arguments.report.empty()) write_text_file(arguments.report, context.report);
  if (!arguments.depfile.empty())
    write_text_file(arguments.depfile, depfile_text(arguments.output, source.dependencies));
  progress.clear();
  source.notes.insert(source.notes.end(), result.stats.notes.begin(), result.stats.notes.end());
  print_notes(arguments, source.notes);
  if (arguments.messages.verbose) print_steps(result.stats.steps);
  if (!arguments.messages.quiet) std::cerr << bake_summary(model, result.stats, outcome);
}

void add_decompose_options(CLI::App& command, BakeArguments& arguments) {
  command
      .add_option(
          "--decompose", arguments.mode,
          "motion: clusters of triangles that move alike; bones: a cluster for each bone\n"
          "or rigid part; none: one cluster per mesh, which does not move (default: motion).")
      ->type_name("motion|bones|none");
  command
      .add_option("--sampling", arguments.sampling,
                  "What the boxes of bones hold for. cycle: the clips' poses; pose-space: each\n"
                  "pose in which no joint is turned past its limit, too, so that the file can\n"
                  "be posed by hand (default: cycle).")
      ->type_name("cycle|pose-space");
  command
      .add_option("--joint-limit", arguments.joint_limit,
                  "How far each joint may turn from its rest, in degrees, 0 to 180\n"
                  "(default: 90).")
      ->type_name("DEG");
  command
      .add_option("--clusters", arguments.clusters,
                  "How many clusters: as many as pay, or exactly N, at least 1 (default: auto).")
      ->type_name("auto|N");
  command
      .add_option(
          "--stop", arguments.stop,
          "When to stop adding clusters: cost, when more would make rays dearer; a percentage\n"
          "above 0 and below 100: cluster by residual motion, as in the paper, until\n"
          "another cluster lowers it by less (default: cost).")
      ->type_name("cost|PCT");
  command
      .add_option("--rest-pose", arguments.rest_pose,
                  "The key the local bases are fitted to, counted from 0 through all clips, or\n"
                  "the best there is (default: auto).")
      ->type_name("auto|KEY");
  command
      .add_option("--quantize", arguments.quantize,
                  "Store key positions with few bits: no vertex is farther off than ERROR times\n"
                  "the rest pose's diagonal, above 0 and below 1. Skins and morphs that take\n"
                  "less room stay exact (default: off).")
      ->type_name("off|ERROR");
  command
      .add_option("--segments", arguments.segments,
                  "Into how many stretches of time, each with boxes and trees of its own: as many\n"
                  "as their memory pays, or exactly N, at least 1 (default: auto).")
      ->type_name("auto|N");
  command
      .add_option("--refine", arguments.refine,
                  "Whether to refine the clusters' maps towards the smallest boxes (default: on).")
      ->type_name("on|off");
}

}  // namespace

CommandBody add_bake_command(CLI::App& command) {
  const auto arguments = std::make_shared<BakeArguments>();
  command
      .add_option(
          "INPUT", arguments->inputs,
          "An animated mesh: .gltf or .glb (skins, morph targets, node animation); an .obj\n"
          "or .ply for each key (a folder, 'walk_####.obj', or all the files); an .obj or\n"
          ".ply and the point cache that moves it (.pc2 or .mdd); or, through Assimp, .fbx,\n"
          ".dae, .md5mesh, .x and others.")
      ->required()
      ->type_name("");
  command
      .add_option("-o,--output", arguments->output,
                  "The file to write. It appears whole or not at all.")
      ->required()
      ->type_name("OUT.mdk");
  add_source_options(command, arguments->source);
  add_decompose_options(command, *arguments);
  command
      .add_option("--report", arguments->report,
                  "Write counts, residuals, cost and times as JSON (mdprep-bake/1).")
      ->type_name("FILE");
  command
      .add_option("--depfile", arguments->depfile,
                  "Write every file that was read as dependencies for make and ninja.")
      ->type_name("FILE");
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  add_verbose_option(command, arguments->messages);
  command.footer(
      "Example:\n"
      "  mdprep bake hand.glb -o hand.mdk --report hand.json\n"
      "  mdprep bake fox.glb -o fox.mdk --clips Walk,Run --fps 24 --stop 5\n"
      "  mdprep bake cow.obj cow.pc2 -o cow.mdk --fps 24\n"
      "  mdprep bake 'walk_####.obj' -o walk.mdk --fps 24");
  return [arguments](CommandContext& context) { run_bake(*arguments, context); };
}

}  // namespace mdk
