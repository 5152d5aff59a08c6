// What a dropped folder offers.
#include "viewer/scene/folder_list.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "tests/formats/temp_folder.h"

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

TEST(FolderList, IsEmptyWhereThereIsNothingAndRefusesWhatIsNoFolder) {
  TempFolder folder;
  EXPECT_TRUE(animations_in(folder.path()).empty());
  EXPECT_THROW(animations_in(folder.file("missing")), Error);
}

}  // namespace
}  // namespace mdk::test
