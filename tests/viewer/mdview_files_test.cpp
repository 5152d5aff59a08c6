// Files in the real viewer: sources that are dropped, baked, cancelled and kept, files that change,
// and what leaves the viewer again.
#include <gmock/gmock.h>

#include <filesystem>

#include "formats/mdk/writer.h"
#include "tests/viewer/mdview_gui.h"
#include "tests/viewer/mdview_title.h"
#include "tests/viewer/obj_sources.h"
#include "tests/viewer/waving_bar.h"
#include "tests/viewer/x_clipboard.h"
#include "tests/viewer/x_drop.h"

namespace mdk::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// One triangle: three corners of a unit square, as glTF with its buffer inside.
constexpr const char* kTriangle = R"({"asset": {"version": "2.0"},
  "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,)"
                                  R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                 "min": [0, 0, 0], "max": [1, 1, 0]}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
  "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})";

TEST_F(MdviewGui, ADroppedGltfIsBakedAndOpened) {
  write_text("triangle.gltf", kTriangle);
  const auto session = start({"--size", "800x600"});
  session->wait_for_window();
  drop_file(server_->display(), "mdview", folder_.file("triangle.gltf"));
  wait_for_file(*session, "triangle.gltf");
  const json state = session->quit().state;
  EXPECT_EQ(state["file"], folder_.file("triangle.gltf")) << state["error"];
  EXPECT_GT(state["last_frame"]["hits"], 1000);
  EXPECT_GT(state["open_ms"], 0);
  EXPECT_TRUE(state["baking"].is_null());
}

TEST_F(MdviewGui, WhileASourceIsBakedTheRestIsUsableAndTheBakeCanBeCancelled) {
  write_text("large.obj", large_obj(400));
  const auto bake_beside = [&] {
    auto session = start_on_bar();
    drop_file(server_->display(), "mdview", folder_.file("large.obj"));
    session->xdotool({"sleep", "0.7"});
    return session;
  };
  const auto looking = bake_beside();
  looking->key("Right");
  looking->key("3");
  const json busy = looking->quit().state;
  EXPECT_EQ(busy["baking"], "large.obj");
  EXPECT_EQ(busy["file"], "bar.mdk");
  EXPECT_EQ(busy["time"], 0.1);
  EXPECT_EQ(busy["last_frame"]["technique"], "static-kdtree");
  ASSERT_TRUE(busy["widgets"].contains("bake-progress"));
  widgets_ = busy["widgets"];

  const Point cancel = in_widget("cancel-bake");
  const auto cancelling = bake_beside();
  cancelling->click(cancel);
  const json state = cancelling->quit().state;
  EXPECT_TRUE(state["baking"].is_null());
  EXPECT_TRUE(state["error"].is_null()) << state["error"];
  EXPECT_EQ(state["file"], "bar.mdk");
  EXPECT_TRUE(state["picked"].is_null()) << "the click went to the button alone";
}

TEST_F(MdviewGui, AfterACancelAnotherBakeComesToItsEnd) {
  write_text("large.obj", large_obj(400));
  write_text("square.obj", kSquare);
  const auto session = start({"--size", "800x600"});
  session->wait_for_window();
  drop_file(server_->display(), "mdview", folder_.file("large.obj"));
  session->xdotool({"sleep", "0.7"});
  session->key("Escape");
  drop_file(server_->display(), "mdview", folder_.file("square.obj"));
  wait_for_file(*session, "square.obj");
  const json state = session->quit().state;
  EXPECT_TRUE(state["error"].is_null()) << state["error"];
  EXPECT_TRUE(state["baking"].is_null());
  EXPECT_GT(state["last_frame"]["hits"], 1000);
}

TEST_F(MdviewGui, OfManyQuickDropsTheLastCounts) {
  write_text("large.obj", large_obj(400));
  write_text("bad.mdk", "no model at all");
  for (const char* name : {"a.mdk", "b.mdk", "last.mdk"})
    std::filesystem::copy(folder_.file("bar.mdk"), folder_.file(name));
  const auto session = start({"--size", "800x600"});
  session->wait_for_window();
  for (const char* name : {"a.mdk", "large.obj", "b.mdk", "bad.mdk", "large.obj", "last.mdk"})
    drop_file(server_->display(), "mdview", folder_.file(name));
  wait_for_file(*session, "last.mdk");
  const json state = session->quit().state;
  EXPECT_EQ(state["file"], folder_.file("last.mdk"));
  EXPECT_TRUE(state["error"].is_null()) << state["error"];
  EXPECT_TRUE(state["baking"].is_null());
  EXPECT_GT(state["last_frame"]["hits"], 1000);
}

TEST_F(MdviewGui, AFileThatIsOverwrittenByGarbageStaysOpenAndThatIsSaid) {
  const auto session = start_on_bar();
  session->key("space");
  write_text("bar.mdk", "garbage, written into the open file");
  session->xdotool({"sleep", "2.5"});
  ASSERT_TRUE(session->running());
  session->key("space");
  session->key("3");
  const json state = session->quit().state;
  EXPECT_THAT(state["error"].get<std::string>(), HasSubstr("not an .mdk file"));
  EXPECT_EQ(state["file"], "bar.mdk");
  EXPECT_EQ(state["last_frame"]["technique"], "static-kdtree");
  EXPECT_GT(state["last_frame"]["hits"], 500);
}

TEST_F(MdviewGui, AFileThatComesLaterIsOpenedAsItWasAskedFor) {
  const std::vector<std::string> words = {"--size", "800x600", "--time", "0.3"};
  const auto opened = [&](const char* name) {
    std::vector<std::string> all = words;
    all.insert(all.begin(), name);
    return start(all);
  };
  const auto session = opened("late.mdk");
  session->wait_for_window();
  write_mdk(waving_bar().view(), folder_.file("late.mdk"));
  wait_for_file(*session, "late.mdk");
  const json state = session->quit().state;
  EXPECT_EQ(state["file"], "late.mdk");
  EXPECT_EQ(state["time"], 0.3);
  EXPECT_TRUE(state["error"].is_null()) << state["error"];
  EXPECT_TRUE(state["notice"].is_null()) << state["notice"];
  const auto at_once = opened("bar.mdk");
  at_once->wait_for_window();
  EXPECT_EQ(state["camera"], at_once->quit().state["camera"]);
}

TEST_F(MdviewGui, WhatWasBakedIsKeptBesideItsSource) {
  write_text("square.obj", kSquare);
  const std::vector<std::string> words = {"square.obj", "--size", "1280x800", "--tab", "file"};
  learn_widgets(words);
  const auto keep = [&] {
    const auto session = start(words);
    wait_for_file(*session, "square.obj");
    session->click(in_widget("keep-baked"));
    return session->quit().state;
  };
  EXPECT_THAT(keep()["notice"].get<std::string>(), HasSubstr("Saved square.mdk"));
  const auto opened = start({"square.mdk", "--quit-after", "1"})->finish();
  EXPECT_EQ(opened.status, 0) << opened.messages;
  EXPECT_GT(opened.state["last_frame"]["hits"], 1000);
  EXPECT_FALSE(opened.state["widgets"].contains("keep-baked"));
  const auto before = std::filesystem::last_write_time(folder_.file("square.mdk"));
  EXPECT_THAT(keep()["notice"].get<std::string>(), HasSubstr("is there already"));
  EXPECT_EQ(std::filesystem::last_write_time(folder_.file("square.mdk")), before);
}

TEST_F(MdviewGui, AFileThatChangesKeepsTheCameraAndTheRange) {
  const auto turned = [&] {
    auto session = start_on_bar();
    session->click(in_widget("time-line", 0.5));
    session->key("i");
    session->drag(in_widget("picture"), {90, 20});
    return session;
  };
  const json untouched = turned()->quit().state;
  const auto session = turned();
  write_mdk(waving_bar().view(), folder_.file("bar.mdk"));
  session->xdotool({"sleep", "2"});
  const json state = session->quit().state;
  EXPECT_THAT(state["notice"].get<std::string>(), HasSubstr("again"));
  EXPECT_EQ(state["camera"], untouched["camera"]);
  EXPECT_EQ(state["time"], untouched["time"]);
  EXPECT_EQ(state["range"], untouched["range"]);
}

TEST_F(MdviewGui, AnExportShowsItsProgressAndACancelLeavesNothing) {
  look_at_tab("file");
  const std::vector<std::string> slow = {"--tab", "file", "--samples", "256"};
  const auto looking = start_on_bar(slow);
  looking->click(in_widget("export"));
  looking->xdotool({"sleep", "0.5"});
  const json busy = looking->quit().state;
  ASSERT_TRUE(busy["exporting"].is_number());
  EXPECT_GE(busy["exporting"], 0);
  EXPECT_LT(busy["exporting"], 1);
  EXPECT_TRUE(busy["widgets"].contains("export-progress"));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("bar-frames-0001"))) << "left by a quit";

  widgets_ = busy["widgets"];
  const Point cancel = in_widget("cancel-export");
  const auto cancelling = start_on_bar(slow);
  cancelling->click(in_widget("export"));
  cancelling->xdotool({"sleep", "0.5"});
  cancelling->click(cancel);
  cancelling->xdotool({"sleep", "0.5"});
  EXPECT_TRUE(cancelling->running());
  EXPECT_FALSE(std::filesystem::exists(folder_.file("bar-frames-0001")));
  const json state = cancelling->quit().state;
  EXPECT_TRUE(state["exporting"].is_null());
  EXPECT_TRUE(state["error"].is_null()) << state["error"];
}

TEST_F(MdviewGui, TheRenderCommandGoesToTheClipboard) {
  const auto session = start_on_bar({"--shading", "clusters"});
  session->key("c");
  const std::string copied = clipboard_text(server_->display());
  const json state = session->quit().state;
  EXPECT_EQ(copied, state["render_command"]);
  EXPECT_THAT(copied, HasSubstr("--shading clusters"));
}

}  // namespace
}  // namespace mdk::test
