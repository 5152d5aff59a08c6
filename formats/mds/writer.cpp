// A scene's arrays as sections.
#include "formats/mds/writer.h"

#include <algorithm>
#include <vector>

#include "common/base/error.h"
#include "formats/files/section_writer.h"
#include "formats/mds/layout.h"

namespace mdk {

std::uint64_t write_mds(const SceneView& scene, std::span<const SceneModelFile> models,
                        const std::string& path, const MdsWriteOptions& options) {
  if (const std::string fault = find_scene_fault(scene, models); !fault.empty()) {
    throw Error(ErrorCode::kInternal, path + ": not written, the scene is inconsistent (" + fault +
                                          "): please report this as a bug");
  }
  layout::SceneRecord record;
  record.model_count = scene.model_count;
  record.instance_count = scene.instance_count();
  record.first_time = scene.first_time;
  record.last_time = scene.last_time;
  std::vector<layout::ModelFileRecord> files;
  std::string names;
  for (const SceneModelFile& model : models) {
    files.push_back({static_cast<std::uint32_t>(names.size()),
                     static_cast<std::uint32_t>(model.name.size()), model.content});
    names += model.name;
  }
  std::vector<SectionContent> sections{
      SectionContent::of(layout::kScene, std::span<const layout::SceneRecord>(&record, 1)),
      SectionContent::of(layout::kModelFiles, std::span<const layout::ModelFileRecord>(files)),
      SectionContent::of(layout::kModelNames, std::span<const char>(names))};
  SceneView::for_each_array(
      [&](std::uint32_t id, const char*, auto elements) {
        sections.push_back(SectionContent::of(id, elements));
      },
      scene);
  layout::FileHeader header;
  std::ranges::copy(options.version, header.tool_version);
  header.options_hash = options.options_hash;
  return write_sections(path, layout::kMdsFormat, header, sections, options.overwrite);
}

}  // namespace mdk
