// The section table of a mapped .mdk file: reading it, and finding sections in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "formats/mdk_layout.h"

namespace mdk {

/// XXH3, 64 bits, of a piece of memory.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// What stands in `FileHeader::checksum`: of the header before that field, then the table.
std::uint64_t table_checksum(const layout::FileHeader& header,
                             std::span<const layout::SectionEntry> table);

/// The name in docs/file-format.md, or the id's letters in quotes where it is not in there.
std::string section_name(std::uint32_t id);

/// A view of a file's sections; `file` must outlive it.
class MdkSections {
 public:
  /// Checks header and table: after this every section lies inside the file, and every section the
  /// file needs is known. `path` is for the sentences. Throws Error (kBadInput).
  MdkSections(std::span<const std::byte> file, const std::string& path);

  const layout::FileHeader& header() const { return header_; }
  const std::vector<layout::SectionEntry>& table() const { return table_; }
  std::span<const std::byte> content(const layout::SectionEntry& entry) const {
    return file_.subspan(entry.offset, entry.bytes());
  }

  /// The content of the one section of this kind, in place. Throws Error (kBadInput) where there is
  /// none, more than one, or its elements have another size than T.
  template <class T>
  std::span<const T> array(const layout::SectionKind& kind) const {
    static_assert(alignof(T) <= layout::kAlignment && std::is_trivially_copyable_v<T>);
    const layout::SectionEntry& entry = only_entry(kind, sizeof(T));
    return {reinterpret_cast<const T*>(file_.data() + entry.offset), entry.element_count};
  }

 private:
  const layout::SectionEntry& only_entry(const layout::SectionKind& kind,
                                         std::uint32_t element_bytes) const;
  layout::FileHeader read_header() const;
  void read_table();
  void check_entry(const layout::SectionEntry& entry) const;

  std::span<const std::byte> file_;
  std::string path_;
  layout::FileHeader header_;
  std::vector<layout::SectionEntry> table_;
};

}  // namespace mdk
