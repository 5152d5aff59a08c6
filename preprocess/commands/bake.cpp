// mdprep bake: source in, one .mdk image out, and what that came to as a report.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/base/stopwatch.h"
#include "common/base/text.h"
#include "formats/mdk/writer.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/commands/source.h"
#include "preprocess/pipeline.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/progress_bar.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

struct BakeArguments {
  std::vector<std::string> inputs;
  std::string output, report, depfile;
  ReadOptions source;
  DecomposeOptions decompose;
  MachineOptions machine;
  MessageOptions messages;
};

/// 0 for "auto".
std::uint32_t parse_auto_count(std::string_view text) {
  return text == "auto" ? 0 : parse_count(text, {});
}

/// Options that contradict each other.
void check_decompose_options(const DecomposeOptions& options) {
  const auto refuse_where = [](bool is_wrong, const std::string& sentence) {
    if (is_wrong) throw Error(ErrorCode::kUsage, sentence);
  };
  const bool is_pose_space = options.sampling == PoseSampling::kPoseSpace;
  const bool has_stop = options.stop_percent.has_value();
  refuse_where(is_pose_space && options.mode != DecomposeMode::kBones,
               "--sampling pose-space needs --decompose bones");
  refuse_where(is_pose_space && options.segments > 1,
               "--segments " + std::to_string(options.segments) +
                   ": a pose space has no time to be cut; leave --segments out");
  refuse_where(is_pose_space && options.between == BetweenKeys::kIgnore,
               "--between-keys off: a pose space holds between keys, too; leave it out");
  refuse_where(options.mode == DecomposeMode::kNone && (options.clusters > 1 || has_stop),
               "--decompose none makes one cluster per mesh; leave --clusters and --stop out");
  refuse_where(options.mode == DecomposeMode::kBones && (options.clusters > 0 || has_stop),
               "--decompose bones makes a cluster for each bone; leave --clusters and --stop out");
}

struct BakeSeconds {
  double read = 0, decompose = 0, build = 0, write = 0, total = 0;
};

/// What a bake came to.
struct BakeOutcome {
  std::string input, output;  ///< as given on the command line
  std::string read_through;   ///< what read the input in mdprep's place; empty: nothing
  BakeSeconds seconds;
  std::uint64_t peak_memory_bytes = 0;  ///< resident, with pages of mapped files
  std::uint64_t file_bytes = 0;
  std::uint64_t scratch_bytes = 0;  ///< lists that stood in files without a name
};

std::string stop_text(const std::string& reason) {
  if (reason == "cost") return "another would cost more than it saves";
  if (reason == "percent") return "another would gain less than the percentage";
  if (reason == "count") return "as many as asked for";
  if (reason == "bones") return "those of bones that have triangles";
  if (reason == "limit") return "the most there may be";
  return "no decomposition";
}

/// Schema "mdprep-bake/1".
std::string bake_report_json(const ModelView& model, const DecomposeStats& stats,
                             const BakeOutcome& outcome) {
  using Json = nlohmann::ordered_json;
  Json clips = Json::array();
  for (const Clip& clip : model.clips)
    clips.push_back(
        {{"name", clip.name}, {"seconds", model.clip_seconds(clip)}, {"keys", clip.key_count}});
  Json quantization = nullptr;
  if (stats.quantization)
    quantization = {{"bound", stats.quantization->bound}, {"largest", stats.quantization->largest}};
  const Json read_through =
      outcome.read_through.empty() ? Json(nullptr) : Json(outcome.read_through);
  Json growth = Json::array();
  for (const GrowthStep& step : stats.steps)
    growth.push_back({{"clusters", step.clusters},
                      {"residual_rms", step.residual_rms},
                      {"fuzzy_area", step.fuzzy_area},
                      {"sah_cost", step.sah_cost}});
  const Json report = {
      {"schema", "mdprep-bake/1"},
      {"input", outcome.input},
      {"read_through", read_through},
      {"triangles", model.triangle_count()},
      {"vertices", model.vertex_count},
      {"keys", model.key_count()},
      {"clips", clips},
      {"clusters", model.cluster_count()},
      {"segments", model.segment_count()},
      {"between_keys", model.holds_between_keys},
      {"rest_key", stats.rest_key},
      {"stop_reason", stats.stop_reason},
      {"residual_rms", stats.residual_rms},
      {"residual_max", stats.residual_max},
      {"quantization", quantization},
      {"sah_cost", stats.sah_cost},
      {"refine_gain", stats.refine_gain},
      {"seconds",
       {{"read", outcome.seconds.read},
        {"decompose", outcome.seconds.decompose},
        {"build", outcome.seconds.build},
        {"write", outcome.seconds.write},
        {"total", outcome.seconds.total}}},
      {"peak_memory_bytes", outcome.peak_memory_bytes},
      {"file_bytes", outcome.file_bytes},
      {"growth", growth},
  };
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string bake_summary(const ModelView& model, const DecomposeStats& stats,
                         const BakeOutcome& outcome) {
  const auto count = [](std::uint64_t n, const std::string& thing) {
    return grouped_text(n) + " " + thing + (n == 1 ? "" : "s");
  };
  const auto percent = [](double share) { return fixed_text(share * 100, 3) + " %"; };
  const BakeSeconds& s = outcome.seconds;
  return printable_line(outcome.output) + ": " + count(model.triangle_count(), "triangle") + ", " +
         grouped_text(model.vertex_count) + " vertices, " + count(model.key_count(), "key") +
         " in " + count(model.clips.size(), "clip") + "\n  " +
         count(model.cluster_count(), "cluster") + " (" + stop_text(stats.stop_reason) + "), " +
         count(model.segment_count(), "time segment") +
         (model.holds_between_keys ? "" : ", boxes at keys only") + ", rest pose key " +
         std::to_string(stats.rest_key) + ", residual " + percent(stats.residual_rms) + " rms, " +
         percent(stats.residual_max) + " at most of the diagonal, cost " +
         fixed_text(stats.sah_cost, 1) + "\n  " + bytes_text(outcome.file_bytes) + " in " +
         fixed_text(s.total, 2) + " s (read " + fixed_text(s.read, 2) + ", decompose " +
         fixed_text(s.decompose, 2) + ", build " + fixed_text(s.build, 2) + ", write " +
         fixed_text(s.write, 2) + "), peak memory " + bytes_text(outcome.peak_memory_bytes) +
         (outcome.scratch_bytes > 0
              ? std::string(" with mapped files, ") + bytes_text(outcome.scratch_bytes) +
                    " of them for long lists\n"
              : "\n");
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

void print_steps(const std::vector<GrowthStep>& steps) {
  for (const GrowthStep& step : steps)
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
                  bytes_text(needed) + ", --memory-limit " + size_text(limit.bytes()) +
                  " is less; allow more, or bake fewer clips");
}

/// Lists that a good part of the limit would go on.
std::uint64_t min_scratch_bytes(const MemoryLimit& limit) {
  constexpr std::uint64_t kShare = 16, kMin = std::uint64_t{16} << 20;
  return limit.bytes() == 0 ? 0 : std::max(limit.bytes() / kShare, kMin);
}

/// decompose(), whose sentences on what it was given do not know where that came from.
DecomposeResult decompose_source(const BakeArguments& arguments, PoseSequence sequence,
                                 ProgressSink& progress) {
  try {
    return decompose(std::move(sequence), arguments.decompose, progress);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    throw bad_input(joined_inputs(arguments), error.what());
  }
}

void run_bake(const BakeArguments& arguments, CommandContext& context) {
  const MachineLimits limits(arguments.machine);
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  const Source source_files = find_source(arguments.inputs);
  keep_inputs(arguments, source_files.files.files);
  check_places(arguments);
  const ScratchSpace scratch(std::filesystem::path(arguments.output).parent_path().string(),
                             min_scratch_bytes(limits.memory()));
  const LoopCheck interrupts = context.interrupts.defer();

  BakeOutcome outcome{joined_inputs(arguments), arguments.output, {}, {}, 0, 0, 0};
  Stopwatch total, stage;
  const JobEnds ends = predict_job_ends(source_files, arguments.decompose);
  ProgressPart reading(progress, 0, ends.read);
  ReadOptions reading_options = arguments.source;
  reading_options.scratch = scratch;
  reading_options.skeleton = arguments.decompose.sampling == PoseSampling::kPoseSpace;
  ReadResult source = read_source(source_files, reading_options, reading);
  keep_inputs(arguments, source.dependencies);
  outcome.read_through = source.read_through;
  outcome.seconds.read = stage.lap();
  require_memory(arguments, source.sequence, limits.memory());

  ProgressPart decomposing(progress, ends.read, ends.decomposed);
  const DecomposeResult result =
      decompose_source(arguments, std::move(source.sequence), decomposing);
  outcome.seconds.decompose = result.stats.decompose_seconds;
  outcome.seconds.build = result.stats.build_seconds;

  ProgressPart writing(progress, ends.decomposed, 1);
  stage.lap();
  const ModelView model = result.model.view();
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
    write_text_file(arguments.depfile, with_name("--depfile", [&] {
                      return depfile_text(arguments.output, source.dependencies);
                    }));
  progress.clear();
  source.notes.insert(source.notes.end(), result.stats.notes.begin(), result.stats.notes.end());
  print_notes(arguments, source.notes);
  if (arguments.messages.verbose) print_steps(result.stats.steps);
  if (!arguments.messages.quiet) std::cerr << bake_summary(model, result.stats, outcome);
}

void add_decompose_options(Command& command, DecomposeOptions& options) {
  command.add_value(
      "--decompose", "motion|bones|none",
      "motion: clusters of triangles that move alike; bones: a cluster for each bone\n"
      "or rigid part; none: one cluster per mesh, which does not move (default: motion).",
      "motion", options.mode,
      one_of<DecomposeMode>({{"motion", DecomposeMode::kMotion},
                             {"bones", DecomposeMode::kBones},
                             {"none", DecomposeMode::kNone}}));
  command.add_value("--sampling", "cycle|pose-space",
                    "What the boxes of bones hold for. cycle: the clips' poses; pose-space: each\n"
                    "pose in which no joint is turned past its limit, too, so that the file can\n"
                    "be posed by hand (default: cycle).",
                    "cycle", options.sampling,
                    one_of<PoseSampling>({{"cycle", PoseSampling::kCycle},
                                          {"pose-space", PoseSampling::kPoseSpace}}));
  command.add_value(
      "--joint-limit", "DEG",
      "How far each joint may turn from its rest, in degrees, 0 to 180\n"
      "(default: 90).",
      "90", options.joint_limit_degrees,
      real_where([](double x) { return x >= 0 && x <= 180; }, "degrees from 0 to 180"));
  command.add_value("--clusters", "auto|N",
                    "How many clusters: as many as pay, at most 80, or exactly N, at least 1\n"
                    "(default: auto).",
                    "auto", options.clusters, parse_auto_count);
  command.add_value(
      "--stop", "cost|PCT",
      "When to stop adding clusters: cost, when more would make rays more expensive; a\n"
      "percentage above 0 and below 100: cluster by residual motion, as in the paper,\n"
      "until another cluster lowers it by less, or up to --clusters N (default: cost).",
      "cost", options.stop_percent,
      unless("cost", real_where([](double x) { return x > 0 && x < 100; },
                                "cost, or a percentage above 0 and below 100")));
  command.add_value("--rest-pose", "auto|KEY",
                    "The key the local bases are fitted to, counted from 0 through all clips, or\n"
                    "the best there is (default: auto).",
                    "auto", options.rest_key, unless("auto", count_in({0, 0xffffffffu})));
  command.add_value("--quantize", "off|ERROR",
                    "Store key positions with few bits: no vertex is farther off than ERROR times\n"
                    "the rest pose's diagonal, above 0 and below 1. Skins and morphs that take\n"
                    "less room stay exact (default: off).",
                    "off", options.quantize,
                    unless("off", real_where([](double x) { return x > 0 && x < 1; },
                                             "off, or an error above 0 and below 1")));
  command.add_value(
      "--segments", "auto|N",
      "Into how many stretches of time, each with boxes and trees of its own: as many\n"
      "as their memory pays, or exactly N, at least 1 (default: auto).",
      "auto", options.segments, parse_auto_count);
  command.add_value(
      "--between-keys", "on|off",
      "What boxes hold for. on: every time; off: keys only, as in the paper, so that only\n"
      "keys can be traced: a time between two is taken as the nearer one (default: on).",
      "on", options.between,
      one_of<BetweenKeys>({{"on", BetweenKeys::kBound}, {"off", BetweenKeys::kIgnore}}));
  command.add_value(
      "--refine", "on|off",
      "Whether to refine the clusters' maps towards the smallest boxes (default: on).", "on",
      options.refine, one_of<bool>({{"on", true}, {"off", false}}));
}

}  // namespace

void add_bake_command(Command& command) {
  const auto arguments = std::make_shared<BakeArguments>();
  command
      .add_texts(
          OptionKind::kSome, "INPUT", "",
          "An animated mesh: .gltf or .glb (skins, morph targets, node animation); an .obj\n"
          "or .ply for each key (a folder, 'walk_####.obj', or all the files); an .obj or\n"
          ".ply and the point cache that moves it (.pc2 or .mdd); or, through Assimp, .fbx,\n"
          ".dae, .md5mesh, .x and others.",
          arguments->inputs)
      .required()
      .with(OptionEffect::kFile);
  command
      .add_text("-o,--output", "OUT.mdk", "The file to write. It appears whole or not at all.",
                arguments->output)
      .required()
      .with(OptionEffect::kFile);
  add_source_options(command, arguments->source);
  add_decompose_options(command, arguments->decompose);
  command
      .add_text("--report", "FILE",
                "Write counts, residuals, cost and times as JSON (mdprep-bake/1).",
                arguments->report)
      .with(OptionEffect::kFile);
  command
      .add_text("--depfile", "FILE",
                "Write every file that was read as dependencies for make and ninja.",
                arguments->depfile)
      .with(OptionEffect::kNone);
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  add_verbose_option(command, arguments->messages);
  command.set_notes(
      "Example:\n"
      "  mdprep bake hand.glb -o hand.mdk --report hand.json\n"
      "  mdprep bake fox.glb -o fox.mdk --clips Walk,Run --fps 24 --stop 5\n"
      "  mdprep bake cow.obj cow.pc2 -o cow.mdk --fps 24\n"
      "  mdprep bake 'walk_####.obj' -o walk.mdk --fps 24");
  command.add_check([arguments] { check_decompose_options(arguments->decompose); });
  command.set_body([arguments](CommandContext& context) { run_bake(*arguments, context); });
}

}  // namespace mdk
