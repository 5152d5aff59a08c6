// The command line copied from the viewer; that it gives the same pixels is tested in the window.
#include <gtest/gtest.h>

#include "common/trace/technique.h"
#include "viewer/picture/export.h"

namespace mdk {
namespace {

TEST(RenderCommand, NamesAllThatThePictureDependsOnExactly) {
  RenderJob job;
  job.request.width = 640;
  job.request.height = 400;
  job.request.camera = {{0.1f, -2, 1e-7f}, {0, 0.5f, 3}, {0, 1, 0}, 40};
  job.request.shading = ShadingMode::kClusters;
  EXPECT_EQ(render_command(job, "a b/walk.mdk", "slow walk", 1.0 / 3),
            "mdprep render 'a b/walk.mdk' -o walk.png --clip 'slow walk' --time "
            "0.3333333333333333 --size 640x400 --technique " +
                std::string(technique_table()[0].id) +
                " --shading clusters --camera '0.1 -2 1e-07 0 0.5 3 0 1 0 40'");
}

TEST(RenderCommand, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(shell_word("walk.mdk"), "walk.mdk");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("it's $HOME"), "'it'\\''s $HOME'");
}

}  // namespace
}  // namespace mdk
