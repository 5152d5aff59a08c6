// Checks run from the outside in: what kind of file, whole or cut, table intact, each section
// inside. No field is used before it was checked.
#include "formats/files/sections.h"

#include <algorithm>
#include <cstring>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"

namespace mdk {
namespace {

using layout::FileHeader;
using layout::SectionEntry;

std::string version(unsigned major, unsigned minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}

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

std::string layout::section_name(const FileFormat& format, std::uint32_t id) {
  if (const std::string_view name = format.name_of(id); !name.empty()) return std::string(name);
  std::string letters = "'";
  for (int i = 0; i < 4; ++i) {
    const auto letter = static_cast<unsigned char>(id >> (8 * i));
    letters += letter > 0x20 && letter < 0x7f ? static_cast<char>(letter) : '?';
  }
  return letters + "'";
}

FileSections::FileSections(const layout::FileFormat& format, std::span<const std::byte> file,
                           const std::string& path)
    : format_(&format), file_(file), path_(path) {
  header_ = read_header();
  read_table();
  if (layout::table_checksum(header_, table_) != header_.checksum) {
    throw bad_input(path_, "the checksum of its section table is wrong" + damaged());
  }
  for (const SectionEntry& entry : table_) check_entry(entry);
}

FileHeader FileSections::read_header() const {
  const std::size_t magic_bytes = std::min(file_.size(), format_->magic.size());
  if (magic_bytes == 0 || std::memcmp(file_.data(), format_->magic.data(), magic_bytes) != 0) {
    throw bad_input(path_, "not " + std::string(format_->noun) + " (bad magic); " +
                               std::string(format_->maker));
  }
  FileHeader header;
  if (file_.size() < sizeof(header)) {
    throw bad_input(path_, "is cut: the header alone has " + std::to_string(sizeof(header)) +
                               " bytes, the file has " + std::to_string(file_.size()) +
                               "; copy it again, or " + std::string(format_->remake));
  }
  std::memcpy(&header, file_.data(), sizeof(header));
  if (header.byte_order != layout::kByteOrder) {
    throw bad_input(path_, "has an unknown byte order" + damaged());
  }
  if (header.major_version != format_->major_version) {
    throw bad_input(path_, "has file format " +
                               version(header.major_version, header.minor_version) +
                               ", this program reads " + version(format_->major_version, 0) +
                               " and its minor versions; " + std::string(format_->remake) +
                               " with this program's mdprep, "
                               "or use the version it was made for");
  }
  if (header.file_bytes != file_.size()) {
    throw bad_input(
        path_, std::string(header.file_bytes > file_.size() ? "is cut" : "is too long") +
                   ": header says " + std::to_string(header.file_bytes) + " bytes, the file has " +
                   std::to_string(file_.size()) + "; copy it again, or " +
                   std::string(format_->remake));
  }
  return header;
}

void FileSections::read_table() {
  const std::uint64_t room = (file_.size() - sizeof(header_)) / sizeof(SectionEntry);
  if (header_.section_count == 0 || header_.section_count > layout::kMaxSections ||
      header_.section_count > room) {
    throw bad_input(path_, "its header speaks of " + std::to_string(header_.section_count) +
                               " sections" + damaged());
  }
  table_.resize(header_.section_count);
  std::memcpy(table_.data(), file_.data() + sizeof(header_), table_.size() * sizeof(SectionEntry));
}

void FileSections::check_entry(const SectionEntry& entry) const {
  const std::string name = this->name(entry.id);
  if ((entry.flags & ~layout::kSectionNeeded) != 0) {
    throw bad_input(path_, name + " has flags this program does not know; use a newer one");
  }
  if ((entry.flags & layout::kSectionNeeded) != 0 && format_->name_of(entry.id).empty()) {
    throw bad_input(path_, name +
                               " is needed to read it, but this program does not know it; "
                               "use a newer one");
  }
  const std::uint64_t table_end = sizeof(FileHeader) + table_.size() * sizeof(SectionEntry);
  if (entry.offset % layout::kAlignment != 0 || entry.offset < table_end) {
    throw bad_input(path_, name + " starts where no section can" + damaged());
  }
  if (entry.element_bytes == 0 || entry.offset > file_.size() ||
      entry.element_count > (file_.size() - entry.offset) / entry.element_bytes) {
    throw bad_input(path_, name + " reaches past the end of the file" + damaged());
  }
}

const SectionEntry& FileSections::only_entry(std::uint32_t id, std::uint32_t element_bytes) const {
  const std::string name = this->name(id);
  const SectionEntry* found = nullptr;
  for (const SectionEntry& entry : table_) {
    if (entry.id != id) continue;
    if (found != nullptr) throw bad_input(path_, name + " is there twice" + damaged());
    found = &entry;
  }
  if (found == nullptr) throw bad_input(path_, name + " is missing" + damaged());
  if (found->element_bytes != element_bytes) {
    throw bad_input(path_, name + " has elements of " + std::to_string(found->element_bytes) +
                               " bytes instead of " + std::to_string(element_bytes) + damaged());
  }
  return *found;
}

std::string FileSections::damaged() const {
  return "; it is damaged: copy it again, or " + std::string(format_->remake);
}

std::vector<SectionInfo> FileSections::infos() const {
  std::vector<SectionInfo> infos;
  for (const SectionEntry& entry : table_)
    infos.push_back({layout::section_name(*format_, entry.id), entry.bytes()});
  return infos;
}

void FileSections::verify_checksums() const {
  for (const SectionEntry& entry : table_) {
    if (checksum_of(content(entry)) != entry.checksum) {
      throw bad_input(path_, name(entry.id) + " differs from its checksum" + damaged());
    }
  }
}

}  // namespace mdk
