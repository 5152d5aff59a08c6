// A folder with a manifest, sources to bake, and the means to plan and run its jobs.
#pragma once

#include <string>
#include <vector>

#include "preprocess/batch/plan.h"
#include "tests/commands/program_run.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {

class BatchFolder {
 public:
  std::string path() const { return folder_.path(); }
  std::string file(const std::string& name) const { return folder_.file(name); }
  bool has(const std::string& name) const;
  /// Makes the folders it lies in, too.
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const { return read_text(file(name)); }

  /// A strip of triangles with a texture of one pixel beside it, that waves with `seed`: baked in a
  /// blink. Files NAME.gltf, NAME.bin, NAME.png.
  void write_source(const std::string& name, int seed) const;

  std::string manifest() const { return file("batch.json"); }
  void write_manifest(const std::string& json) const { write("batch.json", json); }
  std::vector<Job> plan() const;

  /// mdprep batch MANIFEST options…
  Outcome batch(std::vector<std::string> options) const;

  /// Runs a line of shell in this folder; status, stdout and stderr.
  Outcome shell(const std::string& line) const;

  /// Time stamp in nanoseconds since some moment.
  long long time_stamp(const std::string& name) const;

  /// Content of every file below, but for records and what engines keep for themselves.
  std::vector<std::string> made_files(const std::string& below) const;

 private:
  TempFolder folder_;
};

/// Whether a program of this name is on the PATH.
bool has_program(const std::string& name);

}  // namespace mdk::test
