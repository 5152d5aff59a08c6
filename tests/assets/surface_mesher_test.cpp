// Meshing of distance fields, on solids whose surface is known.
#include "assets/surface_mesher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "assets/isotropic_remesher.h"
#include "tests/assets/mesh_topology.h"

namespace mdk {
namespace {

double ball(const Vec3d& p) { return length(p) - 1; }

/// A ring of radius 1, 0.3 thick.
double torus(const Vec3d& p) {
  const double around = std::sqrt(p.x * p.x + p.y * p.y) - 1;
  return std::sqrt(around * around + p.z * p.z) - 0.3;
}

constexpr Aabbd kBox{{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}};

RemeshOptions even(double edge_length) {
  RemeshOptions options;
  options.edge_length = [edge_length](const Vec3d&) { return edge_length; };
  return options;
}

TEST(SurfaceMesher, ClosesABallAndFillsIt) {
  const TriangleMesh mesh = mesh_surface(ball, kBox, 0.1);
  EXPECT_EQ(unmatched_edges(mesh.triangles), 0u);
  EXPECT_EQ(pinched_vertices(mesh.triangles, mesh.positions.size()), 0u);
  EXPECT_EQ(euler_characteristic(mesh.triangles, mesh.positions.size()), 2);
  EXPECT_NEAR(enclosed_volume(mesh.triangles, mesh.positions), 4.0 / 3 * std::numbers::pi, 0.03);
}

TEST(SurfaceMesher, KeepsTheHoleOfARing) {
  const TriangleMesh mesh = mesh_surface(torus, kBox, 0.1);
  EXPECT_EQ(unmatched_edges(mesh.triangles), 0u);
  EXPECT_EQ(euler_characteristic(mesh.triangles, mesh.positions.size()), 0);
}

TEST(SurfaceMesher, ClosesASheetThinnerThanItsGrid) {
  const auto sheet = [](const Vec3d& p) { return std::max(length(p) - 1, std::abs(p.z) - 0.02); };
  const TriangleMesh mesh = mesh_surface(sheet, kBox, 0.1);
  EXPECT_GT(mesh.triangles.size(), 0u);
  EXPECT_EQ(unmatched_edges(mesh.triangles), 0u);
}

TEST(IsotropicRemesher, KeepsTheSurfaceAndItsTopology) {
  const TriangleMesh mesh = remesh(mesh_surface(torus, kBox, 0.1), torus, even(0.12));
  EXPECT_EQ(unmatched_edges(mesh.triangles), 0u);
  EXPECT_EQ(pinched_vertices(mesh.triangles, mesh.positions.size()), 0u);
  EXPECT_EQ(euler_characteristic(mesh.triangles, mesh.positions.size()), 0);
  for (const Vec3d& p : mesh.positions) EXPECT_NEAR(torus(p), 0, 1e-6);
}

TEST(IsotropicRemesher, NeverPinchesARingThinnerThanItsEdges) {
  const auto wire = [](const Vec3d& p) { return torus(p) + 0.2; };
  const TriangleMesh mesh = remesh(mesh_surface(wire, kBox, 0.08), wire, even(0.4));
  EXPECT_EQ(unmatched_edges(mesh.triangles), 0u);
  EXPECT_EQ(pinched_vertices(mesh.triangles, mesh.positions.size()), 0u);
  EXPECT_EQ(euler_characteristic(mesh.triangles, mesh.positions.size()), 0);
}

TEST(IsotropicRemesher, MakesEvenTriangles) {
  const double wanted = 0.12;
  const TriangleMesh mesh = remesh(mesh_surface(ball, kBox, 0.1), ball, even(wanted));
  double smallest_angle = 180;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d e = mesh.positions[t[(i + 1) % 3]] - mesh.positions[t[i]];
      const Vec3d f = mesh.positions[t[(i + 2) % 3]] - mesh.positions[t[i]];
      EXPECT_GT(length(e), 0.5 * wanted);
      EXPECT_LT(length(e), 1.6 * wanted);
      const double cosine = dot(e, f) / (length(e) * length(f));
      smallest_angle = std::min(smallest_angle, std::acos(cosine) * 180 / std::numbers::pi);
    }
  EXPECT_GT(smallest_angle, 25);
}

TEST(IsotropicRemesher, LetsEdgesFollowASeam) {
  RemeshOptions options = even(0.15);
  options.seam = [](const Vec3d& p) { return p.y - 0.2; };
  const TriangleMesh mesh = remesh(mesh_surface(ball, kBox, 0.1), ball, options);
  int crossing = 0, along = 0;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const double a = options.seam(mesh.positions[t[i]]);
      const double b = options.seam(mesh.positions[t[(i + 1) % 3]]);
      const bool a_on = std::abs(a) < 1e-2, b_on = std::abs(b) < 1e-2;
      along += a_on && b_on;
      crossing += !a_on && !b_on && a * b < 0;
    }
  const double seam_length = 2 * std::numbers::pi * std::sqrt(1 - 0.2 * 0.2);
  EXPECT_GT(along / 2 * 0.15, 0.8 * seam_length);
  EXPECT_LE(crossing, along / 20);
}

TEST(IsotropicRemesher, MakesTheSameMeshTwice) {
  const TriangleMesh a = remesh(mesh_surface(torus, kBox, 0.1), torus, even(0.12));
  const TriangleMesh b = remesh(mesh_surface(torus, kBox, 0.1), torus, even(0.12));
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
}

}  // namespace
}  // namespace mdk
