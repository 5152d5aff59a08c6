#include "preprocess/commands/source.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

class JobShares : public testing::Test {
 protected:
  std::string sized(const std::string& name, std::uintmax_t bytes) const {
    write_text(folder_.file(name), "");
    std::filesystem::resize_file(folder_.file(name), bytes);
    return folder_.file(name);
  }
  Source cached_mesh(std::uintmax_t mesh_bytes, std::uintmax_t cache_bytes) const {
    return {SourceKind::kMeshAndCache,
            {"", {sized("a.obj", mesh_bytes), sized("a.pc2", cache_bytes)}, {0, 1}},
            {}};
  }
  TempFolder folder_;
};

TEST_F(JobShares, ALongCacheThatIsNotDecomposedIsReadingAndWritingToAGoodPart) {
  const Source source = cached_mesh(15'000'000, 5'400'000'000);
  DecomposeOptions options;
  options.mode = DecomposeMode::kNone;
  options.segments = 1;
  const JobEnds plain = predict_job_ends(source, options);
  EXPECT_GT(plain.read, 0.15);
  EXPECT_LT(plain.read, 0.35);
  EXPECT_LT(plain.decomposed, 0.93);
  const JobEnds decomposed = predict_job_ends(source, {});
  EXPECT_LT(decomposed.read, 0.1);
  EXPECT_GT(decomposed.decomposed, 0.95);
}

TEST_F(JobShares, EachFileOfASequenceHasToBeParsed) {
  const Source few{SourceKind::kMeshes, {"", {sized("a1.obj", 1'000'000)}, {1}}, {}};
  Source many = few;
  many.files.files.resize(100, few.files.files.front());
  EXPECT_GT(predict_job_ends(many, {}).read, 2 * predict_job_ends(few, {}).read);
}

TEST_F(JobShares, AreInOrderWhateverIsThere) {
  for (const SourceKind kind : {SourceKind::kGltf, SourceKind::kThroughAssimp, SourceKind::kMeshes,
                                SourceKind::kMeshAndCache}) {
    const JobEnds ends =
        predict_job_ends({kind, {"", {folder_.file("none.obj"), "none.pc2"}, {0, 1}}, {}}, {});
    EXPECT_LE(0, ends.read);
    EXPECT_LT(ends.read, ends.decomposed);
    EXPECT_LT(ends.decomposed, 1);
  }
}

}  // namespace
}  // namespace mdk::test
