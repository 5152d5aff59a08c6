// MdkFile: an .mdk image that is open. It maps the file, checks everything tracing relies on, and
// gives a ModelView whose spans point into the mapping (docs/file-format.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/motion/model.h"
#include "formats/files/sections.h"

namespace mdk {

/// What read the source, as the file counts it.
enum class SourceReader : std::uint16_t { kMdprep = 0, kAssimp = 1 };

/// All zeros: not known.
struct MdkOrigin {
  std::array<std::uint16_t, 3> version = {};  ///< of the program: major, minor, patch
  std::uint64_t options_hash = 0;             ///< XXH3 of the options that shape the content
  SourceReader reader = SourceReader::kMdprep;

  bool operator==(const MdkOrigin&) const = default;
};

/// Whether a model may be traced without asking again: all that docs/file-format.md demands of
/// counts, ranges, links and numbers. MdkFile asks it about files from outside, write_mdk about our
/// own work. Empty, or the first thing that is wrong ("clusters: cluster 3 does not start where the
/// last one ended"). Does not look at positions, texture coordinates, colours or texels. Cost: one
/// pass over everything else.
std::string find_inconsistency(const ModelView& model);

class MdkFile {
 public:
  /// Maps and checks the file. Cost: a pass over the tables and links; positions and texels are not
  /// touched. Throws Error: kIo (cannot read), kBadInput (not an .mdk, another version, cut, or
  /// inconsistent; the sentence says where).
  explicit MdkFile(const std::string& path);
  ~MdkFile();
  MdkFile(MdkFile&&) noexcept;
  MdkFile& operator=(MdkFile&&) noexcept;

  /// Valid while this lives.
  const ModelView& model() const;
  const std::string& path() const;
  std::uint64_t file_bytes() const;
  /// The whole image, as it stands in the file.
  std::span<const std::byte> bytes() const;
  /// What made it, where the file says so.
  MdkOrigin origin() const;
  /// Differs where any byte of the content does, but for chance: the checksum over all sections'
  /// checksums.
  std::uint64_t content_hash() const;
  std::vector<SectionInfo> sections() const;

  /// Compares every section's contents with its stored checksum; throws Error (kBadInput) naming
  /// the first one that differs. Reads the whole file.
  void verify_checksums() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mdk
