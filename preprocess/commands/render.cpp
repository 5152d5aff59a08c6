// mdprep render: frames of a .mdk file, or of a scene, to PNG, without a display.
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/base/text.h"
#include "common/trace/renderer.h"
#include "formats/files/file_kind.h"
#include "formats/files/image_writer.h"
#include "formats/mdk/mdk_file.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/commands/film_writer.h"
#include "preprocess/commands/render_scene.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/measures.h"
#include "preprocess/tool/progress_bar.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

struct RenderArguments {
  std::string input, output, clip, stats;
  std::optional<KeyRange> frames;
  std::optional<double> time_seconds;
  double shutter_seconds = 0;
  std::string technique;
  std::uint64_t cache_bytes = 0;
  ViewOptions view;
  MachineOptions machine;
  MessageOptions messages;
};

struct PlannedFrame {
  KeyInterval at;
  std::uint32_t clip = 0;
  double seconds = 0;  ///< from the clip's start
};

PlannedFrame frame_at_key(const ModelView& model, std::uint32_t key) {
  return {at_key(key), clip_of_key(model, key), model.key_times[key]};
}

std::uint32_t find_clip(const ModelView& model, const std::string& name) {
  if (name.empty()) return 0;
  std::string known;
  for (std::uint32_t c = 0; c < model.clips.size(); ++c) {
    if (model.clips[c].name == name) return c;
    known += (c == 0 ? "" : ", ") + model.clips[c].name;
  }
  throw Error(ErrorCode::kUsage, "--clip " + name + ": no clip has this name; there are: " + known);
}

PlannedFrame frame_at_time(const ModelView& model, std::uint32_t clip, double seconds) {
  const double length = model.clip_seconds(model.clips[clip]);
  if (!(seconds >= 0 && seconds <= length))
    throw Error(ErrorCode::kUsage, "--time " + shortest_text(seconds) + ": clip " +
                                       model.clips[clip].name + " runs from 0 to " +
                                       fixed_text(length, 6) + " s");
  const KeyInterval at = locate_time(model, clip, seconds);
  return {at, clip, model.holds_between_keys ? seconds : model.key_times[at.key0]};
}

/// --frames or --time or, without either, every key of the clip.
std::vector<PlannedFrame> plan_frames(const RenderArguments& arguments, const ModelView& model) {
  std::vector<PlannedFrame> frames;
  if (arguments.frames) {
    const KeyRange& range = *arguments.frames;
    const std::string option =
        "--frames " + std::to_string(range.first) + ":" + std::to_string(range.last);
    const std::vector<std::uint32_t> keys =
        with_name(option, [&] { return range.keys(model.key_count()); });
    for (const std::uint32_t key : keys) frames.push_back(frame_at_key(model, key));
    return frames;
  }
  const std::uint32_t clip = find_clip(model, arguments.clip);
  if (arguments.time_seconds) return {frame_at_time(model, clip, *arguments.time_seconds)};
  const Clip& keys = model.clips[clip];
  for (std::uint32_t i = 0; i < keys.key_count; ++i)
    frames.push_back(frame_at_key(model, keys.first_key + i));
  return frames;
}

constexpr double kUsualRate = 30;

/// That at which the film runs as long as the animation: of the frames of the first one's clip.
double film_rate(const std::vector<PlannedFrame>& frames) {
  std::size_t last = 0;
  while (last + 1 < frames.size() && frames[last + 1].clip == frames[0].clip) ++last;
  const double seconds = frames[last].seconds - frames[0].seconds;
  return seconds > 0 ? static_cast<double>(last) / seconds : kUsualRate;
}

/// When each sample of a frame is taken, or nothing where all are taken at once.
std::vector<KeyInterval> moments_of(const ModelView& model, const PlannedFrame& frame,
                                    const RenderArguments& arguments, const FrameRequest& request) {
  if (arguments.shutter_seconds == 0) return {};
  std::vector<KeyInterval> moments =
      shutter_moments(model, frame.clip, frame.seconds, arguments.shutter_seconds, request.samples);
  moments.front() = frame.at;
  return moments;
}

Json stats_row(const ModelView& model, const PlannedFrame& frame, const FrameStats& stats,
               const FrameStats& counted) {
  const WorkPerRay work = work_per_ray(counted.counters, counted.rays);
  return {{"key", frame.at.key0},
          {"clip", model.clips[frame.clip].name},
          {"time", frame.seconds},
          {"pose_ms", stats.pose_ms},
          {"update_ms", stats.update_ms},
          {"trace_ms", stats.trace_ms},
          {"shade_ms", stats.shade_ms},
          {"time_to_image_ms", stats.time_to_image_ms()},
          {"prebuild_ms", stats.prebuild_ms},
          {"rays", stats.rays},
          {"hits", stats.hits},
          {"light_rays", stats.light_rays},
          {"node_visits_per_ray", work.node_visits},
          {"leaf_triangles_per_ray", work.leaf_triangles},
          {"triangle_tests_per_ray", work.triangle_tests},
          {"clusters_per_ray", work.clusters}};
}

/// What the lightest colour of a heat map means.
std::string heat_text(const HeatScale& heat) {
  if (heat.top == 0) return {};
  std::ostringstream text;
  text << ", yellow is " << heat.top << ' ' << heat.unit;
  return text.str();
}

/// Renders and writes every frame; returns the rows of --stats.
Json render_frames(const RenderArguments& arguments, const ModelView& model,
                   const std::vector<PlannedFrame>& frames, Overwrite overwrite) {
  const ImageSize size = arguments.view.size;
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  Renderer renderer(model, arguments.technique);
  FrameRequest request;
  request.width = size.width;
  request.height = size.height;
  request.shading = arguments.view.shading;
  request.samples = arguments.view.samples;
  request.occlusion_rays = arguments.view.occlusion_rays;

  std::map<std::uint32_t, Camera> cameras;  // each clip's own, for all its keys: a frame is the
                                            // same in whatever range it is rendered
  std::optional<FilmWriter> film;
  if (is_film(arguments.output)) film.emplace(arguments.output, size, film_rate(frames), overwrite);

  Json rows = Json::array();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.report("render", static_cast<double>(i) / static_cast<double>(frames.size()));
    const std::vector<KeyInterval> moments = moments_of(model, frames[i], arguments, request);
    request.at = frames[i].at;
    request.shutter = moments;
    const auto [camera, is_new] = cameras.try_emplace(frames[i].clip);
    if (is_new) camera->second = choose_camera(arguments.view, clip_bounds(model, frames[i].clip));
    request.camera = camera->second;
    request.counting = Counting::kOff;
    const FrameStats stats = renderer.render(request);
    const HeatScale heat = renderer.heat_scale();
    const std::string path = numbered_path(arguments.output, frames[i].at.key0);
    if (film) {
      film->add(renderer.pixels());
    } else {
      write_png(path, size.width, size.height, renderer.pixels(), overwrite);
    }
    if (arguments.messages.verbose) {
      progress.clear();
      std::cerr << "mdprep: " << printable_line(path) << ": "
                << fixed_text(stats.time_to_image_ms(), 2) << " ms to the image" << heat_text(heat)
                << "\n";
    }
    request.counting = Counting::kOn;  // a second time, since counting slows a frame down
    const FrameStats counted = arguments.stats.empty() ? stats : renderer.trace(request);
    rows.push_back(stats_row(model, frames[i], stats, counted));
    if (heat.top > 0) rows.back()["heat_scale"] = {{"top", heat.top}, {"unit", heat.unit}};
  }
  if (film) film->finish();
  return rows;
}

void print_summary(const RenderArguments& arguments, const Json& rows) {
  std::vector<double> times;
  for (const Json& row : rows) times.push_back(row["time_to_image_ms"]);
  std::cerr << printable_line(arguments.output) << ": " << rows.size()
            << (rows.size() == 1 ? " frame" : " frames") << ", " << fixed_text(median(times), 2)
            << " ms to the image (median, " << arguments.technique << ", " << thread_count()
            << (thread_count() == 1 ? " thread, " : " threads, ") << isa_in_use() << ")\n";
}

void check_outputs(const RenderArguments& arguments, const std::vector<PlannedFrame>& frames) {
  if (frames.size() > 1 && !has_number_place(arguments.output) && !is_film(arguments.output))
    throw Error(
        ErrorCode::kUsage,
        arguments.output + ": " + std::to_string(frames.size()) +
            " frames need a place for their number, as in out_####.png; or choose one frame "
            "with --frames or --time");
  const std::string outputs[] = {numbered_path(arguments.output, frames.front().at.key0),
                                 arguments.stats};
  require_distinct_files(arguments.input, outputs);
  require_writable_place(outputs[0]);
  if (!arguments.stats.empty()) require_writable_place(arguments.stats);
}

void run_render(const RenderArguments& arguments, CommandContext& context) {
  const MachineLimits limits(arguments.machine);
  if (lower_extension(arguments.input) == ".mds") {
    if (!arguments.clip.empty())
      throw Error(ErrorCode::kUsage, "--clip " + arguments.clip +
                                         ": in a scene each instance plays a clip of its own");
    return render_scene({.input = arguments.input,
                         .output = arguments.output,
                         .stats = arguments.stats,
                         .frames = arguments.frames,
                         .time_seconds = arguments.time_seconds,
                         .shutter_seconds = arguments.shutter_seconds,
                         .technique = arguments.technique,
                         .cache_bytes = arguments.cache_bytes,
                         .view = arguments.view,
                         .messages = arguments.messages},
                        context);
  }
  const MdkFile file(arguments.input);
  const ModelView& model = file.model();
  const std::vector<PlannedFrame> frames = plan_frames(arguments, model);
  check_outputs(arguments, frames);
  const LoopCheck interrupts = context.interrupts.defer();
  const Json rows = render_frames(arguments, model, frames, context.overwrite);
  context.inputs = {arguments.input};
  if (is_film(arguments.output)) {
    context.outputs = {arguments.output};
  } else {
    for (const PlannedFrame& frame : frames)
      context.outputs.push_back(numbered_path(arguments.output, frame.at.key0));
  }
  if (!arguments.stats.empty()) {
    const Json report = {{"schema", "mdprep-render/1"},
                         {"file", arguments.input},
                         {"isa", isa_in_use()},
                         {"threads", thread_count()},
                         {"width", arguments.view.size.width},
                         {"height", arguments.view.size.height},
                         {"technique", arguments.technique},
                         {"shading", shading_id(arguments.view.shading)},
                         {"samples", arguments.view.samples},
                         {"between_keys", model.holds_between_keys},
                         {"frames", rows}};
    write_text_file(arguments.stats,
                    report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  if (!arguments.messages.quiet) print_summary(arguments, rows);
}

void add_frame_options(Command& command, RenderArguments& arguments) {
  command
      .add_value(
          "--frames", "A:B[:S]",
          "Keys from A to B, both included, every S-th (default step: 1). Keys count\n"
          "from 0 through all clips; 'mdprep info' lists them. Without --frames and\n"
          "--time: every key of the clip. Of a scene: so many thirtieths of a second from its\n"
          "first time on; without either: that time.",
          "", arguments.frames, parse_key_range)
      .excludes = {"--time", "--clip"};
  command.add_value(
      "--time", "T",
      "One frame at this time, in seconds from the start of the clip, or of the scene's\n"
      "clock. Its number is that of the key before it.",
      "", arguments.time_seconds, parse_real);
  command
      .add_text("--clip", "NAME",
                "The clip to render or that --time counts in (default: the first).", arguments.clip)
      .with(OptionEffect::kName);
}

}  // namespace

void add_render_command(Command& command) {
  const auto arguments = std::make_shared<RenderArguments>();
  command
      .add_text("FILE", "",
                "A .mdk file made by 'mdprep bake', or a .mds scene made by 'mdprep scene'.",
                arguments->input)
      .required()
      .with(OptionEffect::kFile);
  command
      .add_text("-o,--output", "out_####.png",
                "The PNG to write. A run of # becomes the number of the key, padded with zeros;\n"
                "more than one frame needs it. Or a film: a name that ends in .mp4, .mkv or\n"
                ".webm; needs the program ffmpeg.",
                arguments->output)
      .required()
      .with(OptionEffect::kFile);
  add_frame_options(command, *arguments);
  command.add_value("--technique", "ID",
                    "One of " + technique_ids() +
                        "\n(default: fuzzy-bvh). The picture is the same with each of ours.",
                    std::string(technique_table().front().id), arguments->technique,
                    parse_technique);
  add_view_options(command, arguments->view);
  command.add_value("--shutter", "S",
                    "How long the shutter is open, in seconds, half of it before the frame's time\n"
                    "(default: 0). Each of --samples has a time of its own, so moving parts blur.",
                    "0", arguments->shutter_seconds,
                    real_where([](double x) { return x >= 0; }, "seconds, 0 or more"));
  command
      .add_value("--cache", "SIZE",
                 "Of scenes: what is worked out of the instances that rays enter takes no more\n"
                 "memory than this, key poses included (default: 64M). Changes no picture.",
                 "64M", arguments->cache_bytes,
                 [](const std::string& text) { return parse_size(text); })
      .with(OptionEffect::kNone);
  command
      .add_text("--stats", "FILE",
                "Write times in ms and work per ray of every frame as JSON (mdprep-render/1).",
                arguments->stats)
      .with(OptionEffect::kFile);
  add_machine_options(command, arguments->machine);
  add_message_options(command, arguments->messages);
  add_verbose_option(command, arguments->messages);
  command.set_notes(
      "Example:\n"
      "  mdprep render hand.mdk -o hand_####.png --frames 0:29:2 --size 800x600\n"
      "  mdprep render hand.mdk -o hand.mp4 --frames 0:60\n"
      "  mdprep render stadium.mds -o stadium.png --time 1 --size 1920x1080\n"
      "  mdprep render fox.mdk -o fox.png --clip Run --time 0.4 --camera \"0 80 250 0 40 0 0 1 0 "
      "45\"");
  command.set_body([arguments](CommandContext& context) { run_render(*arguments, context); });
}

}  // namespace mdk
