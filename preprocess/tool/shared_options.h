// Options that mean the same in several commands: threads, instruction set and memory; what is told
// on the way; what a picture is of and how it is made; which keys of the animation are meant.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/parallel.h"
#include "common/math/aabb.h"
#include "common/trace/camera.h"
#include "common/trace/renderer.h"
#include "preprocess/tool/command.h"
#include "preprocess/tool/memory_limit.h"
#include "preprocess/tool/progress_bar.h"

namespace mdk {

struct MachineOptions {
  int threads = 0;                       ///< 0: all
  std::string isa;                       ///< empty: the best there is
  std::uint64_t memory_limit_bytes = 0;  ///< 0: none
};
void add_machine_options(Command& command, MachineOptions& options);

/// "all", or 1 to 1024; 0 stands for all.
int parse_threads(std::string_view text);

/// Holds the process to the threads, the instruction set and the memory that were asked for while
/// it lives. Throws Error: kUsage, or kOverLimit for memory that cannot be enough.
class MachineLimits {
 public:
  explicit MachineLimits(const MachineOptions& options);
  const MemoryLimit& memory() const { return memory_; }

 private:
  ThreadLimit threads_;
  MemoryLimit memory_;
};

struct MessageOptions {
  bool quiet = false;
  bool verbose = false;
  std::optional<ProgressStyle> progress;  ///< none: as stderr is a terminal or not
};
void add_message_options(Command& command, MessageOptions& options);
/// Only for subcommands that have more to tell.
void add_verbose_option(Command& command, MessageOptions& options);

/// What --progress and -q come to.
ProgressStyle progress_style(const MessageOptions& options);

struct ImageSize {
  std::uint32_t width = 0, height = 0;
};

struct ViewOptions {
  ImageSize size;
  std::optional<Camera> camera;  ///< none: all of the clip's bounds fit the picture
  ShadingMode shading = ShadingMode::kDiffuse;
  std::uint32_t samples = 1, occlusion_rays = 0;
};
void add_view_options(Command& command, ViewOptions& options);

/// "WxH", each side 1 to kMaxImageSide. Throws Error: kUsage, or kOverLimit past the largest side.
ImageSize parse_image_size(std::string_view text);

/// Ten numbers, separated by blanks or commas: eye, target, up, vertical field of view in degrees.
/// Throws Error (kUsage).
Camera parse_camera(std::string_view text);

/// 1 to kMaxSamples, and 0 to kMaxOcclusionRays. Throw Error (kUsage).
std::uint32_t parse_samples(std::string_view text);
std::uint32_t parse_occlusion_rays(std::string_view text);

/// The camera that was asked for, or one that shows all of `bounds`.
Camera choose_camera(const ViewOptions& options, const Aabb& bounds);

/// The id itself, of a technique that there is. Throws Error (kUsage).
std::string parse_technique(std::string_view text);

/// A list with commas; "all" stands for every technique but brute force, and "-ID" takes one out of
/// those before it. Throws Error (kUsage).
std::vector<std::string> parse_techniques(std::string_view text);

/// "fuzzy-kdtree, static-kdtree, ...": for help texts.
std::string technique_ids();

/// Keys from `first` to `last`, both included, every step-th. They count through all clips.
struct KeyRange {
  std::uint32_t first = 0, last = 0, step = 1;

  /// Throws Error (kUsage) where `last` is not below `key_count`.
  std::vector<std::uint32_t> keys(std::uint32_t key_count) const;
};

/// "A:B", "A:B:S" or "A". Throws Error (kUsage) where it is something else, or A lies past B.
KeyRange parse_key_range(std::string_view text);

/// min(count, key_count) keys spread evenly, the first and the last among them; rising.
std::vector<std::uint32_t> spread_keys(std::uint32_t count, std::uint32_t key_count);

}  // namespace mdk
