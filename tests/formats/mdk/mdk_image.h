// A .mdk file taken apart in memory, by the offsets of docs/file-format.md rather than by the types
// of formats/mdk/layout.h, and put together again with valid checksums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/formats/temp_folder.h"

namespace mdk::test {

inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kEntryBytes = 40;

template <class T>
T get(const Bytes& bytes, std::size_t at);
template <class T>
void put(Bytes& bytes, std::size_t at, T value);

struct ImageSection {
  std::string id;
  std::uint32_t flags = 1;
  std::uint32_t element_bytes = 1;
  std::uint64_t element_count = 0;
  std::uint64_t offset = 0;
  std::uint64_t checksum = 0;
  std::uint64_t bytes() const { return element_count * element_bytes; }
};

std::vector<ImageSection> read_table(const Bytes& file);

/// The section with this id; throws std::out_of_range where there is none.
ImageSection find_section(const Bytes& file, const std::string& id);

/// Where its entry stands in the table.
std::size_t entry_offset(const Bytes& file, const std::string& id);

/// Makes the header's checksum right again.
void seal(Bytes& file);

/// The file with one more section at its end, sealed.
Bytes with_section(const Bytes& file, const ImageSection& section, const Bytes& content);

}  // namespace mdk::test
