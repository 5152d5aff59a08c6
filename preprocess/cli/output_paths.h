// Refuses outputs that cannot work before any time is spent on making them.
#pragma once

#include <span>
#include <string>

namespace mdk {

/// Throws Error (kIo) where `path` cannot become a file: its folder is missing or not writable, or
/// it is a folder itself.
void require_writable_place(const std::string& path);

/// Throws Error (kUsage) where two outputs, or an output and `input`, are one file. Empty outputs
/// stand for outputs that were not asked for.
void require_distinct_files(const std::string& input, std::span<const std::string> outputs);

}  // namespace mdk
