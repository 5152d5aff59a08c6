// make_hand FILE.glb: writes the sample hand.
#include <cstdio>

#include "assets/glb_writer.h"
#include "assets/hand_asset.h"
#include "common/base/error.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_hand FILE.glb\n");
    return static_cast<int>(mdk::ErrorCode::kUsage);
  }
  try {
    const mdk::GlbScene scene = mdk::make_hand_scene();
    const auto bytes = mdk::encode_glb(scene);
    mdk::write_bytes(argv[1], bytes);
    std::printf("%s: %zu triangles, %zu vertices, %zu joints, %zu clips, %zu bytes\n", argv[1],
                scene.meshes[0].triangles.size(), scene.meshes[0].positions.size(),
                scene.skins[0].joints.size(), scene.clips.size(), bytes.size());
  } catch (const mdk::Error& error) {
    std::fprintf(stderr, "make_hand: %s\n", error.what());
    return error.exit_status();
  }
  return 0;
}
