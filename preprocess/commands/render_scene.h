// mdprep render of scenes: what its options mean for a .mds file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "preprocess/commands/command_line.h"
#include "preprocess/tool/shared_options.h"

namespace mdk {

/// Frames of a scene, by number, are so many a second of its clock, from its first time on.
inline constexpr double kSceneFrameRate = 30;

struct SceneRenderArguments {
  std::string input, output, stats;
  std::optional<KeyRange> frames;
  std::optional<double> time_seconds;
  double shutter_seconds = 0;
  std::string technique;
  std::uint64_t cache_bytes = 0;
  ViewOptions view;
  MessageOptions messages;
};

/// Renders and writes what was asked for.
void render_scene(const SceneRenderArguments& arguments, CommandContext& context);

}  // namespace mdk
