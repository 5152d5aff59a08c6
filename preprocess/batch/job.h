// Job: one thing an engine starts, and what it must know of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace mdk {

enum class JobKind { kBake, kVerify, kRender };
inline constexpr JobKind kJobKinds[] = {JobKind::kBake, JobKind::kVerify, JobKind::kRender};

/// "bake", "verify", "render".
const char* kind_name(JobKind kind);

/// All paths are relative to the manifest's folder.
struct Job {
  JobKind kind = JobKind::kBake;
  std::string place;                 ///< in the manifest, a JSON pointer
  std::vector<std::string> command;  ///< words after "mdprep", without machine and messages
  std::string record;                ///< a file; unique among jobs
  std::vector<std::string> inputs;   ///< known ahead; the job finds textures and buffers itself
  std::vector<std::string> outputs;  ///< known ahead; a render of all keys has none
  std::vector<std::size_t> needs;    ///< jobs whose outputs it reads
  std::uint32_t threads = 1;
  std::uint64_t memory_bytes = 0;
  std::uint32_t minutes = 0;
};

}  // namespace mdk
