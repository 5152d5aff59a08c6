// Writes rendered pictures as PNG.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "formats/files/atomic_file.h"

namespace mdk {

/// `pixels`: width * height sRGB RGBA, 8 bits each with red lowest, row 0 on top; alpha is dropped.
/// Whole file or nothing (temporary name, fsync, rename). Throws Error (kIo).
void write_png(const std::string& path, std::uint32_t width, std::uint32_t height,
               std::span<const std::uint32_t> pixels, Overwrite overwrite = Overwrite::kAlways);

}  // namespace mdk
