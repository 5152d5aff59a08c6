// MdsFile: a .mds scene that is open, with its models. It maps the file, checks everything tracing
// relies on, and gives a Stage whose spans point into the mapping (docs/scene-file.md).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/scene/scene.h"
#include "formats/files/sections.h"

namespace mdk {

/// A model as a scene names it.
struct SceneModelFile {
  std::string name;           ///< path of the .mdk from the scene's folder, '/' between folders
  std::uint64_t content = 0;  ///< MdkFile::content_hash()
};

class MdsFile {
 public:
  /// Maps and checks the file and opens its models. Cost: a pass over instances and keys, and
  /// opening each model. Throws Error: kIo (cannot read the file or a model), kBadInput (not an
  /// .mds, another version, cut or inconsistent; a model that was baked anew; the sentence says
  /// where).
  explicit MdsFile(const std::string& path);
  ~MdsFile();
  MdsFile(MdsFile&&) noexcept;
  MdsFile& operator=(MdsFile&&) noexcept;

  /// These are valid while this lives.
  const Stage& stage() const;
  const SceneView& scene() const { return stage().scene(); }
  const std::string& path() const;
  std::span<const SceneModelFile> model_files() const;
  /// Where a model was opened.
  std::string model_path(std::uint32_t model) const;

  std::uint64_t file_bytes() const;
  std::array<std::uint16_t, 3> tool_version() const;  ///< zeros: not known
  std::uint64_t options_hash() const;                 ///< zero: not known
  std::vector<SectionInfo> sections() const;

  /// See MdkFile; of the scene alone.
  void verify_checksums() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What a scene may not hold, apart from its models' clips: a sentence that begins with the name of
/// a section, or nothing. What MdsFile asks about files, and write_mds about our own work.
std::string find_scene_fault(const SceneView& scene, std::span<const SceneModelFile> files);

}  // namespace mdk
