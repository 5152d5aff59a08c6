// Checks run from the outside in: what kind of file, whole or cut, table intact, each section
// inside. No field is used before it was checked.
#include "formats/mdk/layout.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"

namespace mdk {
namespace {

using layout::FileHeader;
using layout::SectionEntry;

/// The row of a section that this program knows.
std::optional<ModelArray> find_row(std::uint32_t id) {
  for (const ModelArray& row : {layout::kModel, layout::kClips, layout::kClipNames})
    if (row.id == id) return row;
  std::optional<ModelArray> found;
  const ModelView empty;
  ModelView::for_each_array(
      [&](const ModelArray& row, const auto&) {
        if (row.id == id) found = row;
      },
      empty);
  return found;
}

std::string version(unsigned major, unsigned minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}

constexpr const char* kDamaged = "; it is damaged: copy it again, or bake it again";

}  // namespace

std::uint64_t layout::table_checksum(const FileHeader& header,
                                     std::span<const SectionEntry> table) {
  constexpr std::size_t kHeaderPart = offsetof(FileHeader, checksum);
  std::vector<std::byte> covered(kHeaderPart + table.size_bytes());
  std::memcpy(covered.data(), &header, kHeaderPart);
  if (!table.empty()) {
    std::memcpy(covered.data() + kHeaderPart, table.data(), table.size_bytes());
  }
  return checksum_of(covered);
}

std::string layout::section_name(std::uint32_t id) {
  if (const auto row = find_row(id)) return std::string(row->name);
  std::string letters = "'";
  for (int i = 0; i < 4; ++i) {
    const auto letter = static_cast<unsigned char>(id >> (8 * i));
    letters += letter > 0x20 && letter < 0x7f ? static_cast<char>(letter) : '?';
  }
  return letters + "'";
}

MdkSections::MdkSections(std::span<const std::byte> file, const std::string& path)
    : file_(file), path_(path) {
  header_ = read_header();
  read_table();
  if (layout::table_checksum(header_, table_) != header_.checksum) {
    throw bad_input(path_, "the checksum of its section table is wrong" + std::string(kDamaged));
  }
  for (const SectionEntry& entry : table_) check_entry(entry);
}

FileHeader MdkSections::read_header() const {
  const std::size_t magic_bytes = std::min(file_.size(), layout::kMagic.size());
  if (magic_bytes == 0 || std::memcmp(file_.data(), layout::kMagic.data(), magic_bytes) != 0) {
    throw bad_input(path_, "not an .mdk file (bad magic); bake one with mdprep bake");
  }
  FileHeader header;
  if (file_.size() < sizeof(header)) {
    throw bad_input(path_, "is cut: the header alone has " + std::to_string(sizeof(header)) +
                               " bytes, the file has " + std::to_string(file_.size()) +
                               "; copy it again, or bake it again");
  }
  std::memcpy(&header, file_.data(), sizeof(header));
  if (header.byte_order != layout::kByteOrder) {
    throw bad_input(path_, "has an unknown byte order" + std::string(kDamaged));
  }
  if (header.major_version != layout::kMajorVersion) {
    throw bad_input(path_, "has file format " +
                               version(header.major_version, header.minor_version) +
                               ", this program reads " + version(layout::kMajorVersion, 0) +
                               " and its minor versions; bake it again with this program's mdprep, "
                               "or use the version it was made for");
  }
  if (header.file_bytes != file_.size()) {
    throw bad_input(
        path_, std::string(header.file_bytes > file_.size() ? "is cut" : "is too long") +
                   ": header says " + std::to_string(header.file_bytes) + " bytes, the file has " +
                   std::to_string(file_.size()) + "; copy it again, or bake it again");
  }
  return header;
}

void MdkSections::read_table() {
  const std::uint64_t room = (file_.size() - sizeof(header_)) / sizeof(SectionEntry);
  if (header_.section_count == 0 || header_.section_count > layout::kMaxSections ||
      header_.section_count > room) {
    throw bad_input(path_, "its header speaks of " + std::to_string(header_.section_count) +
                               " sections" + kDamaged);
  }
  table_.resize(header_.section_count);
  std::memcpy(table_.data(), file_.data() + sizeof(header_), table_.size() * sizeof(SectionEntry));
}

void MdkSections::check_entry(const SectionEntry& entry) const {
  const std::string name = "section " + layout::section_name(entry.id);
  if ((entry.flags & ~layout::kSectionNeeded) != 0) {
    throw bad_input(path_, name + " has flags this program does not know; use a newer one");
  }
  if ((entry.flags & layout::kSectionNeeded) != 0 && !find_row(entry.id)) {
    throw bad_input(path_, name +
                               " is needed to read it, but this program does not know it; "
                               "use a newer one");
  }
  const std::uint64_t table_end = sizeof(FileHeader) + table_.size() * sizeof(SectionEntry);
  if (entry.offset % layout::kAlignment != 0 || entry.offset < table_end) {
    throw bad_input(path_, name + " starts where no section can" + kDamaged);
  }
  if (entry.element_bytes == 0 || entry.offset > file_.size() ||
      entry.element_count > (file_.size() - entry.offset) / entry.element_bytes) {
    throw bad_input(path_, name + " reaches past the end of the file" + kDamaged);
  }
}

const SectionEntry& MdkSections::only_entry(const ModelArray& row,
                                            std::uint32_t element_bytes) const {
  const std::string name = "section " + std::string(row.name);
  const SectionEntry* found = nullptr;
  for (const SectionEntry& entry : table_) {
    if (entry.id != row.id) continue;
    if (found != nullptr) throw bad_input(path_, name + " is there twice" + kDamaged);
    found = &entry;
  }
  if (found == nullptr) throw bad_input(path_, name + " is missing" + kDamaged);
  if (found->element_bytes != element_bytes) {
    throw bad_input(path_, name + " has elements of " + std::to_string(found->element_bytes) +
                               " bytes instead of " + std::to_string(element_bytes) + kDamaged);
  }
  return *found;
}

}  // namespace mdk
