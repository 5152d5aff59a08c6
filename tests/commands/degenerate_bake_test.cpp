// Input that no artist means, and that files hold all the same: it must give a file that is as good
// as any other.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "preprocess/commands/checks.h"
#include "preprocess/pipeline.h"
#include "tests/formats/temp_folder.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

Vec3d turned(const Vec3d& p, std::uint32_t key) {
  return rigid_motion({1, 2, 3}, 0.4 * key, {0.1 * key, 0, 0}).point(p);
}

PoseSequence turning(const Mesh& mesh, std::uint32_t keys) {
  return make_sequence(mesh, keys, [&](std::uint32_t key, std::uint32_t vertex) {
    return turned(mesh.vertices[vertex], key);
  });
}

PoseSequence flat_sheet() {
  Mesh mesh = curved_sheet(8);
  for (Vec3d& v : mesh.vertices) v.z = 0;
  return make_sequence(mesh, 10, [&](std::uint32_t key, std::uint32_t vertex) {
    const Vec3d& v = mesh.vertices[vertex];
    return Vec3d{v.x, v.y * std::cos(0.3 * key), 0};
  });
}

/// Triangles along a line, without any width.
PoseSequence wire() {
  Mesh mesh;
  for (std::uint32_t i = 0; i < 40; ++i) mesh.vertices.push_back({0.1 * i, 0, 0});
  for (std::uint32_t i = 0; i + 2 < 40; ++i) mesh.triangles.push_back({{i, i + 1, i + 2}});
  return make_sequence(mesh, 12, [&](std::uint32_t key, std::uint32_t vertex) {
    const double angle = 0.05 * key * mesh.vertices[vertex].x;
    return Vec3d{mesh.vertices[vertex].x * std::cos(angle),
                 mesh.vertices[vertex].x * std::sin(angle), 0};
  });
}

PoseSequence one_triangle() {
  return turning({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}}, 6);
}

/// Half of the triangles have no area: two corners in one place, or all three the same vertex.
PoseSequence zero_areas() {
  Mesh mesh = curved_sheet(5);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 2)
    mesh.triangles[t].v[1 + t / 2 % 2] = mesh.triangles[t].v[0];
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 6)
    mesh.triangles[t].v[1] = mesh.triangles[t].v[2] = mesh.triangles[t].v[0];
  return turning(mesh, 8);
}

PoseSequence duplicated_keys() {
  const Mesh mesh = curved_sheet(6);
  return make_sequence(mesh, 20, [&](std::uint32_t key, std::uint32_t vertex) {
    return turned(mesh.vertices[vertex], key / 5);
  });
}

PoseSequence still() {
  const Mesh mesh = curved_sheet(6);
  return make_sequence(mesh, 9,
                       [&](std::uint32_t, std::uint32_t vertex) { return mesh.vertices[vertex]; });
}

PoseSequence collapses_to_a_point() {
  const Mesh mesh = curved_sheet(6);
  return make_sequence(mesh, 9, [&](std::uint32_t key, std::uint32_t vertex) {
    return turned(mesh.vertices[vertex] * std::abs(1 - key / 4.0), key);
  });
}

PoseSequence is_always_a_point() {
  const Mesh mesh = curved_sheet(3);
  return make_sequence(mesh, 5, [&](std::uint32_t key, std::uint32_t) {
    return Vec3d{static_cast<double>(key), 1, 2};
  });
}

PoseSequence parts_fly_apart() {
  const Mesh mesh = joined(curved_sheet(5), curved_sheet(5));
  return make_sequence(mesh, 10, [&](std::uint32_t key, std::uint32_t vertex) {
    const double away = std::exp(1.2 * key) * (vertex < mesh.vertices.size() / 2 ? 1 : -1);
    return turned(mesh.vertices[vertex], key) + Vec3d{away, 0, away};
  });
}

PoseSequence loose_parts() {
  std::mt19937 random(7);
  Mesh mesh;
  std::vector<Vec3d> axes;
  for (std::uint32_t part = 0; part < 5000; ++part) {
    const Vec3d at = random_point(random, 10);
    for (const Vec3d& corner : {Vec3d{0, 0, 0}, Vec3d{0.1, 0, 0}, Vec3d{0, 0.1, 0}})
      mesh.vertices.push_back(at + corner);
    mesh.triangles.push_back({{3 * part, 3 * part + 1, 3 * part + 2}});
    axes.push_back(random_point(random, 1));
  }
  return make_sequence(mesh, 6, [&](std::uint32_t key, std::uint32_t vertex) {
    const Vec3d& at = mesh.vertices[vertex / 3 * 3];
    return at + rigid_motion(axes[vertex / 3], 0.5 * key, axes[vertex / 3] * (0.2 * key))
                    .point(mesh.vertices[vertex] - at);
  });
}

PoseSequence scaled(PoseSequence sequence, float scale, const Vec3f& shift) {
  for (Vec3f& v : sequence.positions) v = v * scale + shift;
  return sequence;
}

PoseSequence mirrored_at_every_key() {
  const Mesh mesh = curved_sheet(5);
  return make_sequence(mesh, 8, [&](std::uint32_t key, std::uint32_t vertex) {
    Vec3d v = mesh.vertices[vertex];
    if (key % 2 == 1) v.x = -v.x;
    return turned(v, key);
  });
}

struct Oddity {
  std::string name;
  std::function<PoseSequence()> make;
};

class DegenerateInput : public testing::TestWithParam<Oddity> {};

TEST_P(DegenerateInput, GivesAFileWhoseBoxesAndTreesHold) {
  SilentProgress progress;
  const PoseSequence sequence = GetParam().make();
  const std::size_t triangles = sequence.triangles.size(), keys = sequence.key_times.size();
  for (const bool paper : {false, true}) {
    DecomposeOptions options;
    if (paper) options.stop_percent = 1;
    options.refine = !paper;
    const DecomposeResult result = decompose(sequence, options, progress);
    EXPECT_TRUE(std::isfinite(result.stats.sah_cost));
    EXPECT_TRUE(std::isfinite(result.stats.residual_rms));
    EXPECT_TRUE(std::isfinite(result.stats.residual_max));
    EXPECT_GE(result.stats.refine_gain, 0);
    EXPECT_LE(result.stats.refine_gain, 1);

    const test::TempFolder folder;
    const std::string path = folder.file("odd.mdk");
    write_mdk(result.model.view(), path);
    const MdkFile file(path);
    EXPECT_EQ(file.model().triangle_count(), triangles);
    EXPECT_EQ(file.model().key_count(), keys);
    std::vector<CheckResult> checks =
        check_boxes(file.model(), random_moments(file.model(), 400, 11), progress);
    checks.push_back(check_trees(file.model(), progress));
    for (const CheckResult& c : checks) EXPECT_TRUE(c.passed()) << c.name << ": " << c.detail;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Decompose, DegenerateInput,
    testing::Values(Oddity{"FlatSheet", flat_sheet}, Oddity{"Wire", wire},
                    Oddity{"OneTriangle", one_triangle}, Oddity{"ZeroAreas", zero_areas},
                    Oddity{"DuplicatedKeys", duplicated_keys}, Oddity{"Still", still},
                    Oddity{"CollapsesToAPoint", collapses_to_a_point},
                    Oddity{"IsAlwaysAPoint", is_always_a_point},
                    Oddity{"PartsFlyApart", parts_fly_apart}, Oddity{"LooseParts", loose_parts},
                    Oddity{"FarFromTheOrigin",
                           [] {
                             return scaled(wild_motion(3, 12), 1, {1e6f, -2e6f, 5e5f});
                           }},
                    Oddity{"Huge", [] { return scaled(wild_motion(4, 12), 1e6f, {}); }},
                    Oddity{"Tiny", [] { return scaled(wild_motion(5, 12), 1e-6f, {}); }},
                    Oddity{"TwoKeys", [] { return turning(curved_sheet(6), 2); }},
                    Oddity{"OneKey", [] { return turning(curved_sheet(6), 1); }},
                    Oddity{"TwoThousandKeys", [] { return independent_parts(3, 2000); }},
                    Oddity{"MirroredAtEveryKey", mirrored_at_every_key}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace mdk
