// HostileFile: a sample's .mdk file, damaged again and again, and what opening it gives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/motion/model.h"
#include "tests/formats/mdk/sample_model.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {

/// Part of a file: [begin, end).
struct ByteRange {
  std::string name;
  std::size_t begin = 0, end = 0;
};

class HostileFile {
 public:
  explicit HostileFile(const ModelStorage& sample = sample_model());
  ~HostileFile();
  HostileFile(const HostileFile&) = delete;
  HostileFile& operator=(const HostileFile&) = delete;

  /// The undamaged file.
  const Bytes& bytes() const { return bytes_; }
  /// Header and table first, then every section by its id.
  std::vector<ByteRange> ranges() const;
  /// The undamaged file with one 32-bit word replaced, sealed again.
  Bytes with_word(std::size_t at, std::uint32_t word) const;
  /// The undamaged file with one bit flipped; not sealed.
  Bytes with_flip(std::size_t at, int bit) const;

  /// Puts `bytes` in the file and opens it. Nothing where it is refused with kBadInput; any other
  /// exception fails the test. A copy where it is not: each list stands in a block of its own,
  /// where AddressSanitizer sees one step outside (in the mapping it would see the neighbour).
  std::optional<ModelStorage> open(const Bytes& bytes);

 private:
  TempFolder folder_;
  std::string path_;
  Bytes bytes_;
  int descriptor_;
};

/// Words that upset sizes, links and numbers.
std::vector<std::uint32_t> extreme_words();

}  // namespace mdk::test
