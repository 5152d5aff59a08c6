// make_ball FILE.glb: writes the sample ball.
#include <cstdio>

#include "assets/ball_asset.h"
#include "common/base/error.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_ball FILE.glb\n");
    return static_cast<int>(mdk::ErrorCode::kUsage);
  }
  try {
    const auto bytes = mdk::encode_glb(mdk::make_ball_scene());
    mdk::write_bytes(argv[1], bytes);
    std::printf("%s: %zu bytes\n", argv[1], bytes.size());
  } catch (const mdk::Error& error) {
    std::fprintf(stderr, "make_ball: %s\n", error.what());
    return error.exit_status();
  }
  return 0;
}
