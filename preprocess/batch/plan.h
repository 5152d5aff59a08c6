// Turns a manifest into jobs: looks up patterns, fills in names, cuts long sequences.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "preprocess/batch/manifest.h"

namespace mdk {

/// One thing an engine starts, and what it must know of it. All paths are relative to the
/// manifest's folder.
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

/// Throws the Error of a command line that mdprep does not take.
using CommandCheck = std::function<void(const std::vector<std::string>& words)>;

/// Bakes, then verifies, then renders, each in the manifest's order and files sorted by bytes. A
/// verify's or render's pattern is matched with what is baked here, and only where it names none of
/// that with the files there are. Throws Error (kBadInput) naming the place: a pattern that names
/// no file, two jobs with one output, or what `check` throws for a job's command.
std::vector<Job> plan_jobs(const Manifest& manifest, const CommandCheck& check);

}  // namespace mdk
