// Files that a file names: they stand in its own folder, or below it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace mdk {

inline constexpr std::size_t kMaxNameBytes = 1000;

/// Where `name` leads from the folder of `file`. Nothing where it is empty, absolute, longer than
/// any name, or leaves the folder. Names are judged, not links: a link inside the folder is whoever
/// made the folder's decision.
inline std::optional<std::string> neighbor_path(const std::string& file, const std::string& name) {
  if (name.size() > kMaxNameBytes || name.find('\0') != std::string::npos) return std::nullopt;
  const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
  if (relative.is_absolute() || relative.empty() || *relative.begin() == ".." ||
      *relative.begin() == ".")
    return std::nullopt;
  return (std::filesystem::path(file).parent_path() / relative).string();
}

}  // namespace mdk
