// Lays the sections out one after another, each on its own cache line, and writes them in that
// order.
#include "formats/mdk/writer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"
#include "formats/mdk/layout.h"

namespace mdk {
namespace {

using layout::ClipRecord;
using layout::FileHeader;
using layout::ModelRecord;
using layout::SectionEntry;

struct Section {
  SectionEntry entry;
  std::span<const std::byte> content;
};

/// What the file holds in another form than the model does.
struct Records {
  ModelRecord model;
  std::vector<ClipRecord> clips;
  std::string clip_names;
};

Records make_records(const ModelView& model) {
  Records records;
  ModelRecord& r = records.model;
  r.vertex_count = model.vertex_count;
  r.key_count = model.key_count();
  r.triangle_count = model.triangle_count();
  r.cluster_count = model.cluster_count();
  r.segment_count = model.segment_count();
  r.clip_count = static_cast<std::uint32_t>(model.clips.size());
  r.rest_key = model.rest_key;
  r.rest_diagonal = model.rest_diagonal;
  r.pose_kind = static_cast<std::uint16_t>(model.poses.kind);
  r.flags = model.holds_between_keys ? 0 : layout::kKeysOnly;
  r.bounds = model.bounds;
  for (const Clip& clip : model.clips) {
    records.clips.push_back({static_cast<std::uint32_t>(records.clip_names.size()),
                             static_cast<std::uint32_t>(clip.name.size()), clip.first_key,
                             clip.key_count});
    records.clip_names += clip.name;
  }
  return records;
}

template <class T>
Section make_section(const ModelArray& row, std::span<const T> elements) {
  Section section;
  section.entry.id = row.id;
  section.entry.flags = layout::kSectionNeeded;
  section.entry.element_bytes = sizeof(T);
  section.entry.element_count = elements.size();
  section.content = std::as_bytes(elements);
  section.entry.checksum = checksum_of(section.content);
  return section;
}

std::vector<Section> make_sections(const ModelView& model, const Records& records) {
  std::vector<Section> sections;
  sections.push_back(make_section(layout::kModel, std::span(&records.model, 1)));
  sections.push_back(make_section(layout::kClips, std::span(records.clips)));
  sections.push_back(make_section(layout::kClipNames, std::span(records.clip_names)));
  ModelView::for_each_array([&](const ModelArray& row,
                                auto elements) { sections.push_back(make_section(row, elements)); },
                            model);
  return sections;
}

/// Sets the offsets and returns the size of the file.
std::uint64_t place(std::vector<Section>& sections) {
  std::uint64_t end = sizeof(FileHeader) + sections.size() * sizeof(SectionEntry);
  for (Section& section : sections) {
    section.entry.offset = layout::align_up(end);
    end = section.entry.offset + section.content.size();
  }
  return layout::align_up(end);
}

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

std::uint64_t write_mdk(const ModelView& model, const std::string& path,
                        const MdkWriteOptions& options) {
  if (const std::string fault = find_inconsistency(model); !fault.empty()) {
    throw Error(ErrorCode::kInternal, path + ": not written, the model is inconsistent (" + fault +
                                          "): please report this as a bug");
  }
  const Records records = make_records(model);
  std::vector<Section> sections = make_sections(model, records);
  FileHeader header;
  if (records.model.flags != 0) header.minor_version = layout::kMinorVersionOfFlags;
  header.file_bytes = place(sections);
  header.section_count = static_cast<std::uint32_t>(sections.size());
  std::ranges::copy(options.origin.version, header.tool_version);
  header.options_hash = options.origin.options_hash;
  header.source_reader = static_cast<std::uint16_t>(options.origin.reader);
  std::vector<SectionEntry> table;
  for (const Section& section : sections) table.push_back(section.entry);
  header.checksum = layout::table_checksum(header, table);

  SilentProgress silent;
  AtomicFile file(path, options.overwrite);
  PieceWriter writer(file, header.file_bytes, options.progress ? *options.progress : silent);
  writer.write(std::as_bytes(std::span(&header, 1)));
  writer.write(std::as_bytes(std::span(table)));
  for (const Section& section : sections) {
    writer.pad(section.entry.offset);
    writer.write(section.content);
  }
  writer.pad(header.file_bytes);
  file.commit();
  return header.file_bytes;
}

}  // namespace mdk
