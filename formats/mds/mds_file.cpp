// Mapping, table, spans, check, models: after the constructor every index may be followed.
#include "formats/mds/mds_file.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "common/base/error.h"
#include "common/motion/model_handle.h"
#include "formats/files/file_kind.h"
#include "formats/files/mapped_file.h"
#include "formats/files/text.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mds/layout.h"

namespace mdk {
namespace {

constexpr const char* kDamaged = "; the file is damaged: make it again";

std::string_view mds_section(std::uint32_t id) {
  if (id == layout::kScene) return "scene";
  if (id == layout::kModelFiles) return "model_files";
  if (id == layout::kModelNames) return "model_names";
  std::string_view found;
  const SceneView empty;
  SceneView::for_each_array(
      [&](std::uint32_t row, const char* name, const auto&) {
        if (row == id) found = name;
      },
      empty);
  return found;
}

bool is_model_name(const std::string& name) {
  return !name.empty() && name.size() <= kMaxNameBytes && is_utf8(name) &&
         name.find('\0') == std::string::npos && !std::filesystem::path(name).is_absolute();
}

/// Names must follow one another, so that together they take no more memory than the file.
std::vector<SceneModelFile> read_models(const FileSections& sections, const std::string& path) {
  const auto records = sections.array<layout::ModelFileRecord>(layout::kModelFiles);
  const auto names = sections.array<char>(layout::kModelNames);
  std::vector<SceneModelFile> files;
  std::size_t next = 0;
  for (const layout::ModelFileRecord& record : records) {
    if (record.name_offset != next || record.name_bytes > names.size() - next) {
      throw bad_input(path, "section model_names does not hold the name of model " +
                                std::to_string(files.size()) + kDamaged);
    }
    const auto name = names.subspan(next, record.name_bytes);
    next += name.size();
    files.push_back({{name.begin(), name.end()}, record.content});
  }
  return files;
}

std::string beside(const std::string& scene, const std::string& name) {
  return (std::filesystem::path(scene).parent_path() / name).string();
}

Model open_model(const std::string& scene, const SceneModelFile& named) {
  const auto file = std::make_shared<const MdkFile>(beside(scene, named.name));
  if (file->content_hash() != named.content) {
    throw bad_input(scene, "the model " + mdk::quoted(named.name) +
                               " was baked anew after the scene was made; make the scene again "
                               "with mdprep scene");
  }
  return ModelHandle::make(file->model(), file);
}

}  // namespace

const layout::FileFormat layout::kMdsFormat = {{0x89, 'M', 'D', 'S', '\r', '\n', 0x1a, '\n'},
                                               1,
                                               0,
                                               "an .mds file",
                                               "make one with mdprep scene",
                                               "make it again",
                                               mds_section};

std::string find_scene_fault(const SceneView& scene, std::span<const SceneModelFile> files) {
  if (files.empty()) return "model_files: there are none";
  if (files.size() != scene.model_count)
    return count_fault("model_files", files.size(), scene.model_count);
  for (std::size_t m = 0; m < files.size(); ++m)
    if (!is_model_name(files[m].name))
      return "model_names: that of model " + std::to_string(m) + " is no relative path in UTF-8";
  if (scene.instances.empty()) return "instances: there are none";
  return scene_fault(scene);
}

struct MdsFile::State {
  explicit State(const std::string& file_path)
      : path(file_path), file(path), sections(layout::kMdsFormat, file.bytes(), path) {
    const auto records = sections.array<layout::SceneRecord>(layout::kScene);
    if (records.size() != 1)
      throw bad_input(path, "section scene must hold one record" + std::string(kDamaged));
    const layout::SceneRecord& record = records.front();
    model_files = read_models(sections, path);
    SceneView scene;
    scene.model_count = record.model_count;
    scene.first_time = record.first_time;
    scene.last_time = record.last_time;
    SceneView::for_each_array(
        [&]<class T>(std::uint32_t id, const char*, std::span<const T>& array) {
          array = sections.array<T>(id);
        },
        scene);
    std::string fault = find_scene_fault(scene, model_files);
    if (fault.empty() && record.instance_count != scene.instance_count())
      fault = count_fault("instances", scene.instance_count(), record.instance_count);
    if (!fault.empty()) throw bad_input(path, "section " + fault + kDamaged);

    std::vector<Model> models;
    for (const SceneModelFile& model : model_files) models.push_back(open_model(path, model));
    if (fault = role_fault(scene, models); !fault.empty())
      throw bad_input(path, "section " + fault + kDamaged);
    stage.emplace(scene, std::move(models));
  }

  std::string path;
  MappedFile file;
  FileSections sections;
  std::vector<SceneModelFile> model_files;
  std::optional<Stage> stage;
};

MdsFile::MdsFile(const std::string& path) : state_(std::make_unique<State>(path)) {}
MdsFile::~MdsFile() = default;
MdsFile::MdsFile(MdsFile&&) noexcept = default;
MdsFile& MdsFile::operator=(MdsFile&&) noexcept = default;

const Stage& MdsFile::stage() const { return *state_->stage; }
const std::string& MdsFile::path() const { return state_->path; }
std::span<const SceneModelFile> MdsFile::model_files() const { return state_->model_files; }
std::string MdsFile::model_path(std::uint32_t model) const {
  return beside(path(), state_->model_files[model].name);
}
std::uint64_t MdsFile::file_bytes() const { return state_->file.bytes().size(); }
std::array<std::uint16_t, 3> MdsFile::tool_version() const {
  return std::to_array(state_->sections.header().tool_version);
}
std::uint64_t MdsFile::options_hash() const { return state_->sections.header().options_hash; }
std::vector<SectionInfo> MdsFile::sections() const { return state_->sections.infos(); }
void MdsFile::verify_checksums() const { state_->sections.verify_checksums(); }

}  // namespace mdk
