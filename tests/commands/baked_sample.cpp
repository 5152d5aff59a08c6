#include "tests/commands/baked_sample.h"

#include "tests/commands/program_run.h"
#include "tests/commands/sample_mesh.h"

namespace mdk::test {

TempFolder* BakedSample::shared_ = nullptr;

void BakedSample::SetUpTestSuite() {
  shared_ = new TempFolder;
  write_sample_gltf(source());
  const Outcome bake = run_mdprep({"bake", source(), "-o", baked(), "-q"});
  ASSERT_EQ(bake.status, 0) << bake.err;
  ASSERT_EQ(bake.out + bake.err, "") << "-q means silence";
}

void BakedSample::TearDownTestSuite() {
  delete shared_;
  shared_ = nullptr;
}

}  // namespace mdk::test
