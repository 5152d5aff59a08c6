// What a program sees of a model and its rays: the file's numbers, errors instead of crashes, and
// hits that are brute force's to the bit.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "common/motion/model_handle.h"
#include "common/trace/brute_force.h"
#include "formats/mdk/writer.h"
#include "mdk/error.h"
#include "mdk/ray_query.h"
#include "tests/agreement/test_scenes.h"
#include "tests/formats/temp_folder.h"

namespace mdk {
namespace {

using testing::HasSubstr;

/// Baked, written and loaded, as a program has it; two clips of different lengths.
Model load_boxes() {
  PoseSequence sequence = test::flying_boxes(8, 7);
  sequence.clips = {{"fly", 0, 4}, {"fall", 4, 3}};
  for (std::size_t key = 4; key < 7; ++key)
    sequence.key_times[key] = 0.5 * static_cast<double>(key - 4);
  const DecomposeResult baked = test::bake(std::move(sequence));
  const test::TempFolder folder;
  write_mdk(baked.model.view(), folder.file("boxes.mdk"));
  return Model::load(folder.file("boxes.mdk"));  // the folder goes: the mapping stays
}

/// The sentence of the error that `call` throws, which must be one of wrong use.
template <class Call>
std::string wrong_use(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

TEST(PublicModel, TellsWhatTheFileHolds) {
  const Model model = load_boxes();
  const ModelView& view = ModelHandle::view(model);
  EXPECT_EQ(model.vertex_count(), view.vertex_count);
  EXPECT_EQ(model.triangle_count(), 8u * 12);
  EXPECT_EQ(model.key_count(), 7u);
  ASSERT_EQ(model.clip_count(), 2u);
  EXPECT_EQ(model.clip(1).name, "fall");
  EXPECT_EQ(model.clip(1).seconds, 1.0);
  EXPECT_EQ(model.clip(1).first_key, 4u);
  EXPECT_EQ(model.clip(1).key_count, 3u);
  EXPECT_EQ(model.find_clip("fall"), std::optional<std::uint32_t>(1));
  EXPECT_EQ(model.find_clip("rise"), std::nullopt);
  EXPECT_EQ(model.bounds(), view.bounds);
  EXPECT_EQ(model.clip_bounds(1), clip_bounds(view, 1));
  EXPECT_TRUE(model.bounds().contains(model.clip_bounds(1)));
  EXPECT_EQ(model.locate_time(1, 0.75), (KeyInterval{5, 6, 0.5f}));
  EXPECT_EQ(model.locate_time(1, 99), model.at_key(6));
  EXPECT_EQ(model.source_triangle(3), view.source_triangles[3]);
}

TEST(PublicModel, RefusesWhatIsNotThere) {
  const Model model = load_boxes();
  EXPECT_EQ(wrong_use([&] { model.clip(99); }), "clip 99 is not among the model's 2 clips");
  EXPECT_THAT(wrong_use([&] { model.clip_bounds(2); }), HasSubstr("clip 2"));
  EXPECT_THAT(wrong_use([&] { model.locate_time(99, 0); }), HasSubstr("clip 99"));
  EXPECT_THAT(wrong_use([&] { model.at_key(100'000); }), HasSubstr("key 100000"));
  EXPECT_THAT(wrong_use([&] { model.source_triangle(96); }), HasSubstr("triangle 96"));
  for (const double seconds : {std::nan(""), std::numeric_limits<double>::infinity(),
                               -std::numeric_limits<double>::infinity()})
    EXPECT_THAT(wrong_use([&] { model.locate_time(0, seconds); }), HasSubstr("finite"));
  try {
    Model::load("/none.mdk");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kIo);
  }
}

TEST(PublicRayQuery, RefusesTimesThatTheModelDoesNotHave) {
  const Model model = load_boxes();
  const RayQuery query(model);
  const QueryRay ray{{}, {0, 0, 1}};
  const float nan = std::nanf("");
  for (const KeyInterval& time :
       {KeyInterval{100'000, 100'000, 0}, KeyInterval{6, 7, 0.5f}, KeyInterval{0, 2, 0.5f},
        KeyInterval{1, 0, 0.5f}, KeyInterval{3, 4, 0.5f} /* of two clips */, KeyInterval{0, 1, nan},
        KeyInterval{0, 1, 1}, KeyInterval{0, 1, -0.5f}, KeyInterval{0, 0, nan},
        KeyInterval{0xFFFFFFFF, 0, 0}}) {
    EXPECT_THAT(wrong_use([&] { query.closest_hit(ray, time); }), HasSubstr("time"));
    EXPECT_THAT(wrong_use([&] { query.any_hit(ray, time); }), HasSubstr("time"));
    EXPECT_THAT(wrong_use([&] { query.prepare(time); }), HasSubstr("time"));
    QueryHit hit;
    std::uint8_t is_hit = 0;
    EXPECT_THAT(wrong_use([&] { query.closest_hits(&ray, &time, &hit, 1); }), HasSubstr("time"));
    EXPECT_THAT(wrong_use([&] { query.any_hits(&ray, &time, &is_hit, 1); }), HasSubstr("time"));
  }
}

TEST(PublicRayQuery, TakesMomentsOfItsCopiesAndOfNoOtherQuery) {
  const Model model = load_boxes();
  const RayQuery query(model), copy = query, other(model);
  const QueryMoment moment = query.prepare(model.at_key(1));
  const Vec3f center = model.bounds().center();
  const QueryRay ray{center - Vec3f{0, 0, 100}, {0, 0, 1}};
  EXPECT_EQ(copy.any_hit(ray, moment), query.any_hit(ray, model.at_key(1)));
  EXPECT_THAT(wrong_use([&] { other.closest_hit(ray, moment); }), HasSubstr("another"));
  EXPECT_THAT(wrong_use([&] { other.any_hit(ray, moment); }), HasSubstr("another"));
}

TEST(PublicRayQuery, MomentsAndQueriesKeepWhatTheyNeed) {
  std::optional<Model> model = load_boxes();
  std::optional<RayQuery> query(*model);
  const std::optional<QueryMoment> moment = query->prepare(model->at_key(2));
  const RayQuery copy = *query;
  model.reset();
  query.reset();
  int hits = 0;
  for (int i = -20; i <= 20; ++i) {
    QueryRay ray{{static_cast<float>(i) * 0.1f, 0, -100}, {0, 0, 1}};
    hits += copy.any_hit(ray, *moment);
    EXPECT_EQ(copy.any_hit(ray, *moment), copy.any_hit(ray, KeyInterval{2, 2, 0}));
  }
  EXPECT_GT(hits, 0);
}

TEST(PublicRayQuery, HitsAreBruteForcesToTheBit) {
  const Model model = load_boxes();
  const RayQuery query(model);
  std::mt19937 random(7);
  const auto unit = [&] { return std::uniform_real_distribution<float>(-1, 1)(random); };
  const Vec3f center = model.bounds().center(), extent = model.bounds().extent();
  const auto inside = [&] {
    return center + Vec3f{extent.x * unit(), extent.y * unit(), extent.z * unit()} * 0.5f;
  };
  std::vector<QueryRay> rays;
  std::vector<KeyInterval> times;
  for (int i = 0; i < 6000; ++i) {
    const std::uint32_t clip = i % 2;
    times.push_back(model.locate_time(clip, (unit() + 1) / 2 * model.clip(clip).seconds));
    const Vec3f origin = inside();
    rays.push_back({origin, inside() - origin});
  }
  std::vector<QueryHit> hits(rays.size());
  std::vector<std::uint8_t> is_hit(rays.size());
  query.closest_hits(rays.data(), times.data(), hits.data(), rays.size());
  query.any_hits(rays.data(), times.data(), is_hit.data(), rays.size());
  int hit_count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const QueryHit expected = brute_force_closest_hit(ModelHandle::view(model), rays[i], times[i]);
    hit_count += expected.is_hit();
    EXPECT_EQ(hits[i].triangle, expected.triangle) << i;
    EXPECT_EQ(std::bit_cast<std::uint32_t>(hits[i].t), std::bit_cast<std::uint32_t>(expected.t));
    EXPECT_EQ(hits[i].bary1, expected.bary1) << i;
    EXPECT_EQ(hits[i].bary2, expected.bary2) << i;
    EXPECT_EQ(is_hit[i] != 0, expected.is_hit()) << i;
  }
  EXPECT_GT(hit_count, 200);
}

}  // namespace
}  // namespace mdk
