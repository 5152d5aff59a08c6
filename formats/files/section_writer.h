// Writes files made of sections.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "formats/files/atomic_file.h"
#include "formats/files/sections.h"

namespace mdk {

/// What stands in one section; it must stay until the file is written.
struct SectionContent {
  std::uint32_t id = 0;
  std::uint32_t element_bytes = 1;
  std::span<const std::byte> bytes;

  template <class T>
  static SectionContent of(std::uint32_t id, std::span<const T> elements) {
    return {id, sizeof(T), std::as_bytes(elements)};
  }
};

/// Writes the sections one after another, each on its own cache line, all of them needed. `header`
/// says what made the file; the rest of it is filled in here. Returns the size of the file. Throws
/// Error (kIo).
std::uint64_t write_sections(const std::string& path, const layout::FileFormat& format,
                             layout::FileHeader header, std::span<const SectionContent> sections,
                             Overwrite overwrite, ProgressSink* progress = nullptr);

}  // namespace mdk
