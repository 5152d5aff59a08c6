// make_sample NAME FOLDER [LEVELS]: writes one of the sample animations.
#include <cstdio>
#include <string>
#include <vector>

#include "assets/ball_asset.h"
#include "assets/ben_asset.h"
#include "assets/chicken_asset.h"
#include "assets/cloth_asset.h"
#include "assets/cow_asset.h"
#include "assets/dolphin_asset.h"
#include "assets/glb_writer.h"
#include "assets/hand_asset.h"
#include "assets/triangle_split.h"
#include "common/base/error.h"

namespace mdk {
namespace {

struct SceneSample {
  const char* name;
  GlbScene (*make)();
};
struct SequenceSample {
  const char* name;
  SampleSequence (*make)();
};
constexpr SceneSample kScenes[] = {
    {"hand", make_hand_scene}, {"ball", make_ball_scene}, {"ben", make_ben_scene}};
constexpr SequenceSample kSequences[] = {
    {"chicken", make_chicken}, {"cow", make_cow}, {"dolphin", make_dolphin}, {"cloth", make_cloth}};

constexpr int kMaxLevels = 6;

void write(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  write_bytes(path, bytes);
  std::printf("%s: %zu bytes\n", path.c_str(), bytes.size());
}

void write_scene(const SceneSample& sample, const std::string& folder, int levels) {
  GlbScene scene = sample.make();
  for (GlbMesh& mesh : scene.meshes) {
    for (int i = 0; i < levels; ++i) split_mesh(mesh);
    std::printf("%s: %zu triangles, %zu vertices\n", mesh.name.c_str(), mesh.triangles.size(),
                mesh.positions.size());
  }
  write(folder + "/" + sample.name + ".glb", encode_glb(scene));
}

void write_sequence(const SequenceSample& sample, const std::string& folder, int levels) {
  SampleSequence sequence = sample.make();
  for (int i = 0; i < levels; ++i) split_sequence(sequence);
  std::printf("%s: %zu triangles, %zu vertices, %zu keys\n", sample.name, sequence.triangles.size(),
              sequence.colors.size(), sequence.poses.size());
  write(folder + "/" + sample.name + ".obj", encode_obj(sequence));
  write(folder + "/" + sample.name + ".pc2", encode_pc2(sequence));
}

bool make(const std::string& name, const std::string& folder, int levels) {
  for (const SceneSample& sample : kScenes)
    if (name == sample.name) return write_scene(sample, folder, levels), true;
  for (const SequenceSample& sample : kSequences)
    if (name == sample.name) return write_sequence(sample, folder, levels), true;
  return false;
}

/// The levels of "make_sample NAME FOLDER [LEVELS]", or -1.
int levels_of(int argc, char** argv) {
  if (argc == 3) return 0;
  if (argc != 4 || argv[3][0] < '0' || argv[3][0] > '0' + kMaxLevels || argv[3][1]) return -1;
  return argv[3][0] - '0';
}

}  // namespace
}  // namespace mdk

int main(int argc, char** argv) {
  try {
    const int levels = mdk::levels_of(argc, argv);
    if (levels >= 0 && mdk::make(argv[1], argv[2], levels)) return 0;
  } catch (const mdk::Error& error) {
    std::fprintf(stderr, "make_sample: %s\n", error.what());
    return error.exit_status();
  }
  std::fprintf(stderr,
               "usage: make_sample hand|ball|ben|chicken|cow|dolphin|cloth FOLDER [LEVELS]\n"
               "  LEVELS, 0 to 6: how often every triangle is split into four (default: 0)\n");
  return static_cast<int>(mdk::ErrorCode::kUsage);
}
