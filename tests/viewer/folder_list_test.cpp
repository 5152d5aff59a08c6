// What a dropped folder offers.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "formats/files/file_kind.h"
#include "tests/formats/temp_folder.h"
#include "viewer/scene/file_list.h"

namespace mdk::test {
namespace {

std::vector<std::string> labels_of(const std::vector<FileChoice>& choices) {
  std::vector<std::string> labels;
  for (const FileChoice& choice : choices) labels.push_back(choice.label);
  return labels;
}

TEST(FolderList, OffersBakedFilesThenGltfThenMeshesWithCachesThenASequence) {
  TempFolder folder;
  for (const char* name : {"walk.glb", "b.MDK", "a.mdk", "cow.obj", "cow.pc2", "run_001.obj",
                           "run_002.obj", "run_003.obj", "lone.obj", "notes.txt", "scene.gltf"})
    std::ofstream(folder.file(name)) << "x";
  std::filesystem::create_directory(folder.file("inner.mdk"));
  const auto choices = animations_in(folder.path());
  EXPECT_EQ(labels_of(choices),
            (std::vector<std::string>{"a.mdk", "b.MDK", "scene.gltf", "walk.glb",
                                      "cow.obj + cow.pc2", "3 poses, one animation"}));
  EXPECT_EQ(choices[4].paths,
            (std::vector<std::string>{folder.file("cow.obj"), folder.file("cow.pc2")}));
  EXPECT_EQ(choices[5].paths, (std::vector<std::string>{folder.path()}));
}

TEST(FolderList, OffersWhatIsReadThroughAssimpAfterGltfInBuildsThatHaveIt) {
  TempFolder folder;
  std::vector<std::string> expected;
  for (const std::string_view extension : extensions_of(FileKind::kForAssimp)) {
    expected.push_back("walk" + std::string(extension));
    std::ofstream(folder.file(expected.back())) << "x";
  }
  ASSERT_GT(expected.size(), 5u);
  if (!has_assimp()) expected.clear();
  for (const char* name : {"hand.glb", "run.obj", "run.pc2", "bend.md5anim"})
    std::ofstream(folder.file(name)) << "x";
  std::ranges::sort(expected);
  expected.insert(expected.begin(), "hand.glb");
  expected.push_back("run.obj + run.pc2");
  EXPECT_EQ(labels_of(animations_in(folder.path())), expected);
  EXPECT_EQ(openable_extensions().find(".fbx") != std::string::npos, has_assimp());
}

TEST(FolderList, IsEmptyWhereThereIsNothingAndRefusesWhatIsNoFolder) {
  TempFolder folder;
  EXPECT_TRUE(animations_in(folder.path()).empty());
  EXPECT_THROW(animations_in(folder.file("missing")), Error);
}

}  // namespace
}  // namespace mdk::test
