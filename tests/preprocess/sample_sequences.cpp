#include "tests/preprocess/sample_sequences.h"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace mdk {
namespace {

std::filesystem::path sample_folder() {
  if (const char* folder = std::getenv("MDK_TEST_DATA")) return folder;
  return std::filesystem::path(MDK_SOURCE_DIR).parent_path() / "shared" / "data";
}

std::vector<Triangle> read_obj_triangles(const std::filesystem::path& path) {
  std::vector<Triangle> triangles;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "f") continue;
    std::vector<std::uint32_t> corners;
    while (words >> word) corners.push_back(static_cast<std::uint32_t>(std::stoul(word)) - 1);
    for (std::size_t i = 2; i < corners.size(); ++i)
      triangles.push_back({{corners[0], corners[i - 1], corners[i]}});
  }
  return triangles;
}

}  // namespace

std::optional<PoseSequence> load_sample_sequence(const std::string& name) {
  const std::filesystem::path base = sample_folder() / "sequences" / name;
  std::ifstream cache(base.string() + ".pc2", std::ios::binary);
  if (!cache) return std::nullopt;

  struct Header {
    char magic[12];
    std::int32_t version, points;
    float start, rate;
    std::int32_t frames;
  } header;
  cache.read(reinterpret_cast<char*>(&header), sizeof(header));
  PoseSequence sequence;
  sequence.triangles = read_obj_triangles(base.string() + ".obj");
  sequence.vertex_count = static_cast<std::uint32_t>(header.points);
  sequence.positions.resize(static_cast<std::size_t>(header.points) * header.frames);
  cache.read(reinterpret_cast<char*>(sequence.positions.data()),
             static_cast<std::streamsize>(sequence.positions.size() * sizeof(Vec3f)));
  if (!cache) throw std::runtime_error(name + ".pc2 is cut short");
  for (std::int32_t k = 0; k < header.frames; ++k) sequence.key_times.push_back(k / 30.0);
  sequence.clips = {{name, 0, static_cast<std::uint32_t>(header.frames)}};
  sequence.appearance.materials.resize(1);
  sequence.appearance.triangle_materials.assign(sequence.triangles.size(), 0);
  return sequence;
}

}  // namespace mdk
