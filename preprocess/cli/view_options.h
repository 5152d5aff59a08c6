// What a picture is of and how it is made: size, camera and shading, as options of several
// subcommands.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/aabb.h"
#include "common/trace/camera.h"
#include "common/trace/renderer.h"

namespace CLI {
class App;
}

namespace mdk {

struct ViewOptions {
  std::string size = "512x512";
  std::string camera;  ///< empty: all of the clip's bounds fit the picture
  std::string shading = "diffuse";
  std::string samples = "1";
  std::string occlusion_rays = std::to_string(kOcclusionRays);
};
void add_view_options(CLI::App& command, ViewOptions& options);

/// What --shading, --samples and --ao say; throws Error (kUsage).
void choose_shading(const ViewOptions& options, FrameRequest& request);

struct ImageSize {
  std::uint32_t width = 0, height = 0;
};

/// "WxH", each side 1 to kMaxImageSide. Throws Error: kUsage, or kOverLimit past the largest side.
ImageSize parse_image_size(std::string_view text);

/// Ten numbers, separated by spaces or commas: eye, target, up, vertical field of view in degrees.
/// Throws Error (kUsage).
Camera parse_camera(std::string_view text);

/// The camera that was asked for, or one that shows all of `bounds`.
Camera choose_camera(const ViewOptions& options, const Aabb& bounds, ImageSize size);

/// "fuzzy-kdtree, static-kdtree, ...": for help texts.
std::string technique_ids();

/// A list with commas; "all" stands for every technique but brute force, and "-ID" takes one out of
/// those before it. Throws Error (kUsage).
std::vector<std::string> parse_techniques(const std::string& text);

}  // namespace mdk
