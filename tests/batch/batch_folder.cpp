#include "tests/batch/batch_folder.h"

#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "formats/files/image_writer.h"
#include "preprocess/batch/plan.h"
#include "preprocess/commands/command_line.h"

namespace mdk::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Numbers as the bytes of a buffer.
template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

Json accessor(int view, int component, std::size_t count, const char* type) {
  return {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
}

/// Two squares; the second one flies over the first, as high as `seed` says.
Json waving_squares(const std::string& name, int seed, std::string& bytes) {
  constexpr int kFloat = 5126, kUint16 = 5123;
  Json views = Json::array();
  const auto add = [&](const auto& values) {
    const std::size_t start = bytes.size();
    append(bytes, values);
    views.push_back({{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes.size() - start}});
  };
  const float height = 1.0f + 0.125f * static_cast<float>(seed);
  add(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  add(std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1});
  add(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  add(std::vector<float>{0, 0.5f, 1});
  add(std::vector<float>{0, 0, 0.5f, 1, height, 0.5f, 2, 0, 0.5f});
  Json positions = accessor(0, kFloat, 4, "VEC3"), times = accessor(3, kFloat, 3, "SCALAR");
  positions["min"] = {0, 0, 0};
  positions["max"] = {1, 1, 0};
  times["min"] = {0};
  times["max"] = {1};
  return {
      {"asset", {{"version", "2.0"}}},
      {"buffers", {{{"uri", name + ".bin"}, {"byteLength", bytes.size()}}}},
      {"bufferViews", views},
      {"accessors",
       {positions, accessor(1, kFloat, 4, "VEC2"), accessor(2, kUint16, 6, "SCALAR"), times,
        accessor(4, kFloat, 3, "VEC3")}},
      {"images", {{{"uri", name + ".png"}}}},
      {"textures", {{{"source", 0}}}},
      {"materials", {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}}},
      {"meshes",
       {{{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}},
            {"indices", 2},
            {"material", 0}}}}}}},
      {"nodes", {{{"mesh", 0}}, {{"mesh", 0}}}},
      {"scenes", {{{"nodes", {0, 1}}}}},
      {"scene", 0},
      {"animations",
       {{{"name", "fly"},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}},
         {"samplers", {{{"input", 3}, {"output", 4}}}}}}},
  };
}

}  // namespace

bool BatchFolder::has(const std::string& name) const { return fs::exists(file(name)); }

void BatchFolder::write(const std::string& name, const std::string& text) const {
  fs::create_directories(fs::path(file(name)).parent_path());
  write_text(file(name), text);
}

void BatchFolder::write_source(const std::string& name, int seed) const {
  std::string bytes;
  const Json gltf = waving_squares(fs::path(name).filename().string(), seed, bytes);
  write(name + ".gltf", gltf.dump());
  write(name + ".bin", bytes);
  const std::uint32_t pixel = 0xff000000u + static_cast<std::uint32_t>(seed);
  write_png(file(name + ".png"), 1, 1, std::span(&pixel, 1));
}

std::vector<Job> BatchFolder::plan() const {
  return plan_jobs(read_manifest(manifest()), [](const std::vector<std::string>& words) {
    mdprep_command().parse(words, std::cout);
  });
}

Outcome BatchFolder::batch(std::vector<std::string> options) const {
  options.insert(options.begin(), {"batch", manifest()});
  return run_mdprep(options);
}

Outcome BatchFolder::shell(const std::string& line) const {
  const TempFolder logs;
  const std::string whole = "cd '" + path() + "' && (" + line + "\n) > '" + logs.file("out") +
                            "' 2> '" + logs.file("err") + "' < /dev/null";
  const int status = std::system(whole.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 1000, read_text(logs.file("out")),
          read_text(logs.file("err"))};
}

long long BatchFolder::time_stamp(const std::string& name) const {
  return fs::last_write_time(file(name)).time_since_epoch().count();
}

std::vector<std::string> BatchFolder::made_files(const std::string& below) const {
  std::vector<std::string> files;
  if (!has(below)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(file(below)))
    if (entry.is_regular_file())
      files.push_back(fs::relative(entry.path(), path()).string() + "\n" +
                      read_text(entry.path().string()));
  std::sort(files.begin(), files.end());
  return files;
}

bool has_program(const std::string& name) {
  return std::system(("command -v " + name + " > /dev/null 2>&1").c_str()) == 0;
}

}  // namespace mdk::test
