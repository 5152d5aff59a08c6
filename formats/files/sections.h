// Files made of sections: a header, a table, and arrays that are read in place, each on a cache
// line of its own (docs/file-format.md). What .mdk and .mds files have in common.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace mdk::layout {

static_assert(std::endian::native == std::endian::little,
              "the file is read in place: a big-endian machine needs a converting reader");

inline constexpr std::uint32_t kByteOrder = 0x01020304;
inline constexpr std::uint64_t kAlignment = 64;
inline constexpr std::uint32_t kMaxSections = 256;
inline constexpr std::uint32_t kSectionNeeded =
    1;  ///< flag: whoever does not know the id must refuse

struct FileHeader {
  std::array<unsigned char, 8> magic = {};
  std::uint32_t byte_order = kByteOrder;
  std::uint16_t major_version = 0, minor_version = 0;
  std::uint64_t file_bytes = 0;
  std::uint32_t section_count = 0;
  std::uint16_t tool_version[3] = {};  ///< major, minor, patch
  std::uint16_t source_reader = 0;     ///< a SourceReader
  std::uint32_t reserved_too = 0;
  std::uint64_t options_hash = 0;
  std::uint64_t reserved_last = 0;
  std::uint64_t checksum = 0;  ///< of all before it and the section table
};
static_assert(sizeof(FileHeader) == 64 && offsetof(FileHeader, checksum) == 56);
static_assert(offsetof(FileHeader, tool_version) == 28 && offsetof(FileHeader, options_hash) == 40);

struct SectionEntry {
  std::uint32_t id = 0;
  std::uint32_t flags = 0;
  std::uint32_t element_bytes = 0;
  std::uint32_t reserved = 0;
  std::uint64_t element_count = 0;
  std::uint64_t offset = 0;
  std::uint64_t checksum = 0;

  /// Meaningful once the entry was checked against its file.
  std::uint64_t bytes() const { return element_count * element_bytes; }
};
static_assert(sizeof(SectionEntry) == 40);

/// What tells one kind of file from another.
struct FileFormat {
  std::array<unsigned char, 8> magic;
  std::uint16_t major_version, minor_version;
  std::string_view noun;    ///< "an .mdk file"
  std::string_view maker;   ///< "bake one with mdprep bake"
  std::string_view remake;  ///< "bake it again"
  /// The name in the format's page, or nothing where the id is not in there.
  std::string_view (*name_of)(std::uint32_t id);
};

constexpr std::uint64_t align_up(std::uint64_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

/// What stands in `FileHeader::checksum`: of the header before that field, then the table.
std::uint64_t table_checksum(const FileHeader& header, std::span<const SectionEntry> table);

/// The name in the format's page, or the id's letters in quotes where it is not in there.
std::string section_name(const FileFormat& format, std::uint32_t id);

}  // namespace mdk::layout

namespace mdk {

/// What a section table says, for `mdprep info`.
struct SectionInfo {
  std::string name;  ///< as in the format's page
  std::uint64_t bytes = 0;
};

/// A view of a file's sections; `file` and `format` must outlive it.
class FileSections {
 public:
  /// Checks header and table: after this every section lies inside the file, and every section the
  /// file needs is known. `path` is for the sentences. Throws Error (kBadInput).
  FileSections(const layout::FileFormat& format, std::span<const std::byte> file,
               const std::string& path);

  const layout::FileHeader& header() const { return header_; }
  const std::vector<layout::SectionEntry>& table() const { return table_; }
  std::span<const std::byte> content(const layout::SectionEntry& entry) const {
    return file_.subspan(entry.offset, entry.bytes());
  }
  std::vector<SectionInfo> infos() const;

  /// Compares every section's contents with its stored checksum; throws Error (kBadInput) naming
  /// the first one that differs. Reads the whole file.
  void verify_checksums() const;

  /// The content of the one section of this kind, in place. Throws Error (kBadInput) where there is
  /// none, more than one, or its elements have another size than T.
  template <class T>
  std::span<const T> array(std::uint32_t id) const {
    static_assert(alignof(T) <= layout::kAlignment && std::is_trivially_copyable_v<T>);
    const layout::SectionEntry& entry = only_entry(id, sizeof(T));
    return {reinterpret_cast<const T*>(file_.data() + entry.offset), entry.element_count};
  }

 private:
  const layout::SectionEntry& only_entry(std::uint32_t id, std::uint32_t element_bytes) const;
  layout::FileHeader read_header() const;
  void read_table();
  void check_entry(const layout::SectionEntry& entry) const;
  std::string name(std::uint32_t id) const {
    return "section " + layout::section_name(*format_, id);
  }
  /// "; it is damaged: copy it again, or bake it again"
  std::string damaged() const;

  const layout::FileFormat* format_;
  std::span<const std::byte> file_;
  std::string path_;
  layout::FileHeader header_;
  std::vector<layout::SectionEntry> table_;
};

}  // namespace mdk
