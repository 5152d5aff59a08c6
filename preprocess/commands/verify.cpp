// mdprep verify: everything a renderer relies on in a .mdk file, checked the slow way.
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/error.h"
#include "formats/mdk/mdk_file.h"
#include "preprocess/commands/checks.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/commands/source.h"
#include "preprocess/tool/progress_bar.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr CountRange kSampleRange{1, 1000000};
constexpr std::uint32_t kMinSamples = 200;
constexpr std::uint32_t kHitMoments = 4;

struct VerifyArguments {
  std::string input;
  std::vector<std::string> source_paths;
  std::optional<std::uint32_t> samples;  ///< none: one per interval, but no fewer than kMinSamples
  std::uint32_t seed = 1;
  bool json = false;
  ReadOptions source;
  MachineOptions machine;
  MessageOptions messages;
};

struct VerifyReport {
  std::vector<CheckResult> checks;
  std::uint64_t seed = 0;
  std::uint32_t samples = 0;
  bool between_keys = true;  ///< whether times between keys are judged
  std::uint64_t hit_mismatches = 0;
  std::vector<std::string> sources;  ///< every file that was read for --source

  void add(const std::vector<CheckResult>& results) {
    checks.insert(checks.end(), results.begin(), results.end());
  }
  std::uint64_t failed_checks() const {
    std::uint64_t failed = 0;
    for (const CheckResult& check : checks) failed += !check.passed();
    return failed;
  }
};

std::uint32_t sample_count(const VerifyArguments& arguments, const ModelView& model) {
  if (arguments.samples) return *arguments.samples;
  return static_cast<std::uint32_t>(
      std::clamp<std::uint64_t>(interval_count(model), kMinSamples, kSampleRange.highest));
}

/// Opening has already checked offsets, links and ranges; this adds every byte of the sections.
CheckResult check_bytes(const MdkFile& file) {
  CheckResult result{"sections have their checksums", file.sections().size(), 0, ""};
  try {
    file.verify_checksums();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kBadInput) throw;
    result.failures = 1;
    result.detail = error.what();
  }
  return result;
}

VerifyReport verify_file(const MdkFile& file, const VerifyArguments& arguments,
                         ProgressSink& progress) {
  const ModelView& model = file.model();
  VerifyReport report;
  report.seed = arguments.seed;
  progress.report("checksums", 0);
  report.add({{"offsets, links and ranges are sound", file.sections().size(), 0, ""}});
  report.add({check_bytes(file)});

  report.between_keys = model.holds_between_keys;
  const auto moments = [&](std::uint32_t count, std::uint64_t seed) {
    return report.between_keys ? random_moments(model, count, seed) : std::vector<KeyInterval>();
  };
  const std::vector<KeyInterval> between = moments(sample_count(arguments, model), report.seed);
  report.samples = static_cast<std::uint32_t>(between.size());
  ProgressPart boxes(progress, 0.05, 0.4), trees(progress, 0.4, 0.45), hits(progress, 0.45, 0.95);
  report.add(check_boxes(model, between, boxes));
  report.add({check_trees(model, trees)});
  const std::vector<CheckResult> hit_results =
      check_hits(model, moments(kHitMoments, report.seed + 1), hits);
  for (const CheckResult& result : hit_results) report.hit_mismatches += result.failures;
  report.add(hit_results);

  if (!arguments.source_paths.empty()) {
    ProgressPart reading(progress, 0.95, 1);
    const Source source = find_source(arguments.source_paths);
    ReadResult read = read_source(source, arguments.source, reading);
    report.add(check_source(model, read.sequence));
    report.sources = std::move(read.dependencies);
  }
  return report;
}

void print_json(const VerifyReport& report, const std::string& file) {
  Json checks = Json::array();
  for (const CheckResult& check : report.checks)
    checks.push_back({{"name", check.name},
                      {"count", check.count},
                      {"failures", check.failures},
                      {"detail", check.detail}});
  const Json json = {{"schema", "mdprep-verify/1"},
                     {"file", file},
                     {"seed", report.seed},
                     {"samples", report.samples},
                     {"between_keys", report.between_keys},
                     {"checks", checks},
                     {"hit_mismatches", report.hit_mismatches},
                     {"ok", report.failed_checks() == 0}};
  std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

void print_table(const VerifyReport& report) {
  TextTable table(2);
  for (const CheckResult& check : report.checks)
    table.add_row({check.passed() ? "ok" : "FAILED", check.name, grouped_text(check.count),
                   check.passed() ? "" : grouped_text(check.failures) + " failures", check.detail});
  table.print(std::cout);
  if (report.between_keys)
    std::cout << report.samples << " random times, seed " << report.seed << "\n";
  else
    std::cout << "boxes hold at keys only: no time between keys was looked at\n";
  if (report.failed_checks() == 0) {
    std::cout << "ok\n";
  } else {
    std::cout << report.failed_checks() << " of " << report.checks.size() << " checks failed\n";
  }
}

void run_verify(const VerifyArguments& arguments, CommandContext& context) {
  const MachineLimits limits(arguments.machine);
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  if (!arguments.source_paths.empty()) find_source(arguments.source_paths);
  const LoopCheck interrupts = context.interrupts.defer();

  const MdkFile file(arguments.input);
  const VerifyReport report = verify_file(file, arguments, progress);
  progress.clear();
  context.inputs = {arguments.input};
  context.inputs.insert(context.inputs.end(), report.sources.begin(), report.sources.end());
  if (arguments.json) {
    print_json(report, arguments.input);
  } else {
    print_table(report);
  }
  if (report.failed_checks() > 0)
    throw bad_input(arguments.input, std::to_string(report.failed_checks()) + " of " +
                                         std::to_string(report.checks.size()) +
                                         " checks failed; bake it again");
}

}  // namespace

void add_verify_command(Command& command) {
  const auto arguments = std::make_shared<VerifyArguments>();
  command.add_text("FILE", "", "A .mdk file made by 'mdprep bake'.", arguments->input)
      .required()
      .with(OptionEffect::kFile);
  command
      .add_texts(OptionKind::kOneEach, "--source", "INPUT",
                 "Read the source again and compare clips, triangles and the position of\n"
                 "every corner at every key. Give the bake's --clips and --fps, too. For an\n"
                 ".obj and its point cache: --source twice; for several files of a sequence,\n"
                 "better name the folder or 'walk_####.obj'.",
                 arguments->source_paths)
      .with(OptionEffect::kFile);
  add_source_options(command, arguments->source);
  command.option("--clips").needs = "--source";
  command.option("--fps").needs = "--source";
  command.add_value("--samples", "auto|N",
                    "How many random times between keys to check boxes at, spread over all\n"
                    "intervals, 1 to 1000000 (default: 200, or one per interval where there are\n"
                    "more).",
                    "auto", arguments->samples, unless("auto", count_in(kSampleRange)));
  command.add_value("--seed", "N", "Chooses the random times, 0 to 4294967295 (default: 1).", "1",
                    arguments->seed, [](std::string_view text) {
                      return parse_count(text, {0, 0xffffffffu});
                    });
  command.add_flag("--json", "Print JSON (mdprep-verify/1) instead of a table.", arguments->json);
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  command.set_notes(
      "Example:\n"
      "  mdprep verify hand.mdk --source hand.glb\n"
      "  mdprep verify fox.mdk --samples 10000 --seed 7 --json");
  command.set_body([arguments](CommandContext& context) { run_verify(*arguments, context); });
}

}  // namespace mdk
