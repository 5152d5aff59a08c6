#include "preprocess/tool/shared_options.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>

#include "common/base/isa.h"
#include "common/trace/technique.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr CountRange kThreadRange{1, 1024};
constexpr CountRange kSampleRange{1, kMaxSamples};
constexpr CountRange kOcclusionRange{0, kMaxOcclusionRays};

std::string shading_ids() {
  std::string ids;
  for (const ShadingInfo& mode : shading_table())
    ids += (ids.empty() ? "" : ", ") + std::string(mode.id);
  return ids;
}

std::uint32_t parse_side(std::string_view text) {
  std::uint64_t side = 0;
  const char* end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, side);
  const bool digits_only = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return c >= '0' && c <= '9';
  });
  const bool too_long = digits_only && problem == std::errc::result_out_of_range;
  if (!too_long && (problem != std::errc{} || stop != end || side == 0))
    throw expected("a width and a height in pixels, as in 512x512");
  if (too_long || side > kMaxImageSide)
    throw Error(ErrorCode::kOverLimit,
                "the longest side of a picture is " + std::to_string(kMaxImageSide) + " pixels");
  return static_cast<std::uint32_t>(side);
}

}  // namespace

void add_machine_options(Command& command, MachineOptions& options) {
  command
      .add_value("--threads", "all|N",
                 "How many threads to use, 1 to 1024, or all (default: all).\n"
                 "Results do not depend on it.",
                 "all", options.threads, parse_threads)
      .with(OptionEffect::kNone);
  command
      .add_text("--isa", "sse4|avx2|avx512|neon",
                "Use no more than this instruction set (default: the best there is). One that\n"
                "this machine lacks is refused.",
                options.isa)
      .with(OptionEffect::kNone);
  command
      .add_value("--memory-limit", "none|SIZE",
                 "Give up with status 5 rather than use more memory than this, as in 512M or\n"
                 "1.5G (default: none).",
                 "none", options.memory_limit_bytes,
                 [](const std::string& text) { return text == "none" ? 0 : parse_size(text); })
      .with(OptionEffect::kNone);
}

int parse_threads(std::string_view text) {
  return text == "all" ? 0 : static_cast<int>(parse_count(text, kThreadRange));
}

MachineLimits::MachineLimits(const MachineOptions& options)
    : threads_(options.threads), memory_(options.memory_limit_bytes) {
  if (!options.isa.empty()) limit_isa(options.isa);
}

void add_message_options(Command& command, MessageOptions& options) {
  command.add_flag("-q,--quiet", "No progress, no summary, no notes.", options.quiet)
      .with(OptionEffect::kNone);
  command
      .add_value("--progress", "auto|always|plain|never",
                 "auto: a bar where stderr is a terminal, plain lines otherwise; always: a bar in\n"
                 "any case; plain: lines in any case, as logs want them; never: nothing\n"
                 "(default: auto).",
                 "auto", options.progress,
                 one_of<std::optional<ProgressStyle>>({{"auto", std::nullopt},
                                                       {"always", ProgressStyle::kBar},
                                                       {"plain", ProgressStyle::kLines},
                                                       {"never", ProgressStyle::kNone}}))
      .with(OptionEffect::kNone);
}

void add_verbose_option(Command& command, MessageOptions& options) {
  Option& verbose = command.add_flag("-v,--verbose", "Tell more on stderr.", options.verbose);
  verbose.excludes = {"--quiet"};
  verbose.with(OptionEffect::kNone);
}

ProgressStyle progress_style(const MessageOptions& options) {
  if (options.quiet) return ProgressStyle::kNone;
  if (options.progress) return *options.progress;
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

void add_view_options(Command& command, ViewOptions& options) {
  command.add_value("--size", "WxH",
                    "Width and height in pixels, 1 to " + std::to_string(kMaxImageSide) +
                        " each (default: 512x512).",
                    "512x512", options.size, parse_image_size);
  command.add_value(
      "--camera", "\"EYE TARGET UP FOV\"",
      "Ten numbers in one argument: eye xyz, target xyz, up xyz, and the vertical\n"
      "field of view in degrees (default: the model fits at all times of the clips shown).",
      "", options.camera, parse_camera);
  command.add_value("--shading", "MODE", "One of " + shading_ids() + " (default: diffuse).",
                    "diffuse", options.shading, find_shading);
  command.add_value("--samples", "N",
                    "Samples per pixel, 1 to " + std::to_string(kSampleRange.highest) +
                        ", averaged for smooth edges and soft light (default: 1).\nTimes are for "
                        "all of them.",
                    "1", options.samples, parse_samples);
  const std::string usual = std::to_string(kOcclusionRays);
  command.add_value("--ao", "N",
                    "Rays per sample that see how much sky is open (ambient occlusion) in "
                    "--shading lit,\n0 to " +
                        std::to_string(kOcclusionRange.highest) + " (default: " + usual +
                        "); 0: shadows alone.",
                    usual, options.occlusion_rays, parse_occlusion_rays);
}

ImageSize parse_image_size(std::string_view text) {
  const std::size_t cross = text.find('x');
  const std::string_view height =
      cross == std::string_view::npos ? std::string_view() : text.substr(cross + 1);
  return {parse_side(text.substr(0, cross)), parse_side(height)};
}

Camera parse_camera(std::string_view text) {
  std::string spaced(text);
  for (const char separator : {',', '\t', '\n'})
    std::replace(spaced.begin(), spaced.end(), separator, ' ');
  const auto wrong = [](const std::string& found) {
    return expected(
        "ten numbers (eye xyz, target xyz, up xyz, vertical field of view in degrees), not " +
        found);
  };
  std::vector<float> n;
  for (const std::string& word : split(spaced, ' ')) try {
      if (!word.empty()) n.push_back(static_cast<float>(parse_real(word)));
    } catch (const Error&) {
      throw wrong("\"" + word + "\"");
    }
  if (n.size() != 10) throw wrong(std::to_string(n.size()));
  const Camera camera{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, n[9]};
  make_pinhole_rays(camera, 1, 1);  // refuses a camera that sees nothing
  return camera;
}

std::uint32_t parse_samples(std::string_view text) { return parse_count(text, kSampleRange); }

std::uint32_t parse_occlusion_rays(std::string_view text) {
  return parse_count(text, kOcclusionRange);
}

Camera choose_camera(const ViewOptions& options, const Aabb& bounds) {
  if (options.camera) return *options.camera;
  return fit_camera(bounds, static_cast<double>(options.size.width) / options.size.height);
}

std::string parse_technique(std::string_view text) { return std::string(find_technique(text).id); }

std::vector<std::string> parse_techniques(std::string_view text) {
  std::vector<std::string> ids;
  for (const std::string& id : split(text, ',')) {
    if (id == "all" && ids.empty()) {
      for (const TechniqueInfo& technique : technique_table())
        if (technique.kind != TechniqueKind::kOracle) ids.emplace_back(technique.id);
    } else if (id.starts_with('-')) {
      std::erase(ids, parse_technique(id.substr(1)));
    } else if (std::find(ids.begin(), ids.end(), id) != ids.end()) {
      throw Error(ErrorCode::kUsage, id + " is named twice");
    } else {
      ids.push_back(parse_technique(id));
    }
  }
  if (ids.empty()) throw Error(ErrorCode::kUsage, "leaves no technique to measure");
  return ids;
}

std::string technique_ids() {
  std::string ids;
  for (const TechniqueInfo& technique : technique_table())
    ids += (ids.empty() ? "" : ", ") + std::string(technique.id);
  return ids;
}

KeyRange parse_key_range(std::string_view text) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() > 3) throw expected("A:B or A:B:S, as in 0:29:2");
  constexpr CountRange kAnyKey{0, 0xffffffffu};
  KeyRange range;
  range.first = parse_count(parts[0], kAnyKey);
  range.last = parts.size() > 1 ? parse_count(parts[1], kAnyKey) : range.first;
  if (parts.size() > 2) range.step = parse_count(parts[2], {});
  if (range.first > range.last)
    throw Error(ErrorCode::kUsage, "the first key lies past the last; write the smaller one first");
  return range;
}

std::vector<std::uint32_t> KeyRange::keys(std::uint32_t key_count) const {
  if (last >= key_count)
    throw Error(ErrorCode::kUsage, "the file has keys 0 to " + std::to_string(key_count - 1));
  std::vector<std::uint32_t> keys;
  for (std::uint64_t key = first; key <= last; key += step)
    keys.push_back(static_cast<std::uint32_t>(key));
  return keys;
}

std::vector<std::uint32_t> spread_keys(std::uint32_t count, std::uint32_t key_count) {
  const std::uint64_t chosen = std::min(count, key_count);
  std::vector<std::uint32_t> keys;
  for (std::uint64_t i = 0; i < chosen; ++i)
    keys.push_back(chosen == 1 ? 0
                               : static_cast<std::uint32_t>(i * (key_count - 1) / (chosen - 1)));
  return keys;
}

}  // namespace mdk
