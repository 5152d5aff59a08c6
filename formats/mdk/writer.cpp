// A model's arrays as sections.
#include "formats/mdk/writer.h"

#include <algorithm>
#include <span>
#include <vector>

#include "common/base/error.h"
#include "formats/files/section_writer.h"
#include "formats/mdk/layout.h"

namespace mdk {
namespace {

using layout::ClipRecord;
using layout::ModelRecord;

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

std::vector<SectionContent> make_sections(const ModelView& model, const Records& records) {
  std::vector<SectionContent> sections{
      SectionContent::of(layout::kModel.id, std::span(&records.model, 1)),
      SectionContent::of(layout::kClips.id, std::span<const ClipRecord>(records.clips)),
      SectionContent::of(layout::kClipNames.id, std::span<const char>(records.clip_names))};
  ModelView::for_each_array(
      [&](const ModelArray& row, auto elements) {
        sections.push_back(SectionContent::of(row.id, elements));
      },
      model);
  return sections;
}

}  // namespace

std::uint64_t write_mdk(const ModelView& model, const std::string& path,
                        const MdkWriteOptions& options) {
  if (const std::string fault = find_inconsistency(model); !fault.empty()) {
    throw Error(ErrorCode::kInternal, path + ": not written, the model is inconsistent (" + fault +
                                          "): please report this as a bug");
  }
  const Records records = make_records(model);
  layout::FileHeader header;
  if (records.model.flags != 0) header.minor_version = layout::kMinorVersionOfFlags;
  std::ranges::copy(options.origin.version, header.tool_version);
  header.options_hash = options.origin.options_hash;
  header.source_reader = static_cast<std::uint16_t>(options.origin.reader);
  return write_sections(path, layout::kMdkFormat, header, make_sections(model, records),
                        options.overwrite, options.progress);
}

}  // namespace mdk
