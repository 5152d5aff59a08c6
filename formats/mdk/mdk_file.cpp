// Mapping, table, spans, check: after the constructor the model is as good as one made in memory.
#include "formats/mdk/mdk_file.h"

#include <array>
#include <utility>

#include "common/base/error.h"
#include "common/motion/model_handle.h"
#include "formats/files/mapped_file.h"
#include "formats/mdk/layout.h"

namespace mdk {
namespace {

using layout::ClipRecord;
using layout::ModelRecord;

const ModelRecord& only_record(const FileSections& sections, const std::string& path) {
  const auto records = sections.array<ModelRecord>(layout::kModel.id);
  if (records.size() != 1) {
    throw bad_input(path, "section model must hold one record; the file is damaged: bake it again");
  }
  const ModelRecord& record = records.front();
  if ((record.flags & ~layout::kKeysOnly) != 0) {
    throw bad_input(path, "its model has flags this program does not know; use a newer one");
  }
  if (record.pose_kind > static_cast<std::uint16_t>(PoseKind::kQuantized)) {
    throw bad_input(
        path, "stores its poses as kind " + std::to_string(record.pose_kind) +
                  ", which this program does not know (it knows 0, key positions, "
                  "1, a rig, and 2, quantised positions); use a newer one, or bake the file again");
  }
  return record;
}

/// Names must follow one another, so that together they take no more memory than the file.
std::vector<Clip> read_clips(const FileSections& sections, const std::string& path) {
  const auto records = sections.array<ClipRecord>(layout::kClips.id);
  const auto names = sections.array<char>(layout::kClipNames.id);
  std::vector<Clip> clips;
  clips.reserve(records.size());
  std::size_t next = 0;
  for (const ClipRecord& record : records) {
    if (record.name_offset != next || record.name_bytes > names.size() - next) {
      throw bad_input(path, "section clip_names does not hold the name of clip " +
                                std::to_string(clips.size()) + "; it is damaged: bake it again");
    }
    const auto name = names.subspan(next, record.name_bytes);
    next += name.size();
    clips.push_back({{name.begin(), name.end()}, record.first_key, record.key_count});
  }
  return clips;
}

bool counts_agree(const ModelRecord& record, const ModelView& model) {
  return record.key_count == model.key_times.size() &&
         record.triangle_count == model.triangles.size() &&
         record.cluster_count == model.clusters.size() &&
         record.segment_count == model.segments.size() && record.clip_count == model.clips.size();
}

}  // namespace

struct MdkFile::State {
  explicit State(const std::string& file_path)
      : path(file_path), file(path), sections(layout::kMdkFormat, file.bytes(), path) {
    const ModelRecord& record = only_record(sections, path);
    clips = read_clips(sections, path);
    model.vertex_count = record.vertex_count;
    model.rest_key = record.rest_key;
    model.bounds = record.bounds;
    model.rest_diagonal = record.rest_diagonal;
    model.poses.kind = static_cast<PoseKind>(record.pose_kind);
    model.holds_between_keys = (record.flags & layout::kKeysOnly) == 0;
    model.clips = clips;
    ModelView::for_each_array(
        [&]<class T>(const ModelArray& row, std::span<const T>& array) {
          array = sections.array<T>(row.id);
        },
        model);
    if (!counts_agree(record, model)) {
      throw bad_input(path,
                      "section model and the sizes of the other sections disagree; the file is "
                      "damaged: bake it again");
    }
    if (const std::string fault = find_inconsistency(model); !fault.empty()) {
      throw bad_input(path, "section " + fault + "; the file is damaged: bake it again");
    }
  }

  std::string path;
  MappedFile file;
  FileSections sections;
  std::vector<Clip> clips;
  ModelView model;
};

MdkFile::MdkFile(const std::string& path) : state_(std::make_unique<State>(path)) {}
MdkFile::~MdkFile() = default;
MdkFile::MdkFile(MdkFile&&) noexcept = default;
MdkFile& MdkFile::operator=(MdkFile&&) noexcept = default;

const ModelView& MdkFile::model() const { return state_->model; }
const std::string& MdkFile::path() const { return state_->path; }
std::span<const std::byte> MdkFile::bytes() const { return state_->file.bytes(); }
std::uint64_t MdkFile::file_bytes() const { return state_->file.bytes().size(); }

MdkOrigin MdkFile::origin() const {
  const layout::FileHeader& header = state_->sections.header();
  const bool is_foreign = header.source_reader == static_cast<std::uint16_t>(SourceReader::kAssimp);
  return {std::to_array(header.tool_version), header.options_hash,
          is_foreign ? SourceReader::kAssimp : SourceReader::kMdprep};
}

std::vector<SectionInfo> MdkFile::sections() const { return state_->sections.infos(); }
void MdkFile::verify_checksums() const { state_->sections.verify_checksums(); }
std::uint64_t MdkFile::content_hash() const { return state_->sections.header().checksum; }

Model Model::load(const std::string& path) {
  const auto file = std::make_shared<const MdkFile>(path);
  return ModelHandle::make(file->model(), file);
}

}  // namespace mdk
