#include "tests/commands/sample_model.h"

#include "formats/gltf/reader.h"
#include "preprocess/pipeline.h"
#include "tests/commands/sample_mesh.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {

PoseSequence sample_sequence() {
  const TempFolder folder;
  const std::string path = folder.file("sample.gltf");
  write_sample_gltf(path);
  SilentProgress silent;
  return read_gltf(path, {}, silent).sequence;
}

ModelStorage sample_model() {
  DecomposeOptions options;
  options.clusters = 3;
  options.segments = 3;  // of two clips: one cut at least is inside a clip
  SilentProgress silent;
  return decompose(sample_sequence(), options, silent).model;
}

}  // namespace mdk::test
