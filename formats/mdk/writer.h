// Writes a model as one .mdk image (docs/file-format.md).
#pragma once

#include <string>

#include "common/base/parallel.h"
#include "common/motion/model.h"
#include "formats/files/atomic_file.h"
#include "formats/mdk/mdk_file.h"

namespace mdk {

struct MdkWriteOptions {
  MdkOrigin origin;
  Overwrite overwrite = Overwrite::kAlways;
  ProgressSink* progress = nullptr;  ///< receives stage "write", where given
};

/// Writes the whole file or nothing: a temporary name in the same folder, fsync, rename. The bytes
/// depend on the model and the origin alone. Returns the file's size in bytes. Throws Error (kIo)
/// naming `path`.
std::uint64_t write_mdk(const ModelView& model, const std::string& path,
                        const MdkWriteOptions& options = {});

}  // namespace mdk
