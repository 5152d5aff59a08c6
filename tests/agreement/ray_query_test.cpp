// Single rays at times of their own against brute force, bit for bit, and against an independent
// scalar test; closed meshes in motion leak nothing.
#include "mdk/ray_query.h"

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>
#include <thread>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "common/trace/brute_force.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

using test::bake;
using test::ResetIsa;

/// All vertices at a moment.
std::vector<Vec3f> vertices_at(const ModelView& model, const KeyInterval& at) {
  PosedMesh mesh(model);
  mesh.set_time(at);
  return {mesh.positions().begin(), mesh.positions().end()};
}

bool is_same(const QueryHit& a, const QueryHit& b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return a.triangle == b.triangle && bits(a.t) == bits(b.t) && bits(a.bary1) == bits(b.bary1) &&
         bits(a.bary2) == bits(b.bary2);
}

/// Rays of all kinds: from outside and inside, at vertices and edges, along axes, of odd lengths.
class RayMaker {
 public:
  RayMaker(const ModelView& model, std::uint32_t seed) : model_(model), random_(seed) {}

  KeyInterval time() {
    const double seconds = model_.clip_seconds(model_.clips[0]);
    if (random_() % 4 == 0) return at_key(random_() % model_.key_count());
    return locate_time(model_, 0, (unit() + 1) / 2 * seconds);
  }
  QueryRay ray(const KeyInterval& at) {
    const float size = std::max(diagonal(model_.bounds), 1e-12f);
    const Vec3f center = model_.bounds.center();
    const float reach = random_() % 3 == 0 ? 0.2f : 1.5f;
    QueryRay ray;
    ray.origin = center + Vec3f{unit(), unit(), unit()} * (size * reach);
    ray.direction = target(at) - ray.origin;
    if (random_() % 8 == 0) ray.direction = Vec3f{0, 0, unit() < 0 ? -1.0f : 1.0f};
    ray.direction = ray.direction * std::ldexp(1.0f, static_cast<int>(random_() % 40) - 20);
    return ray;
  }

 private:
  float unit() { return std::uniform_real_distribution<float>(-1, 1)(random_); }

  /// A vertex, a point on an edge, or anywhere.
  Vec3f target(const KeyInterval& at) {
    const Triangle& t = model_.triangles[random_() % model_.triangle_count()];
    const std::vector<Vec3f> vertices = vertices_at(model_, at);
    const auto vertex = [&](int k) { return vertices[t.v[k]]; };
    const Vec3f a = vertex(0), b = vertex(1), c = vertex(2);
    switch (random_() % 3) {
      case 0:
        return a;
      case 1:
        return a + (b - a) * 0.5f;
      default:
        return (a + b + c) * (1.0f / 3);
    }
  }

  const ModelView& model_;
  std::mt19937 random_;
};

TEST(RayQuery, GivesBruteForcesHitAtEveryRaysOwnTime) {
  const ResetIsa reset;
  for (auto& [name, sequence] : test::agreement_scenes()) {
    const DecomposeResult baked = bake(std::move(sequence));
    const ModelView model = baked.model.view();
    const RayQuery query(ModelHandle::make(model));
    RayMaker make(model, 11);
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      const KeyInterval at = make.time();
      const QueryRay ray = make.ray(at);
      reset_isa();
      const QueryHit expected = brute_force_closest_hit(model, ray, at);
      hits += expected.triangle != kNoTriangle;
      for (const std::string_view isa : available_isas()) {
        limit_isa(isa);
        EXPECT_TRUE(is_same(query.closest_hit(ray, at), expected))
            << name << ", ray " << i << ", " << isa << ": " << expected.triangle;
        EXPECT_EQ(query.any_hit(ray, at), expected.triangle != kNoTriangle) << name << " " << i;
      }
    }
    EXPECT_GT(hits, 30) << name;
  }
}

/// The formula of the kernel's head comment, written plainly: one triangle at a time.
QueryHit plain_closest_hit(const ModelView& model, const QueryRay& ray, const KeyInterval& at) {
  const Vec3d o = to_double(ray.origin), d = to_double(ray.direction);
  const std::vector<Vec3f> vertices = vertices_at(model, at);
  QueryHit best;
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    Vec3d v[3];
    for (int k = 0; k < 3; ++k) {
      v[k] = to_double(vertices[model.triangles[t].v[k]]) - o;
    }
    double w[3], error[3];
    const auto size = [](const Vec3d& x) { return std::abs(x.x) + std::abs(x.y) + std::abs(x.z); };
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    for (int k = 0; k < 3; ++k) {
      const Vec3d &a = v[(k + 1) % 3], &b = v[(k + 2) % 3];
      w[k] = dot(cross(b - a, b + a), d);
      error[k] = size(b - a) * size(b + a) * (0x1p-48 * largest);
    }
    const double side = std::copysign(1.0, w[0] + w[1] + w[2]);
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      inside = inside && w[k] * side >= -error[k];
      w[k] = std::max(w[k] * side, 0.0);
    }
    const double total = w[0] + w[1] + w[2];
    if (!inside || total == 0) continue;
    const Vec3d p = (v[0] * w[0] + v[1] * w[1] + v[2] * w[2]) * (1 / total);
    const double depth = dot(p, d) / dot(d, d);
    const auto at_t = static_cast<float>(depth);
    if (at_t > ray.t_min && at_t < best.t && at_t <= ray.t_max) best = {at_t, t, 0, 0};
  }
  return best;
}

TEST(RayQuery, BruteForceAgreesWithAPlainLoopOverTriangles) {
  const DecomposeResult baked = bake(test::bending_tube(20, 16, 4));
  const ModelView model = baked.model.view();
  RayMaker make(model, 5);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const KeyInterval at = make.time();
    const QueryRay ray = make.ray(at);
    const QueryHit expected = plain_closest_hit(model, ray, at);
    const QueryHit got = brute_force_closest_hit(model, ray, at);
    hits += expected.triangle != kNoTriangle;
    EXPECT_EQ(got.triangle, expected.triangle) << i;
    EXPECT_EQ(got.t, expected.t) << i;
  }
  EXPECT_GT(hits, 200);
}

TEST(RayQuery, RangesOfTAreOpenBelowAndClosedAbove) {
  const DecomposeResult baked = bake(test::bending_tube(20, 16, 4));
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  const KeyInterval at = at_key(1);
  const Vec3f on_mesh = vertices_at(model, at)[model.triangles[40].v[0]];
  QueryRay ray{.origin = on_mesh + Vec3f{0.3f, 1, 10}, .direction = Vec3f{0.3f, 1, 10} * -0.3f};
  const QueryHit first = query.closest_hit(ray, at);
  ASSERT_NE(first.triangle, kNoTriangle);
  ray.t_max = first.t;
  EXPECT_TRUE(is_same(query.closest_hit(ray, at), first));
  EXPECT_TRUE(query.any_hit(ray, at));
  ray.t_max = std::nextafter(first.t, 0.0f);
  EXPECT_FALSE(query.any_hit(ray, at));
  ray.t_max = std::numeric_limits<float>::infinity();
  ray.t_min = first.t;
  EXPECT_GT(query.closest_hit(ray, at).t, first.t);
}

TEST(RayQuery, RangesThatBeginBehindTheOriginGiveBruteForcesHit) {
  const ResetIsa reset;
  const DecomposeResult baked = bake(test::bending_tube(20, 16, 4));
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  RayMaker make(model, 29);
  const float inf = std::numeric_limits<float>::infinity();
  int behind = 0;
  for (int i = 0; i < 300; ++i) {
    const KeyInterval at = make.time();
    QueryRay ray = make.ray(at);
    if (i % 8 != 0) ray.direction = -ray.direction;  // what it is aimed at is behind
    const float unit = diagonal(model.bounds) / length(ray.direction);
    ray.t_min = i % 4 == 0 ? -inf : -static_cast<float>(i % 7) * 0.3f * unit;
    if (i % 3 == 0) ray.t_max = i % 2 == 0 ? 0 : ray.t_min * 0.25f;  // all of it behind
    const QueryHit expected = brute_force_closest_hit(model, ray, at);
    behind += expected.triangle != kNoTriangle && expected.t < 0;
    for (const std::string_view isa : available_isas()) {
      limit_isa(isa);
      EXPECT_TRUE(is_same(query.closest_hit(ray, at), expected)) << "ray " << i << ", " << isa;
      EXPECT_EQ(query.any_hit(ray, at), expected.triangle != kNoTriangle)
          << "ray " << i << ", " << isa;
    }
    reset_isa();
  }
  EXPECT_GT(behind, 50);
}

TEST(RayQuery, AListAtMixedTimesGivesWhatEachRayGivesOnAnyNumberOfThreads) {
  const DecomposeResult baked = bake(test::flying_boxes(12, 6));
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  RayMaker make(model, 3);
  std::vector<QueryRay> rays;
  std::vector<KeyInterval> times;
  std::vector<QueryHit> expected;
  for (int i = 0; i < 1000; ++i) {
    times.push_back(make.time());
    rays.push_back(make.ray(times.back()));
    expected.push_back(query.closest_hit(rays.back(), query.prepare(times.back())));
  }
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    std::vector<QueryHit> hits(rays.size());
    std::vector<std::uint8_t> shadows(rays.size());
    query.closest_hits(rays.data(), times.data(), hits.data(), rays.size());
    query.any_hits(rays.data(), times.data(), shadows.data(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_TRUE(is_same(hits[i], expected[i])) << i;
      EXPECT_EQ(shadows[i] != 0, expected[i].triangle != kNoTriangle) << i;
    }
  }
}

TEST(RayQuery, ATimeBetweenKeysIsRefusedWhereBoxesHoldAtKeysOnly) {
  DecomposeResult baked = bake(std::move(test::agreement_scenes().front().sequence));
  baked.model.holds_between_keys = false;
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  const QueryRay ray{.origin = {0, 0, -10}, .direction = {0, 0, 1}};
  EXPECT_NO_THROW(query.closest_hit(ray, at_key(1)));
  EXPECT_NO_THROW(query.prepare(at_key(1)));
  const KeyInterval between{0, 1, 0.5f};
  EXPECT_THROW(query.closest_hit(ray, between), Error);
  EXPECT_THROW(query.any_hit(ray, between), Error);
  EXPECT_THROW(query.prepare(between), Error);
}

TEST(RayQuery, AMomentGivesBruteForcesHitsBeforeAndAfterItIsPosed) {
  const ResetIsa reset;
  for (auto& [name, sequence] : test::agreement_scenes()) {
    const DecomposeResult baked = bake(std::move(sequence));
    const ModelView model = baked.model.view();
    const RayQuery query(ModelHandle::make(model));
    RayMaker make(model, 17);
    // The first moment makes the hierarchy, the second is refitted to another time.
    for (const KeyInterval& at : {make.time(), make.time()}) {
      const QueryMoment moment = query.prepare(at);
      const std::size_t before = query.bytes();
      std::vector<QueryRay> rays;
      std::vector<QueryHit> expected;
      for (int i = 0; i < 150; ++i) {
        rays.push_back(make.ray(at));
        expected.push_back(brute_force_closest_hit(model, rays.back(), at));
      }
      for (int round = 0; round < 2 || query.bytes() == before; ++round) {
        ASSERT_LT(round, 100'000) << name << " is never posed";
        for (std::size_t i = 0; i < rays.size(); ++i) {
          limit_isa(available_isas()[i % available_isas().size()]);
          ASSERT_TRUE(is_same(query.closest_hit(rays[i], moment), expected[i])) << name << i;
        }
      }
      for (const std::string_view isa : available_isas()) {
        limit_isa(isa);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          ASSERT_TRUE(is_same(query.closest_hit(rays[i], moment), expected[i])) << name << i;
          ASSERT_EQ(query.any_hit(rays[i], moment), expected[i].is_hit()) << name << i << isa;
        }
      }
      reset_isa();
    }
  }
}

TEST(RayQuery, PosesStayWithinTheirLimitAndHitsAreTheSame) {
  // Quantised, so that poses are decoded; room for three keys of many.
  DecomposeOptions options;
  options.quantize = 1e-4;
  SilentProgress silent;
  const DecomposeResult baked = decompose(test::bending_tube(20, 16, 24), options, silent);
  const ModelView model = baked.model.view();
  ASSERT_NE(model.poses.kind, PoseKind::kKeyPositions);
  const std::size_t key_bytes = (model.vertex_count + 1) * sizeof(Vec3f);
  const RayQuery all(ModelHandle::make(model)),
      few(ModelHandle::make(model), RayQueryOptions{.max_pose_bytes = 3 * key_bytes});
  const std::size_t all_before = all.bytes(), few_before = few.bytes();
  RayMaker make(model, 31);
  std::vector<QueryRay> rays;
  std::vector<KeyInterval> times;
  for (int i = 0; i < 3000; ++i) {
    times.push_back(make.time());
    rays.push_back(make.ray(times.back()));
  }
  std::vector<QueryHit> expected(rays.size()), hits(rays.size());
  all.closest_hits(rays.data(), times.data(), expected.data(), rays.size());
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    few.closest_hits(rays.data(), times.data(), hits.data(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_TRUE(is_same(hits[i], expected[i])) << i;
  }
  // Threads that are not ours, more than there are places for.
  std::vector<std::thread> others;
  std::atomic<int> different = 0;
  for (int t = 0; t < 6; ++t)
    others.emplace_back([&, t] {
      for (std::size_t i = static_cast<std::size_t>(t); i < rays.size(); i += 6)
        different += is_same(few.closest_hit(rays[i], times[i]), expected[i]) ? 0 : 1;
    });
  for (std::thread& thread : others) thread.join();
  EXPECT_EQ(different, 0);
  EXPECT_EQ(all.bytes() - all_before, model.key_count() * key_bytes);
  EXPECT_LE(few.bytes() - few_before,
            std::max(3u, 2 * static_cast<unsigned>(thread_count())) * key_bytes);
}

TEST(RayQuery, RaysWithoutDirectionOrSenseHitNothing) {
  const DecomposeResult baked = bake(test::bending_tube(10, 8, 2));
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  const float nan = std::nanf(""), inf = std::numeric_limits<float>::infinity();
  const Vec3f inside = model.bounds.center();
  for (const QueryRay& ray : {QueryRay{inside, {0, 0, 0}}, QueryRay{inside, {nan, 1, 0}},
                              QueryRay{inside, {inf, 0, 0}}, QueryRay{{nan, 0, 0}, {1, 0, 0}},
                              QueryRay{inside, {1, 0, 0}, 1, 1}, QueryRay{inside, {1, 0, 0}, nan}})
    EXPECT_FALSE(query.any_hit(ray, at_key(0)));
}

TEST(RayQuery, DirectionsOfAnyLengthGiveAFiniteDepthOrNone) {
  const ResetIsa reset;
  const DecomposeResult baked = bake(test::bending_tube(10, 8, 2));
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  const std::vector<Vec3f> vertices = vertices_at(model, at_key(0));
  const Triangle& aimed_at = model.triangles[40];
  const Vec3f on_it =
      (vertices[aimed_at.v[0]] + vertices[aimed_at.v[1]] + vertices[aimed_at.v[2]]) * (1.0f / 3);
  const Vec3f outside = on_it - Vec3f{0, 0, 10};
  int near = 0, far = 0;
  for (int exponent = -149; exponent <= 127; ++exponent) {
    const QueryRay ray{outside, Vec3f{0, 0, std::ldexp(1.0f, exponent)}};
    const QueryHit expected = brute_force_closest_hit(model, ray, at_key(0));
    // A wall that is farther than the largest float, in lengths of the direction, is not hit.
    EXPECT_EQ(std::isfinite(expected.t), expected.is_hit()) << exponent;
    (expected.is_hit() ? near : far) += 1;
    for (const std::string_view isa : available_isas()) {
      limit_isa(isa);
      EXPECT_TRUE(is_same(query.closest_hit(ray, at_key(0)), expected)) << exponent << isa;
      EXPECT_EQ(query.any_hit(ray, at_key(0)), expected.is_hit()) << exponent << isa;
    }
    reset_isa();
  }
  EXPECT_GT(near, 200);
  EXPECT_GT(far, 10);
  const QueryRay reported{on_it + Vec3f{0, 0, 10}, {0, 0, -1e-40f}};
  EXPECT_FALSE(query.closest_hit(reported, at_key(0)).is_hit());
}

/// Whether a point is inside the closed mesh: by the crossings of rays in three odd directions,
/// counted with Möller and Trumbore's test in double.
bool is_inside(const ModelView& model, const Vec3f& point, const KeyInterval& at) {
  const Vec3d o = to_double(point);
  const std::vector<Vec3f> vertices = vertices_at(model, at);
  int votes = 0;
  for (const Vec3d& d :
       {Vec3d{0.31, 0.83, 0.46}, Vec3d{-0.72, 0.11, 0.68}, Vec3d{0.2, -0.5, -0.9}}) {
    int crossings = 0;
    for (const Triangle& t : model.triangles) {
      Vec3d v[3];
      for (int k = 0; k < 3; ++k) {
        v[k] = to_double(vertices[t.v[k]]);
      }
      const Vec3d e1 = v[1] - v[0], e2 = v[2] - v[0], p = cross(d, e2), s = o - v[0];
      const double det = dot(e1, p), u = dot(s, p) / det, w = dot(d, cross(s, e1)) / det;
      crossings += u >= 0 && w >= 0 && u + w <= 1 && dot(e2, cross(s, e1)) / det > 0;
    }
    votes += crossings % 2;
  }
  return votes >= 2;
}

TEST(RayQuery, NoRayLeavesAClosedMeshInMotion) {
  // From the axis of a bent, swelling tube every ray must hit its wall, at every time; most are
  // aimed at vertices and edges, where neighbours meet and clusters part.
  const DecomposeResult baked = bake(test::bending_tube(40, 24, 12));
  const ModelView model = baked.model.view();
  const RayQuery query(ModelHandle::make(model));
  constexpr std::size_t kRays = 100'000;
  constexpr float kInward = -1;  // the corners run counter-clockwise seen from outside
  std::mt19937 random(20);
  PosedMesh mesh(model);
  std::vector<QueryRay> rays(kRays);
  std::vector<KeyInterval> times(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    const KeyInterval at = times[i] = locate_time(
        model, 0,
        std::uniform_real_distribution<double>(0, model.clip_seconds(model.clips[0]))(random));
    mesh.set_time(at);
    const auto vertex = [&](std::uint32_t v) { return mesh.positions()[v]; };
    const Triangle& t = model.triangles[random() % model.triangle_count()];
    const Vec3f a = vertex(t.v[0]), b = vertex(t.v[1]), c = vertex(t.v[2]);
    const Vec3f normal = normalized(cross(b - a, c - a));
    const Vec3f on_it = i % 3 == 0 ? a : i % 3 == 1 ? (b + c) * 0.5f : (a + b + c) * (1.0f / 3);
    const Vec3f middle = (a + b + c) * (1.0f / 3);
    // A step inward from the triangle is inside the tube, which is thicker than that everywhere.
    rays[i].origin = middle + normal * (kInward * 0.02f);
    rays[i].direction = on_it - rays[i].origin;
    if (random() % 2 == 0) rays[i].direction = -rays[i].direction;
  }
  std::vector<std::uint8_t> hits(kRays);
  query.any_hits(rays.data(), times.data(), hits.data(), kRays);
  int outside = 0, leaks = 0;
  for (std::size_t i = 0; i < kRays; ++i) {
    if (hits[i] != 0) continue;
    // Where the tube is squeezed, a step inward may come out on its other side.
    (is_inside(model, rays[i].origin, times[i]) ? leaks : outside) += 1;
  }
  EXPECT_EQ(leaks, 0);
  EXPECT_LT(outside, 200);
}

}  // namespace
}  // namespace mdk
