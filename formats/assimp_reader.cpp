#include "formats/assimp_reader.h"

#include <utility>

#include "common/base/error.h"
#include "formats/assimp_process.h"
#include "formats/files/file_kind.h"
#include "formats/gltf_reader.h"

namespace mdk {

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
