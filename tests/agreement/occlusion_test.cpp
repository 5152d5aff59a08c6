// Beams: every technique finds the rays that brute force finds, bit for bit, on every instruction
// set; brute force finds what a plain test in double finds; closed meshes leak nothing.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "common/base/isa.h"
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/technique.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

using test::bake;
using test::ResetIsa;

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  float unit() { return std::uniform_real_distribution<float>(-1, 1)(engine_); }
  std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  Vec3f point() { return {unit(), unit(), unit()}; }
  KeyInterval moment(const ModelView& model) {
    if (below(3) == 0) return at_key(below(model.key_count()));
    const double part = (static_cast<double>(unit()) + 1) / 2;
    return locate_time(model, 0, part * model.clip_seconds(model.clips[0]));
  }

 private:
  std::mt19937 engine_;
};

/// Any direction, now and then along an axis.
Vec3f some_direction(Random& random) {
  if (random.below(6) == 0) return {0, 0, random.unit() < 0 ? -1.0f : 1.0f};
  return normalized(random.point());
}

/// Rays from a patch of the mesh, from all over its bounds, or in line with its vertices.
RayBeam make_beam(const PosedMesh& mesh, Random& random) {
  const ModelView& model = mesh.model();
  const Vec3f center = model.bounds.center();
  const Vec3f half = model.bounds.extent() * 0.5f;
  const float reach = std::max(2 * (half.x + half.y + half.z), 1e-30f);
  RayBeam beam;
  beam.clear(make_beam_basis(some_direction(random), center, std::ldexp(1.0f, -std::ilogb(reach))));
  const Vec3f start = mesh.positions()[random.below(model.vertex_count)] - center;
  const std::uint32_t kind = random.below(3), count = 1 + random.below(kTilePixels);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3f p = random.point();
    const Vec3f along = beam.basis.axis[2] * (random.unit() * reach / beam.basis.axis[2].z);
    const Vec3f vertex = mesh.positions()[random.below(model.vertex_count)] - center;
    if (kind == 0) beam.push(start + p * (0.05f * reach));
    if (kind == 1) beam.push({p.x * half.x, p.y * half.y, p.z * half.z});
    if (kind == 2) beam.push(std::isfinite(length(along)) ? vertex - along * 0.3f : vertex);
  }
  return beam;
}

std::uint32_t count_occluded(const RayBeam& beam) {
  std::uint32_t count = 0;
  for (const std::uint16_t bits : beam.occluded)
    count += static_cast<std::uint32_t>(std::popcount(bits));
  return count;
}

std::uint32_t count_different(const RayBeam& a, const RayBeam& b) {
  std::uint32_t different = 0;
  for (std::uint32_t ray = 0; ray < a.count; ++ray)
    different += a.is_occluded(ray) != b.is_occluded(ray);
  return different;
}

TEST(Occlusion, EveryTechniqueOfOursFindsBruteForcesRaysOnEveryScene) {
  const ResetIsa reset;
  for (auto& [name, sequence] : test::agreement_scenes()) {
    const DecomposeResult baked = bake(std::move(sequence));
    const ModelView model = baked.model.view();
    std::vector<std::unique_ptr<Technique>> techniques;
    std::vector<std::string_view> ids;
    for (const TechniqueInfo& row : technique_table()) {
      if (row.kind == TechniqueKind::kPeer) continue;
      techniques.push_back(row.make(model));
      ids.push_back(row.id);
    }
    ASSERT_EQ(ids.back(), "brute-force");
    Random random(5);
    std::uint32_t occluded = 0, rays = 0;
    TileScratch scratch;
    for (int moment = 0; moment < 4; ++moment) {
      PosedMesh mesh(model);
      mesh.set_time(random.moment(model));
      for (auto& technique : techniques) {
        technique->prebuild(mesh);
        technique->update(mesh);
        technique->prepare_occlusion();
      }
      for (int i = 0; i < 25; ++i) {
        const RayBeam beam = make_beam(mesh, random);
        RayBeam expected = beam;
        reset_isa();
        techniques.back()->occlude(expected, scratch);
        rays += beam.count;
        occluded += count_occluded(expected);
        for (const std::string_view isa : available_isas()) {
          limit_isa(isa);
          for (std::size_t t = 0; t < techniques.size(); ++t) {
            RayBeam found = beam;
            techniques[t]->occlude(found, scratch);
            EXPECT_EQ(count_different(found, expected), 0u)
                << name << ", " << ids[t] << ", " << isa << ", beam " << i << " of " << beam.count;
          }
        }
      }
    }
    EXPECT_GT(occluded, rays / 50) << name;
  }
}

/// Whether the ray from `o` (relative to the basis's origin) hits the triangle, in double, and
/// whether that is certain.
struct PlainAnswer {
  bool hit = false, certain = true;
};
PlainAnswer plain_test(const Vec3d (&corner)[3], const Vec3d& o, const Vec3d& d) {
  const Vec3d a = corner[0] - o, b = corner[1] - o, c = corner[2] - o;
  const double ea = dot(cross(b, c), d), eb = dot(cross(c, a), d), ec = dot(cross(a, b), d);
  const double sum = ea + eb + ec, size = length(b - a) * length(c - a);
  const double w =
      std::min({ea, eb, ec}) * (sum < 0 ? 0 : 1) + std::min({-ea, -eb, -ec}) * (sum < 0 ? 1 : 0);
  const double t = sum == 0 ? 0 : dot((a * ea + b * eb + c * ec) * (1 / sum), d);
  const bool near_edge = std::abs(w) < 1e-4 * size || std::abs(sum) < 1e-4 * size;
  return {w >= 0 && t > 0, !near_edge && std::abs(t) > 1e-4};
}

TEST(Occlusion, BruteForceAgreesWithAPlainTestInDouble) {
  const DecomposeResult baked = bake(test::bending_tube(12, 10, 3));
  const ModelView model = baked.model.view();
  PosedMesh mesh(model);
  mesh.set_time(at_key(1));
  TraceScene scene;
  scene.triangles = model.triangles.data();
  scene.triangle_count = model.triangle_count();
  scene.positions = mesh.positions().data();
  TileScratch scratch;
  Random random(17);
  int checked = 0;
  for (int i = 0; i < 60; ++i) {
    RayBeam beam = make_beam(mesh, random);
    occlude_beam(scene, beam, scratch);
    Vec3d axis[3];
    for (int k = 0; k < 3; ++k) axis[k] = normalized(to_double(beam.basis.axis[k]));
    const double unit = 1 / length(to_double(beam.basis.axis[2]));
    for (std::uint32_t ray = 0; ray < beam.count; ++ray) {
      const Vec3d o = (axis[0] * double{beam.u[ray]} + axis[1] * double{beam.v[ray]} +
                       axis[2] * double{beam.w[ray]}) *
                      unit;
      bool hit = false, certain = true;
      for (const Triangle& t : model.triangles) {
        Vec3d corner[3];
        for (int k = 0; k < 3; ++k)
          corner[k] = to_double(mesh.positions()[t.v[k]]) - to_double(beam.basis.origin);
        const PlainAnswer answer = plain_test(corner, o, axis[2]);
        hit = hit || (answer.hit && answer.certain);
        certain = certain && answer.certain;
      }
      if (!certain && !hit) continue;
      ++checked;
      EXPECT_EQ(beam.is_occluded(ray), hit) << "beam " << i << ", ray " << ray;
    }
  }
  EXPECT_GT(checked, 1000);
}

TEST(Occlusion, NoRayLeavesAClosedMeshInMotion) {
  // From the middle of a ring of a bent, swelling tube, straight at vertices and anywhere.
  constexpr std::uint32_t kRings = 40, kAround = 24;
  const PoseSequence tube = test::bending_tube(kRings, kAround, 12);
  const DecomposeResult baked = bake(test::bending_tube(kRings, kAround, 12));
  const ModelView model = baked.model.view();
  const auto technique = find_technique("fuzzy-bvh").make(model);
  Random random(23);
  TileScratch scratch;
  std::uint64_t rays = 0, leaks = 0;
  for (int i = 0; i < 600; ++i) {
    const std::uint32_t key = random.below(model.key_count());
    PosedMesh mesh(model);
    mesh.set_time(at_key(key));
    technique->prebuild(mesh);
    technique->update(mesh);
    technique->prepare_occlusion();
    const Vec3f center = model.bounds.center();
    Vec3f middle[2];  // of two neighbouring rings: the line between them is inside
    const std::uint32_t ring = 2 + random.below(kRings - 4);
    for (std::uint32_t r = 0; r < 2; ++r)
      for (std::uint32_t j = 0; j < kAround; ++j)
        middle[r] += tube.pose(key)[(ring + r) * kAround + j] * (1.0f / kAround);
    const Vec3f vertex = tube.pose(key)[(ring + random.below(2)) * kAround + random.below(kAround)];
    const Vec3f aim = i % 2 == 0 ? vertex - middle[0] : random.point();
    RayBeam beam;
    beam.clear(make_beam_basis(normalized(aim), center, 1));
    for (std::uint32_t ray = 0; ray < kTilePixels; ++ray) {
      const float part = (random.unit() + 1) / 2;
      const Vec3f between = middle[0] * (1 - part) + middle[1] * part;
      const Vec3f toward = (vertex - middle[0]) * (part * 0.5f);
      beam.push((i % 4 == 0 ? middle[0] + toward : between) - center);
    }
    technique->occlude(beam, scratch);
    rays += beam.count;
    leaks += beam.count - count_occluded(beam);
  }
  EXPECT_GT(rays, 100'000u);
  EXPECT_EQ(leaks, 0u);
}

}  // namespace
}  // namespace mdk
