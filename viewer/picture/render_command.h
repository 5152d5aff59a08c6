// The mdprep render command line that makes the viewer's picture again, without a window.
#pragma once

#include <string>
#include <vector>

#include "viewer/picture/render_worker.h"

namespace mdk {

/// "mdprep render walk.mdk -o walk.png --clip ... --camera ...", words quoted as a shell needs it:
/// the same pixels as the job's, to the last one. `path` is what is open: for a source file, the
/// .mdk beside it is named. `clip` and `time` (seconds) are what the job's moment stands for.
std::string render_command(const RenderJob& job, const std::string& path, const std::string& clip,
                           double time);

/// The options of "mdprep render" that say how: size, technique, shading, camera.
std::vector<std::string> render_options(const RenderJob& job);

/// In single quotes unless it is plain enough to stand alone.
std::string shell_word(const std::string& word);

}  // namespace mdk
