// mdprep scene: who stands where and does what, as one .mds file.
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string_view>

#include "common/base/text.h"
#include "formats/files/file_kind.h"
#include "preprocess/casts/cast.h"
#include "preprocess/casts/scatter.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

struct SceneArguments {
  std::vector<std::string> inputs;
  std::string output;
  CastOptions cast;
  std::optional<ScatterPattern> scatter;
  std::optional<std::uint32_t> count;
  std::uint32_t seed = 1;
  std::optional<double> spacing;
  MachineOptions machine;
  MessageOptions messages;
};

void read_cast(const std::string& input, const SceneArguments& arguments, SceneBuilder& scene,
               std::vector<std::string>& notes) {
  const std::string extension = lower_extension(input);
  if (extension == ".json")
    read_json_cast(input, scene);
  else if (extension == ".csv")
    read_csv_cast(input, arguments.cast, scene);
  else if (extension == ".txt")
    read_trajectories(input, arguments.cast, scene, notes);
  else
    throw Error(ErrorCode::kUsage,
                input +
                    ": no cast has this extension; there are .json, .csv and .txt, and "
                    ".mdk with --scatter");
}

void run_scene(const SceneArguments& arguments, CommandContext& context) {
  const MachineLimits limits(arguments.machine);
  require_writable_place(arguments.output);
  for (const std::string& input : arguments.inputs)
    require_distinct_files(input, {&arguments.output, 1});
  const LoopCheck interrupts = context.interrupts.defer();

  SceneBuilder scene(arguments.output);
  std::vector<std::string> notes;
  if (arguments.scatter) {
    CastOptions cast = arguments.cast;
    cast.models = arguments.inputs;
    scatter({*arguments.scatter, *arguments.count, arguments.seed, arguments.spacing}, cast, scene);
  } else {
    for (const std::string& input : arguments.inputs) read_cast(input, arguments, scene, notes);
  }
  if (scene.instance_count() == 0)
    throw bad_input(arguments.inputs.front(), "has no instances; a scene needs at least one");
  const SceneStorage& made = scene.finish();
  const std::vector<SceneModelFile> models = scene.model_files();
  const std::uint64_t bytes = write_mds(made.view(), models, arguments.output,
                                        {tool_version(), context.options_hash, context.overwrite});

  context.inputs = arguments.inputs;
  for (const std::string& path : scene.model_paths())
    if (std::ranges::find(context.inputs, path) == context.inputs.end())
      context.inputs.push_back(path);
  context.outputs = {arguments.output};
  if (arguments.messages.quiet) return;
  for (const std::string& note : notes) std::cerr << "mdprep: note: " << note << "\n";
  std::cerr << "mdprep: " << arguments.output << ": " << grouped_text(made.instances.size())
            << " instances of " << models.size() << (models.size() == 1 ? " model, " : " models, ")
            << grouped_text(made.paths.size()) << (made.paths.size() == 1 ? " path, " : " paths, ")
            << bytes_text(bytes) << "\n";
}

}  // namespace

void add_scene_command(Command& command) {
  const auto arguments = std::make_shared<SceneArguments>();
  command
      .add_texts(OptionKind::kSome, "CAST", "",
                 "Who stands where and does what: .json (mdk-scene/1), .csv, or trajectories\n"
                 "(.txt: id frame x y [z]); with --scatter, the models (.mdk).",
                 arguments->inputs)
      .required()
      .with(OptionEffect::kFile);
  command
      .add_text("-o,--output", "OUT.mds", "The file to write. It appears whole or not at all.",
                arguments->output)
      .required()
      .with(OptionEffect::kFile);
  command
      .add_texts(OptionKind::kOneEach, "--model", "FILE.mdk",
                 "What those play who name no model (.csv, .txt); given more than once, in turn.",
                 arguments->cast.models)
      .with(OptionEffect::kFile);
  command
      .add_text("--clip", "NAME",
                "What those play who name no clip (default: the first of the model; with\n"
                "--scatter, any that moves).",
                arguments->cast.clip)
      .with(OptionEffect::kName);
  command.add_value("--fps", "N",
                    "Frames a second of trajectories (default: as a comment says,\n"
                    "\"# framerate: 25\").",
                    "", arguments->cast.fps,
                    [parse = real_where([](double x) { return x > 0 && x <= 1e4; },
                                        "a number above 0, up to 10000")](std::string_view text) {
                      return std::optional(parse(text));
                    });
  command.add_value("--up", "y|z",
                    "Which axis points up: headings turn about it (default: y, as in glTF).", "y",
                    arguments->cast.up, one_of<UpAxis>({{"y", UpAxis::kY}, {"z", UpAxis::kZ}}));
  command.add_value("--scale", "S", "Scale of those that say none (default: 1).", "1",
                    arguments->cast.scale,
                    real_where([](double x) { return x >= 1e-9 && x <= 1e9; }, "a number above 0"));
  command.add_value(
      "--stride", "SPEED",
      "How fast the clip walks, metres a second: clips of trajectories run faster or\n"
      "slower by that (default: as the feet on the ground tell).",
      "", arguments->cast.stride,
      [parse = real_where([](double x) { return x > 0 && x <= 1e6; }, "a speed above 0")](
          std::string_view text) { return std::optional(parse(text)); });
  command.add_value("--scatter", "grid|rows|disc|stadium",
                    "Instead of a cast: so many of the models in a pattern, their start times\n"
                    "spread over the clips.",
                    "", arguments->scatter,
                    [parse = one_of<ScatterPattern>({{"grid", ScatterPattern::kGrid},
                                                     {"rows", ScatterPattern::kRows},
                                                     {"disc", ScatterPattern::kDisc},
                                                     {"stadium", ScatterPattern::kStadium}})](
                        std::string_view text) { return std::optional(parse(text)); });
  command
      .add_value("--count", "N", "How many, 1 to 100000000.", "", arguments->count,
                 [](std::string_view text) {
                   return std::optional(parse_count(text, {1, 100'000'000}));
                 })
      .needs = "--scatter";
  command
      .add_value("--seed", "N", "Chooses models, clips and start times (default: 1).", "1",
                 arguments->seed,
                 [](std::string_view text) {
                   return parse_count(text, {0, 0xffffffffu});
                 })
      .needs = "--scatter";
  command
      .add_value(
          "--spacing", "D", "From one to the next (default: 1.1 times the widest model).", "",
          arguments->spacing,
          [parse = real_where([](double x) { return x > 0 && x <= 1e9; }, "a length above 0")](
              std::string_view text) { return std::optional(parse(text)); })
      .needs = "--scatter";
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  command.set_notes(
      "Example:\n"
      "  mdprep scene --scatter stadium --count 10000 hand.mdk -o stadium.mds\n"
      "  mdprep scene crowd.csv -o crowd.mds\n"
      "  mdprep scene street.txt --model ben.mdk --clip walk --fps 25 --up z -o street.mds");
  command.add_check([arguments] {
    if (arguments->scatter && !arguments->count)
      throw Error(ErrorCode::kUsage, "--scatter needs --count N");
  });
  command.set_body([arguments](CommandContext& context) { run_scene(*arguments, context); });
}

}  // namespace mdk
