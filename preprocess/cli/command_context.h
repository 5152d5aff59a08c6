// CommandContext: what a command is told by whoever starts it, and what it tells back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/atomic_file.h"

namespace mdk {

struct CommandContext {
  Overwrite overwrite = Overwrite::kAlways;  ///< how to write outputs
  std::uint64_t options_hash = 0;            ///< of the options that shape the content of outputs

  // Filled in by bake, verify and render.
  std::vector<std::string> inputs;   ///< every file that was read
  std::vector<std::string> unread;   ///< files that would have been, could they be read: images
  std::vector<std::string> outputs;  ///< every file that was made, but for reports
  std::string report;                ///< JSON, or empty
};

}  // namespace mdk
