// Lists of jobs for 'mdprep batch'.
#include "preprocess/batch/manifest.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

void read_list(std::span<const unsigned char> bytes) {
  static FuzzFile file("jobs.json");
  read_manifest(file.holding(bytes));
}

std::vector<Bytes> manifest_seeds() {
  return {bytes_of(R"({"bakes": [{"input": "a.glb", "output": "a.mdk"}]})"), bytes_of(R"({
  "records": "r",
  "defaults": {"bake": {"options": {"fps": 24, "refine": false}, "memory": "2G", "threads": 2},
               "render": {"minutes": 5}},
  "bakes": [{"input": ["cow.obj", "cow.pc2"], "output": "{stem}.mdk", "exclude": ["old*"]}],
  "verifies": [{"input": "cow.mdk", "source": true}],
  "renders": [{"input": "cow.mdk", "output": "cow_####.png", "frames": "0:100:2",
               "frames_per_job": 10, "options": {"size": "64x64", "shading": "lit"}}]
})")};
}

}  // namespace

const FuzzTarget& manifest_target() {
  static const FuzzTarget target = {"manifest", read_list, manifest_seeds};
  return target;
}

}  // namespace mdk::test
