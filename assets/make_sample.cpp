// make_sample NAME OUT: writes one of the sample animations.
#include <cstdio>
#include <string>
#include <vector>

#include "assets/ball_asset.h"
#include "assets/chicken_asset.h"
#include "assets/cloth_asset.h"
#include "assets/cow_asset.h"
#include "assets/dolphin_asset.h"
#include "assets/glb_writer.h"
#include "assets/hand_asset.h"
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
constexpr SceneSample kScenes[] = {{"hand", make_hand_scene}, {"ball", make_ball_scene}};
constexpr SequenceSample kSequences[] = {
    {"chicken", make_chicken}, {"cow", make_cow}, {"dolphin", make_dolphin}, {"cloth", make_cloth}};

void report(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::printf("%s: %zu bytes\n", path.c_str(), bytes.size());
}

void write(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  write_bytes(path, bytes);
  report(path, bytes);
}

bool make(const std::string& name, const std::string& folder) {
  for (const SceneSample& sample : kScenes)
    if (name == sample.name) {
      write(folder + "/" + name + ".glb", encode_glb(sample.make()));
      return true;
    }
  for (const SequenceSample& sample : kSequences)
    if (name == sample.name) {
      const SampleSequence sequence = sample.make();
      std::printf("%s: %zu triangles, %zu vertices, %zu keys\n", name.c_str(),
                  sequence.triangles.size(), sequence.colors.size(), sequence.poses.size());
      write(folder + "/" + name + ".obj", encode_obj(sequence));
      write(folder + "/" + name + ".pc2", encode_pc2(sequence));
      return true;
    }
  return false;
}

}  // namespace
}  // namespace mdk

int main(int argc, char** argv) {
  try {
    if (argc == 3 && mdk::make(argv[1], argv[2])) return 0;
  } catch (const mdk::Error& error) {
    std::fprintf(stderr, "make_sample: %s\n", error.what());
    return error.exit_status();
  }
  std::fprintf(stderr, "usage: make_sample hand|ball|chicken|cow|dolphin|cloth FOLDER\n");
  return static_cast<int>(mdk::ErrorCode::kUsage);
}
