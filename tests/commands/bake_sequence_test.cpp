// Meshes in a file for each key, baked by the real mdprep.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/commands/program_run.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// A square that folds along its diagonal, in twelve files without leading zeros.
class BakeSequence : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 1; i <= 12; ++i)
      write_text(file(i),
                 "v 0 0 0\nv 1 0 " + std::to_string(i) + "\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  }
  std::string file(int i) const { return inputs_.file("fold" + std::to_string(i) + ".obj"); }
  Json bake(const std::vector<std::string>& inputs) {
    std::vector<std::string> arguments = {"bake"};
    arguments.insert(arguments.end(), inputs.begin(), inputs.end());
    for (const char* more : {"-v", "--fps", "4", "-o"}) arguments.emplace_back(more);
    for (const std::string& more : {baked_, std::string("--report"), outputs_.file("r.json"),
                                    std::string("--depfile"), outputs_.file("r.d")})
      arguments.push_back(more);
    const Outcome outcome = run_mdprep(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    err_ = outcome.err;
    return Json::parse(read_text(outputs_.file("r.json")));
  }

  TempFolder inputs_, outputs_;
  const std::string baked_ = outputs_.file("fold.mdk");
  std::string err_;
};

TEST_F(BakeSequence, AFolderAPatternAListAndAFirstFileAreTheSame) {
  std::vector<std::string> list;
  for (const int i : {1, 10, 11, 12, 2, 3, 4, 5, 6, 7, 8, 9}) list.push_back(file(i));
  const std::vector<std::vector<std::string>> inputs = {
      {inputs_.path()}, {inputs_.file("fold####.obj")}, list, {file(1)}};
  std::string bytes;
  for (const std::vector<std::string>& input : inputs) {
    SCOPED_TRACE(input.front());
    const Json report = bake(input);
    EXPECT_EQ(report["clips"], Json::parse(R"([{"name":"fold","seconds":2.75,"keys":12}])"));
    EXPECT_EQ(report["triangles"], 2);
    const std::string depfile = read_text(outputs_.file("r.d"));
    for (int i = 1; i <= 12; ++i) EXPECT_THAT(depfile, HasSubstr(file(i)));
    if (bytes.empty()) bytes = read_text(baked_);
    EXPECT_EQ(read_text(baked_), bytes);
  }
  EXPECT_THAT(err_, HasSubstr("fold1.obj is read as the first of a sequence, up to "));
  const Outcome same = run_mdprep({"verify", baked_, "--source", inputs_.path(), "--fps", "4"});
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("largest error 0 of"));
}

TEST_F(BakeSequence, TheLastFileIsOneKeyAndAFirstFileTakesNoneBeforeIt) {
  EXPECT_EQ(bake({file(12)})["keys"], 1);
  EXPECT_EQ(bake({file(5)})["keys"], 8);
}

TEST_F(BakeSequence, GapsAreNoted) {
  std::filesystem::remove(file(5));
  EXPECT_EQ(bake({inputs_.path()})["clips"][0]["seconds"], 2.75);
  EXPECT_THAT(err_, HasSubstr("files of fold are missing, numbers 5;"));
}

TEST_F(BakeSequence, NoFileOfASequenceIsEverOverwritten) {
  const std::string before = read_text(file(7));
  for (const std::string& input : {inputs_.path(), inputs_.file("fold#.obj"), file(1)}) {
    const Outcome outcome = run_mdprep({"bake", input, "-o", file(7)});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("fold7.obj: is the input"));
  }
  EXPECT_EQ(read_text(file(7)), before);
}

TEST_F(BakeSequence, AFileOfOtherFacesIsNamedAndNothingIsWritten) {
  write_text(file(9), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n");
  const Outcome outcome = run_mdprep({"bake", inputs_.path(), "-o", baked_});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("fold9.obj: has 1 triangles where"));
  EXPECT_TRUE(outputs_.names().empty());
}

TEST_F(BakeSequence, WhatCannotBeDecomposedIsNamed) {
  write_text(inputs_.file("far.obj"), "v 1e38 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  const Outcome outcome = run_mdprep({"bake", inputs_.file("far.obj"), "-o", baked_});
  EXPECT_EQ(outcome.status, 3);
  EXPECT_TRUE(is_one_sentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("far.obj: a vertex position is not a number between"));
}

TEST_F(BakeSequence, AReportThatCannotBeWrittenIsRefusedBeforeTheWork) {
  const Outcome outcome = run_mdprep({"bake", file(1), "-o", baked_, "--report", "/dev/full"});
  EXPECT_EQ(outcome.status, 4);
  EXPECT_THAT(outcome.err, HasSubstr("/dev/full: cannot be written: it is not a regular file"));
  EXPECT_FALSE(std::filesystem::exists(baked_));
}

TEST_F(BakeSequence, NamesInNotesAreFitForATerminal) {
  write_text(inputs_.file("tinted.obj"),
             "mtllib \x1b[31m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  const Outcome outcome = run_mdprep({"bake", inputs_.file("tinted.obj"), "-o", baked_, "-v"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("material file \"?[31m.mtl\" of"));
  EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace mdk::test
