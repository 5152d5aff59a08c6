// Manifest: a list of bakes, verifies and renders as its author wrote it (docs/farm.md), checked
// and with defaults filled in, but patterns not yet looked up.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace mdk {

enum class JobKind { kBake, kVerify, kRender };
inline constexpr JobKind kJobKinds[] = {JobKind::kBake, JobKind::kVerify, JobKind::kRender};

/// "bake", "verify", "render".
const char* kind_name(JobKind kind);

struct ManifestItem {
  JobKind kind = JobKind::kBake;
  std::string place;                 ///< a JSON pointer: "/bakes/3"
  std::vector<std::string> inputs;   ///< the first may be a pattern, all have {stem} and {folder}
  std::vector<std::string> exclude;  ///< patterns
  std::string output;
  std::string frames;                ///< of renders: "A:B[:S]", or empty for all keys
  std::uint32_t frames_per_job = 0;  ///< 0: all in one
  bool with_source = false;          ///< of verifies: read what was baked again, and compare
  std::vector<std::string> options;  ///< words: "--fps=24"
  std::uint32_t threads = 1;
  std::uint64_t memory_bytes = 0;
  std::uint32_t minutes = 0;  ///< 0: not said
};

struct Manifest {
  std::string path;
  std::string folder;   ///< all paths in it are relative to this; "." for the one we are in
  std::string records;  ///< folder of records
  std::vector<ManifestItem> items;
};

/// Throws Error: kIo, or kBadInput with the place as a JSON pointer.
Manifest read_manifest(const std::string& path);

/// An Error (kBadInput) about a place in the manifest.
[[noreturn]] void refuse_place(const Manifest& manifest, const std::string& place,
                               const std::string& sentence);

}  // namespace mdk
