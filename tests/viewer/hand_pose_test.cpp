// A skeleton posed by hand: limits are kept unless told otherwise, and past them no box is trusted.
#include <gtest/gtest.h>

#include <memory>

#include "common/trace/renderer.h"
#include "common/trace/technique.h"
#include "formats/mdk/writer.h"
#include "tests/formats/mdk/sample_model.h"
#include "tests/formats/temp_folder.h"
#include "viewer/picture/requests.h"
#include "viewer/state/pose.h"

namespace mdk::test {
namespace {

TEST(HandPose, StartsAtRestWithWeightsOfTheFirstKey) {
  const ModelStorage storage = sample_skeleton_model();
  const HandPose hand = rest_pose_of(storage.view());
  EXPECT_FALSE(hand.active);
  EXPECT_EQ(hand.pose.turns, std::vector<Vec3d>(2));
  EXPECT_EQ(hand.pose.target_weights, std::vector<float>{0});
  EXPECT_EQ(joint_past_limit(storage.view().skeleton, hand.pose), kNoParent);
  EXPECT_TRUE(rest_pose_of(sample_model().view()).pose.turns.empty()) << "no skeleton, no pose";
}

TEST(HandPose, WeightsRangeOverWhatTheClipsHave) {
  const ModelStorage storage = sample_skeleton_model();
  const std::vector<WeightRange> ranges = weight_ranges(storage.view());
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_EQ(ranges[0].min, 0);
  EXPECT_EQ(ranges[0].max, 2);
}

TEST(HandPose, TurnsAreShortenedToTheLimitUnlessTheyMayGoBeyond) {
  const ModelStorage storage = sample_skeleton_model();
  const SkeletonView skeleton = storage.view().skeleton;
  HandPose hand = rest_pose_of(storage.view());
  turn_joint(hand, skeleton, {0.3, 0, 0.1});
  EXPECT_EQ(hand.pose.turns[0], (Vec3d{0.3, 0, 0.1}));
  turn_joint(hand, skeleton, {0, 2, 0});
  EXPECT_NEAR(hand.pose.turns[0].y, 0.5, 1e-6);
  EXPECT_EQ(joint_past_limit(skeleton, hand.pose), kNoParent);
  hand.beyond_limits = true;
  turn_joint(hand, skeleton, {0, 2, 0});
  EXPECT_EQ(hand.pose.turns[0].y, 2);
  EXPECT_EQ(joint_past_limit(skeleton, hand.pose), 0u);
}

TEST(HandPose, PastALimitThePictureIsTracedByBoxesOfThisPoseAlone) {
  const TempFolder folder;
  write_mdk(sample_skeleton_model().view(), folder.file("a.mdk"));
  ViewState state;
  state.file = std::make_shared<const MdkFile>(folder.file("a.mdk"));
  state.playback = Playback(clip_times(*state.model()));
  state.hand = rest_pose_of(*state.model());
  EXPECT_FALSE(picture_job(state, 8, 8).pose);
  state.hand.active = true;
  EXPECT_EQ(picture_job(state, 8, 8).pose, state.hand.pose);
  EXPECT_EQ(picture_job(state, 8, 8).technique, state.settings.technique);
  state.hand.beyond_limits = true;
  turn_joint(state.hand, state.model()->skeleton, {3, 0, 0});
  EXPECT_EQ(picture_job(state, 8, 8).technique, technique_row("refit-bvh"));
}

TEST(HandPose, APickIsTheTriangleThatThePosedPictureShows) {
  const ModelStorage storage = sample_skeleton_model();
  const ModelView model = storage.view();
  HandPose hand = rest_pose_of(model);
  turn_joint(hand, model.skeleton, {0.3, 0.2, 0.1});
  FrameRequest request;
  request.width = 48;
  request.height = 32;
  request.camera = fit_camera(model.bounds, 1.5);
  request.pose = &hand.pose;
  Renderer renderer(model, "refit-bvh");
  renderer.trace(request);
  ASSERT_GT(renderer.stats().hits, 0u);
  const Moment moment{{}, hand.pose};
  const PictureRays picture{request.camera, request.width, request.height};
  for (std::uint32_t y = 0; y < request.height; ++y)
    for (std::uint32_t x = 0; x < request.width; ++x) {
      const auto pick = pick_triangle(model, moment, picture, x, y);
      EXPECT_EQ(pick ? pick->triangle : kNoHit, renderer.hits().triangle(x, y)) << x << " " << y;
    }
  const PosedMesh mesh = mesh_at(model, moment);
  const ClusterPlaces places = cluster_places(model, moment);
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c)
    EXPECT_EQ(places.local_from_world[c], mesh.cluster_map(c));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(corners_at(model, moment, 0)[i],
              to_double(mesh.positions()[model.triangles[0].v[i]]));
}

}  // namespace
}  // namespace mdk::test
