#include "preprocess/cli/view_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>

#include "common/base/error.h"
#include "common/trace/technique.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

constexpr CountRange kSampleRange{1, kMostSamples};
constexpr CountRange kOcclusionRange{0, kMostOcclusionRays};

std::uint32_t parse_side(std::string_view whole, std::string_view text) {
  std::uint64_t side = 0;
  const char* end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, side);
  const bool digits_only = !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return c >= '0' && c <= '9';
  });
  const bool too_long = digits_only && problem == std::errc::result_out_of_range;
  if (!too_long && (problem != std::errc{} || stop != end || side == 0))
    throw Error(ErrorCode::kUsage, "--size " + std::string(whole) +
                                       ": expected a width and a height in pixels, as in 512x512");
  if (too_long || side > kMaxImageSide)
    throw Error(ErrorCode::kOverLimit, "--size " + std::string(whole) +
                                           ": the longest side of a picture is " +
                                           std::to_string(kMaxImageSide) + " pixels");
  return static_cast<std::uint32_t>(side);
}

}  // namespace

void add_view_options(CLI::App& command, ViewOptions& options) {
  command
      .add_option("--size", options.size,
                  "Width and height in pixels, 1 to " + std::to_string(kMaxImageSide) +
                      " each (default: 512x512).")
      ->type_name("WxH");
  command
      .add_option(
          "--camera", options.camera,
          "Ten numbers in one argument: eye xyz, target xyz, up xyz, and the vertical\n"
          "field of view in degrees (default: the model fits at all times of the clips shown).")
      ->type_name("\"EYE TARGET UP FOV\"");
  std::string modes;
  for (const ShadingInfo& mode : shading_table())
    modes += (modes.empty() ? "" : ", ") + std::string(mode.id);
  command.add_option("--shading", options.shading, "One of " + modes + " (default: diffuse).")
      ->type_name("MODE");
  command
      .add_option("--samples", options.samples,
                  "Samples per pixel, 1 to " + std::to_string(kSampleRange.highest) +
                      ", averaged for smooth edges and soft light (default: 1).\nTimes are for all "
                      "of them.")
      ->type_name("N");
  command
      .add_option("--ao", options.occlusion_rays,
                  "Rays per sample that see how much sky is open (ambient occlusion) in --shading "
                  "lit,\n0 to " +
                      std::to_string(kOcclusionRange.highest) +
                      " (default: " + std::to_string(kOcclusionRays) + "); 0: shadows alone.")
      ->type_name("N");
}

void choose_shading(const ViewOptions& options, FrameRequest& request) {
  request.shading = find_shading(options.shading);
  request.samples = parse_count("--samples", options.samples, kSampleRange);
  request.occlusion_rays = parse_count("--ao", options.occlusion_rays, kOcclusionRange);
}

ImageSize parse_image_size(std::string_view text) {
  const std::size_t cross = text.find('x');
  const std::string_view height =
      cross == std::string_view::npos ? std::string_view() : text.substr(cross + 1);
  return {parse_side(text, text.substr(0, cross)), parse_side(text, height)};
}

Camera parse_camera(std::string_view text) {
  std::string spaced(text);
  std::replace(spaced.begin(), spaced.end(), ',', ' ');
  std::vector<float> numbers;
  for (const std::string& word : split(spaced, ' '))
    if (!word.empty()) numbers.push_back(static_cast<float>(parse_real("--camera", word)));
  if (numbers.size() != 10)
    throw Error(
        ErrorCode::kUsage,
        "--camera: expected ten numbers (eye xyz, target xyz, up xyz, vertical field of view "
        "in degrees), not " +
            std::to_string(numbers.size()));
  Camera camera;
  camera.eye = {numbers[0], numbers[1], numbers[2]};
  camera.target = {numbers[3], numbers[4], numbers[5]};
  camera.up = {numbers[6], numbers[7], numbers[8]};
  camera.vertical_fov_deg = numbers[9];
  make_pinhole_rays(camera, 1, 1);  // refuses a camera that sees nothing
  return camera;
}

Camera choose_camera(const ViewOptions& options, const Aabb& bounds, ImageSize size) {
  if (!options.camera.empty()) return parse_camera(options.camera);
  return fit_camera(bounds, static_cast<double>(size.width) / size.height);
}

std::string technique_ids() {
  std::string ids;
  for (const TechniqueInfo& technique : technique_table())
    ids += (ids.empty() ? "" : ", ") + std::string(technique.id);
  return ids;
}

std::vector<std::string> parse_techniques(const std::string& text) {
  std::vector<std::string> ids;
  for (const std::string& id : split(text, ',')) {
    if (id == "all" && ids.empty()) {
      for (const TechniqueInfo& technique : technique_table())
        if (technique.kind != TechniqueKind::kOracle) ids.emplace_back(technique.id);
      continue;
    }
    if (id.starts_with('-')) {
      find_technique(id.substr(1));
      std::erase(ids, id.substr(1));
      continue;
    }
    find_technique(id);
    if (std::find(ids.begin(), ids.end(), id) != ids.end())
      throw Error(ErrorCode::kUsage, "--techniques " + text + ": " + id + " is named twice");
    ids.push_back(id);
  }
  if (ids.empty())
    throw Error(ErrorCode::kUsage, "--techniques " + text + ": leaves no technique to measure");
  return ids;
}

}  // namespace mdk
