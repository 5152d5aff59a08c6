// Casts become the scenes that they describe; what is wrong in them is named with line and column.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "formats/mdk/writer.h"
#include "preprocess/casts/cast.h"
#include "preprocess/casts/scatter.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/mdk/sample_model.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

constexpr double kPi = std::numbers::pi;

class Casts : public testing::Test {
 protected:
  Casts() {
    std::filesystem::create_directory(folder_.file("models"));
    write_mdk(sample_model().view(), folder_.file("models/a.mdk"));
    write_mdk(sample_rig_model().view(), folder_.file("models/b.mdk"));
    clip_ = sample_model().clips[1].name;
  }

  std::string write(const std::string& name, const std::string& text) const {
    write_text(folder_.file(name), text);
    return folder_.file(name);
  }
  SceneStorage json(const std::string& text) {
    SceneBuilder scene(folder_.file("out/crowd.mds"));
    read_json_cast(write("cast.json", text), scene);
    files_ = scene.model_files();
    return scene.finish();
  }
  /// With models a and b.
  SceneStorage instances(const std::string& list) {
    return json(R"({"schema":"mdk-scene/1","models":[{"file":"models/a.mdk"},
{"file":"models/b.mdk"}],"instances":[
)" + list + "]}");
  }
  void expect_refused(const std::string& instance, const std::string& words) {
    expect_error(ErrorCode::kBadInput, "cast.json: line " + words, [&] { instances(instance); });
  }
  SceneStorage csv(const std::string& text, const CastOptions& options = {}) {
    SceneBuilder scene(folder_.file("crowd.mds"));
    read_csv_cast(write("cast.csv", text), options, scene);
    return scene.finish();
  }
  SceneStorage walk(const std::string& text, CastOptions options = {}) {
    options.models = {folder_.file("models/a.mdk")};
    SceneBuilder scene(folder_.file("crowd.mds"));
    read_trajectories(write("walk.txt", text), options, scene, notes_);
    return scene.finish();
  }

  TempFolder folder_;
  std::string clip_;
  std::vector<SceneModelFile> files_;
  std::vector<std::string> notes_;
};

Vec3f moved(const SceneStorage& scene, std::size_t instance, const Vec3d& p) {
  return to_float(to_double(scene.instances[instance].map).point(p));
}

void expect_near(const Vec3f& a, const Vec3f& b) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-5) << i;
}

TEST_F(Casts, JsonSaysEverything) {
  const SceneStorage scene = instances(
      R"({"model":1,"position":[1,2,3],"orientation":[0,0.6,0,0.8],"scale":[1,2,3],"clip":")" +
      clip_ + R"(","start":0.3,"speed":-1.5,"wrap":"ping-pong","tint":[1,0.5,0],"mask":6,"id":-17},
{"model":0,"matrix":[0,1,0,0, -1,0,0,0, 0,0,2,0, 5,6,7,1]})");
  ASSERT_EQ(scene.instances.size(), 2u);
  const SceneInstance& first = scene.instances[0];
  EXPECT_EQ(scene.roles[first.role()], (SceneRole{1, 1}));
  EXPECT_EQ(first.start, 0.3);
  EXPECT_EQ(first.speed, -1.5f);
  EXPECT_EQ(first.wrap(), ClipWrap::kPingPong);
  EXPECT_FALSE(first.has_path());
  EXPECT_EQ(scene.labels[0].id, -17);
  EXPECT_EQ(scene.labels[0].mask, 6u);
  EXPECT_EQ(scene.labels[0].tint, 0xff0080ffu);
  // About y by 2 atan(0.75): cosine 0.28, sine 0.96.
  expect_near(moved(scene, 0, {1, 1, 0}), {1 + 0.28f, 4, 3 - 0.96f});
  expect_near(moved(scene, 0, {0, 0, 1}), {1 + 3 * 0.96f, 2, 3 + 3 * 0.28f});
  expect_near(moved(scene, 1, {1, 0, 0}), {5, 7, 7});
  expect_near(moved(scene, 1, {0, 0, 1}), {5, 6, 9});
  EXPECT_EQ(scene.labels[1].id, 1);
  EXPECT_EQ(scene.roles[scene.instances[1].role()], (SceneRole{0, 0}));
  EXPECT_EQ(files_[1].name, "../models/b.mdk");
}

TEST_F(Casts, JsonOrderDoesNotMatter) {
  const SceneStorage scene = json(
      R"({"instances":[{"model":0},{"model":0,"position":[1,0,0]}],
          "models":[{"file":"models/a.mdk"}],"schema":"mdk-scene/1"})");
  EXPECT_EQ(scene.instances.size(), 2u);
}

TEST_F(Casts, JsonHasPaths) {
  const SceneStorage scene = instances(
      R"({"model":0,"scale":2,"path":"loop","keys":[{"time":1,"position":[1,0,0]},
         {"time":2.5,"position":[2,0,0],"orientation":[0,0,1,0],"scale":3}]})");
  ASSERT_EQ(scene.paths.size(), 1u);
  EXPECT_TRUE(scene.instances[0].has_path());
  EXPECT_EQ(scene.paths[0].ends, PathEnds::kLoop);
  EXPECT_EQ(scene.path_keys[1].time, 2.5);
  EXPECT_EQ(scene.path_keys[1].scale.z, 3);
  EXPECT_EQ(scene.first_time, 1);
  EXPECT_EQ(scene.last_time, 2.5);
  EXPECT_EQ(scene.instances[0].map.m[0][0], 2);
}

TEST_F(Casts, JsonFaultsAreNamedWithTheirPlaces) {
  expect_refused(R"({"model":2})", "3, column 10: must be the number of a model, 0 to 1");
  expect_refused(R"({"model":0, "colour":1})", "3, column 13: \"colour\" is no field");
  expect_refused(R"({"model":0,
"clip":"wlak"})",
                 "3, column 1: the model has no clip \"wlak\"; it has \"");
  expect_refused(R"({"model":0,"scale":0})", "3, column 1: its transform is flat");
  expect_refused(R"({"model":0,"scale":1e-60})", "3, column 1: its transform is flat");
  expect_refused(R"({"model":0,"position":[1,2]})", "3, column 23: must be a list of 3 numbers");
  expect_refused(R"({"model":0,"position":[1,2 3]})", "3, column 28: is no JSON from here");
  expect_refused(R"({"model":0,"start":1e999})", "3, column 20: a number is out of range");
  expect_refused(R"({"model":0,"orientation":[0,0,0,2]})", "3, column 26: must be a unit");
  expect_refused(R"({"model":0,"keys":[{"time":1},{"time":1}]})",
                 "3, column 19: key 1 is not later");
  expect_refused(R"({"model":0,"model":1})", "3, column 12: \"model\" is there twice");
  expect_refused(R"({"model":0,"wrap":"lop"})", "3, column 19: must be one of \"loop\"");
  expect_refused(R"({"model":0,"tint":[2,0,0]})", "3, column 19: must be three numbers from 0");
  expect_refused(R"({"model":0,"id":0.5})", "3, column 17: must be a whole number");
  expect_refused(R"({"model":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]})", "3, column 21: must");
  expect_refused(R"({"model":0,"path":"hide"})", "3, column 19: says how a path ends");
  expect_refused(R"(7)", "3, column 1: must be an object");
  expect_refused(R"([[[[[[[[[[[[[[[[[[[[[[)", "3, column 15: is nested too deeply");
  expect_error(ErrorCode::kBadInput, "must say \"schema\"", [&] { json("{}"); });
  expect_error(ErrorCode::kBadInput, "must be an object", [&] { json("3"); });
  expect_error(ErrorCode::kBadInput, "is no JSON", [&] { json(""); });
  expect_error(ErrorCode::kIo, "cast.json: line 1, column 45: ", [&] {
    json(R"({"schema":"mdk-scene/1","models":[{"file":  "no.mdk"}],"instances":[{"model":0}]})");
  });
}

TEST_F(Casts, TablesSayWhoStandsWhere) {
  const SceneStorage scene =
      csv("model,x,y,z,heading,scale,clip,start,speed,wrap,id,tint,mask\r\n"
          "\"models/a.mdk\",1,2,3,90,2," +
          clip_ +
          ",0.5,2,once,12,#ff8000,3\r\n"
          "\n"
          "models/b.mdk,,,,,,,,,,,,\n");
  ASSERT_EQ(scene.instances.size(), 2u);
  expect_near(moved(scene, 0, {0, 0, 1}), {3, 2, 3});  // forward, +z, turns to +x
  expect_near(moved(scene, 0, {0, 1, 0}), {1, 4, 3});
  EXPECT_EQ(scene.roles[scene.instances[0].role()], (SceneRole{0, 1}));
  EXPECT_EQ(scene.instances[0].start, 0.5);
  EXPECT_EQ(scene.instances[0].wrap(), ClipWrap::kOnce);
  EXPECT_EQ(scene.labels[0].tint, 0xff0080ffu);
  EXPECT_EQ(scene.labels[0].id, 12);
  expect_near(moved(scene, 1, {1, 2, 3}), {1, 2, 3});
  CastOptions options;
  options.models = {folder_.file("models/a.mdk")};
  options.up = UpAxis::kZ;
  expect_near(moved(csv("heading\n90\n", options), 0, {1, 0, 5}), {0, 1, 5});
}

TEST_F(Casts, FaultsOfTablesAreNamedWithTheirPlaces) {
  const auto expect = [&](const std::string& text, const std::string& words) {
    expect_error(ErrorCode::kBadInput, "cast.csv: " + words, [&] { csv(text); });
  };
  expect("model,x,colour\n",
         "line 1, column 9: no column has the name \"colour\"; there are model");
  expect("model,x,x\n", "line 1, column 9: the column \"x\" is there twice");
  expect("x\n1\n", "line 1, column 1: has no column \"model\"");
  expect("model,x\nmodels/a.mdk,ten\n", "line 2, column 14: x must be a number, not \"ten\"");
  expect("model,x\nmodels/a.mdk,inf\n", "line 2, column 14: x must be a number");
  expect("model,x\nmodels/a.mdk\n", "line 2, column 1: has 1 cells, not 2");
  expect("model,x\nmodels/a.mdk,\"1\n", "line 2, column 14: a quote is not closed");
  expect("model,wrap\nmodels/a.mdk,lop\n", "line 2, column 14: wrap must be loop");
  expect("model,tint\nmodels/a.mdk,red\n", "line 2, column 14: tint must be #rrggbb");
  expect("model,scale\nmodels/a.mdk,0\n", "line 2, column 1: its transform is flat");
  expect("", "is empty");
}

TEST_F(Casts, TrajectoriesBecomePaths) {
  CastOptions options;
  options.stride = 0.5;
  std::string text = "# framerate: 10 fps\n# id frame x/m y/m z/m\n";
  // 7 walks along x, turns and walks along y; 8 stands for ever.
  for (int i = 0; i <= 100; ++i) {
    const double x = 0.1 * std::min(i, 50), y = 0.1 * std::max(i - 50, 0);
    text += "7 " + std::to_string(20 + i) + " " + std::to_string(x) + " " + std::to_string(y) +
            " 0.25\n8 " + std::to_string(i) + " 3 4 0\n";
  }
  const SceneStorage scene = walk(text, options);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(scene.labels[0].id, 7);
  EXPECT_NEAR(scene.instances[0].speed, 2, 1e-5);  // a metre a second at half a metre a second
  EXPECT_EQ(scene.instances[1].speed, 0);
  EXPECT_EQ(scene.paths[0].ends, PathEnds::kHide);
  EXPECT_EQ(scene.last_time, 12);
  EXPECT_LT(scene.path_keys.size(), 60u);  // of 202
  EXPECT_EQ(scene_fault(scene.view()), "");

  const Stage stage(scene.view(), {Model::load(folder_.file("models/a.mdk"))});
  EXPECT_FALSE(stage.is_shown(0, 1.9));
  EXPECT_TRUE(stage.is_shown(0, 2));
  // The ground's y is -z where y points up; a model looks along +z.
  const auto forward_at = [&](double time) {
    const Affine3d map = to_double(stage.world_from_model(0, time));
    return std::pair(to_float(map.point({0, 0, 0})), to_float(map.vector({0, 0, 1})));
  };
  expect_near(forward_at(4.5).first, {2.5f, 0.25f, 0});
  expect_near(forward_at(4.5).second, {1, 0, 0});
  expect_near(forward_at(9.5).first, {5, 0.25f, -2.5f});
  expect_near(forward_at(9.5).second, {0, 0, -1});

  options.up = UpAxis::kZ;
  const SceneStorage upright = walk(text, options);
  const Stage other(upright.view(), {Model::load(folder_.file("models/a.mdk"))});
  const Affine3d map = to_double(other.world_from_model(0, 4.5));
  expect_near(to_float(map.point({0, 0, 0})), {2.5f, 0, 0.25f});
  expect_near(to_float(map.vector({0, -1, 0})), {1, 0, 0});
}

TEST_F(Casts, FaultsOfTrajectoriesAreNamedWithTheirPlaces) {
  CastOptions options;
  options.fps = 25;
  const auto expect = [&](const std::string& text, const std::string& words) {
    expect_error(ErrorCode::kBadInput, "walk.txt: " + words, [&] { walk(text, options); });
  };
  expect("1 2 3\n", "line 1, column 1: has 3 numbers, not \"id frame x y [z]\"");
  expect("# a\n1 2 3 b\n", "line 2, column 7: the y must be a number, not \"b\"");
  expect("1.5 2 3 4\n", "line 1, column 1: the id must be a whole number");
  expect("1 2 3 4\n1 3 4 5 6\n", "line 2, column 1: has 5 numbers, not 4");
  expect("1 2 3 4\n1 2 4 4\n", "line 2, column 1: id 1 is in this frame twice");
  expect("# nothing\n", "holds no lines");
  expect_error(ErrorCode::kUsage, "give --fps", [&] { walk("1 2 3 4\n"); });
}

/// A body of height 2 and two feet that touch the ground in turn, moving backwards at 1.5 a second
/// while they do.
TEST(Stride, FollowsFromTheFeetOnTheGround) {
  ModelStorage model;
  model.vertex_count = 3;
  model.clips = {{"walk", 0, 21}, {"stand", 21, 5}};
  std::vector<Vec3f> positions;
  for (int k = 0; k < 26; ++k) {
    model.key_times.push_back((k < 21 ? k : k - 21) * 0.05);
    const double phase = k < 21 ? k * 0.05 : 0;
    const auto foot = [&](double offset) {
      const double at = std::fmod(phase + offset, 1.0);
      const bool is_down = at < 0.5;
      const double z = is_down ? 0.375 - 1.5 * at : -0.375 + 1.5 * (at - 0.5);
      return Vec3f{0.1f, is_down ? 0.0f : static_cast<float>(0.3 * std::sin(kPi * (at - 0.5) * 2)),
                   static_cast<float>(z)};
    };
    Aabb& box = model.key_boxes.emplace_back();
    for (const Vec3f& p : {Vec3f{0, 2, 0}, foot(0), foot(0.5)}) {
      positions.push_back(p);
      box.extend(p);
    }
  }
  model.poses.key_positions.assign(positions.begin(), positions.end());
  const auto speed = stride_speed(model.view(), 0, UpAxis::kY);
  ASSERT_TRUE(speed);
  EXPECT_NEAR(*speed, 1.5, 0.01);
  EXPECT_FALSE(stride_speed(model.view(), 1, UpAxis::kY));
}

TEST_F(Casts, PatternsKeepTheirDistanceAndAreTheSameForASeed) {
  CastOptions options;
  options.models = {folder_.file("models/a.mdk"), folder_.file("models/b.mdk")};
  for (const ScatterPattern pattern : {ScatterPattern::kGrid, ScatterPattern::kRows,
                                       ScatterPattern::kDisc, ScatterPattern::kStadium}) {
    const auto make = [&](std::uint64_t seed) {
      SceneBuilder scene(folder_.file("crowd.mds"));
      scatter({pattern, 500, seed, 2.0}, options, scene);
      return scene.finish();
    };
    const SceneStorage scene = make(1), again = make(1), other = make(2);
    ASSERT_EQ(scene.instances.size(), 500u);
    const auto place = [&](std::size_t i) {
      return Vec3d{scene.instances[i].map.m[0][3], scene.instances[i].map.m[1][3],
                   scene.instances[i].map.m[2][3]};
    };
    double nearest = 1e9;
    for (std::size_t i = 0; i < 500; ++i)
      for (std::size_t k = 0; k < i; ++k) nearest = std::min(nearest, length(place(i) - place(k)));
    EXPECT_GT(nearest, 1.5) << static_cast<int>(pattern);
    EXPECT_LT(nearest, 2.5) << static_cast<int>(pattern);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < 500; ++i) {
      EXPECT_EQ(scene.instances[i].start, again.instances[i].start);
      moved += scene.instances[i].start != other.instances[i].start;
    }
    EXPECT_GT(moved, 400u);
  }
}

TEST_F(Casts, AStadiumLooksAtItsMiddle) {
  CastOptions options;
  options.models = {folder_.file("models/a.mdk")};
  SceneBuilder scene(folder_.file("crowd.mds"));
  scatter({ScatterPattern::kStadium, 2000, 1, 1.0}, options, scene);
  for (const SceneInstance& instance : scene.finish().instances) {
    const Vec3d at{instance.map.m[0][3], 0, instance.map.m[2][3]};
    const Vec3d looks = to_double(instance.map).vector({0, 0, 1});
    EXPECT_LT(dot(looks, at), 0);
  }
}

}  // namespace
}  // namespace mdk::test
