// Lays the sections out one after another and writes them in that order.
#include "formats/files/section_writer.h"

#include <algorithm>
#include <array>

#include "formats/files/mapped_file.h"

namespace mdk {
namespace {

/// Writes in pieces; progress is told of each before it is written.
class PieceWriter {
 public:
  PieceWriter(AtomicFile& file, std::uint64_t whole_bytes, ProgressSink& progress)
      : file_(file), whole_bytes_(whole_bytes), progress_(progress) {}

  void write(std::span<const std::byte> bytes) {
    constexpr std::size_t kPiece = std::size_t{16} << 20;
    while (!bytes.empty()) {
      progress_.report("write", static_cast<double>(written_) / static_cast<double>(whole_bytes_));
      const std::size_t piece = std::min(bytes.size(), kPiece);
      file_.write(bytes.first(piece));
      written_ += piece;
      bytes = bytes.subspan(piece);
    }
  }
  void pad(std::uint64_t until) {
    constexpr std::array<std::byte, layout::kAlignment> kZeros{};
    write(std::span(kZeros).first(until - written_));
  }

 private:
  AtomicFile& file_;
  std::uint64_t whole_bytes_;
  ProgressSink& progress_;
  std::uint64_t written_ = 0;
};

}  // namespace

std::uint64_t write_sections(const std::string& path, const layout::FileFormat& format,
                             layout::FileHeader header, std::span<const SectionContent> sections,
                             Overwrite overwrite, ProgressSink* progress) {
  std::vector<layout::SectionEntry> table;
  std::uint64_t end = sizeof(header) + sections.size() * sizeof(layout::SectionEntry);
  for (const SectionContent& section : sections) {
    layout::SectionEntry& entry = table.emplace_back();
    entry.id = section.id;
    entry.flags = layout::kSectionNeeded;
    entry.element_bytes = section.element_bytes;
    entry.element_count = section.bytes.size() / section.element_bytes;
    entry.offset = layout::align_up(end);
    entry.checksum = checksum_of(section.bytes);
    end = entry.offset + section.bytes.size();
  }
  header.magic = format.magic;
  header.major_version = format.major_version;
  header.minor_version = std::max(header.minor_version, format.minor_version);
  header.file_bytes = layout::align_up(end);
  header.section_count = static_cast<std::uint32_t>(sections.size());
  header.checksum = layout::table_checksum(header, table);

  SilentProgress silent;
  AtomicFile file(path, overwrite);
  PieceWriter writer(file, header.file_bytes, progress ? *progress : silent);
  writer.write(std::as_bytes(std::span(&header, 1)));
  writer.write(std::as_bytes(std::span(table)));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    writer.pad(table[i].offset);
    writer.write(sections[i].bytes);
  }
  writer.pad(header.file_bytes);
  file.commit();
  return header.file_bytes;
}

}  // namespace mdk
