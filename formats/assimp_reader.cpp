#include "formats/assimp_reader.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/base/error.h"
#include "formats/assimp_process.h"
#include "formats/gltf_reader.h"

namespace mdk {

std::span<const std::string_view> assimp_extensions() {
  static constexpr std::array<std::string_view, 11> kExtensions = {
      ".3ds", ".ase", ".b3d", ".bvh", ".dae", ".fbx", ".lws", ".md5mesh", ".ms3d", ".smd", ".x"};
  return kExtensions;
}

#ifdef MDK_HAVE_ASSIMP
bool has_assimp() { return true; }
#else
bool has_assimp() { return false; }
#endif

ReadResult read_with_assimp(const std::string& path, const ReadOptions& options,
                            ProgressSink& progress) {
  if (!has_assimp())
    throw bad_input(path,
                    "is read through Assimp, which this build is without; build it where "
                    "libassimp-dev is installed, or export the mesh as glTF");
  AssimpAnswer answer = run_assimp(path, progress);
  ReadResult result = read_glb(path, std::move(answer.glb), options, progress);
  result.read_through = "Assimp " + answer.version;
  result.notes.insert(result.notes.begin(), answer.notes.begin(), answer.notes.end());
  result.notes.insert(result.notes.begin(), path + " was read through " + result.read_through +
                                                ", not by a reader of this program's own");
  result.dependencies.insert(result.dependencies.begin(), answer.files.begin(), answer.files.end());
  return result;
}

}  // namespace mdk
