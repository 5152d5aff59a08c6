// Writes the target's seeds into a folder, for libFuzzer to start from.
#include <cstdio>
#include <filesystem>

#include "tests/fuzz/fuzz_target.h"

int main(int argc, char** argv) {
  using namespace mdk::test;
  if (argc != 2) {
    std::fputs("usage: PROGRAM FOLDER\n", stderr);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  const std::vector<Bytes> seeds = MDK_FUZZ_TARGET().seeds();
  for (std::size_t i = 0; i < seeds.size(); ++i)
    write_bytes((folder / ("seed" + std::to_string(i))).string(), seeds[i]);
}
