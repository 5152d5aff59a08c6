// Writes a model as one .mdk image (docs/file-format.md).
#pragma once

#include <string>

#include "common/motion/model.h"

namespace mdk {

/// Writes the whole file or nothing: a temporary name in the same folder, fsync, rename. The bytes
/// depend on the model alone. Returns the file's size in bytes. Throws Error (kIo) naming `path`.
std::uint64_t write_mdk(const Model& model, const std::string& path);

}  // namespace mdk
