// Model space: metres, the cow looks to +x, stands on y = 0, its left is towards -z.
#include "assets/cow_asset.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "assets/elastic_lattice.h"
#include "assets/wave.h"

namespace mdk {
namespace {

constexpr int kKeys = 204, kKickKey = 92;
constexpr double kKeySeconds = 1.0 / 30;

constexpr ByteColor kWhite{243, 238, 228}, kBlack{40, 36, 38}, kPink{232, 164, 152},
    kHoof{70, 58, 50}, kHorn{222, 200, 150}, kEye{16, 14, 14};

Vec3d mirrored(const Vec3d& p) { return {p.x, p.y, std::abs(p.z)}; }

struct Patch {
  Vec3d center;
  Vec3d radii;
};
constexpr std::array<Patch, 6> kPatches = {{{{-0.42, 1.42, -0.30}, {0.34, 0.34, 0.30}},
                                            {{0.36, 1.30, -0.42}, {0.25, 0.30, 0.30}},
                                            {{-0.10, 1.36, 0.42}, {0.40, 0.26, 0.30}},
                                            {{-0.86, 1.10, 0.24}, {0.22, 0.30, 0.30}},
                                            {{0.72, 1.40, 0.26}, {0.22, 0.34, 0.30}},
                                            {{1.14, 1.74, -0.16}, {0.17, 0.20, 0.17}}}};
constexpr Vec3d kMuzzle{1.56, 1.40, 0}, kHorns{1.06, 1.96, 0.20}, kEyes{1.25, 1.76, 0.175};
constexpr double kHoofTop = 0.13;

double muzzle(const Vec3d& p) { return ellipsoid(p - kMuzzle, {0.19, 0.22, 0.26}); }
double udder(const Vec3d& p) { return ellipsoid(p - Vec3d{-0.42, 0.72, 0}, {0.22, 0.17, 0.20}); }
double horn(const Vec3d& p) {
  const Vec3d q = mirrored(p);
  return smooth_min(rounded_cone_between(q, {1.06, 1.86, 0.13}, 0.055, {1.05, 1.96, 0.25}, 0.05),
                    rounded_cone_between(q, {1.05, 1.96, 0.25}, 0.05, {1.10, 2.10, 0.28}, 0.022),
                    0.05);
}

double body(const Vec3d& p) {
  const Vec3d slim{p.x, p.y, p.z * 1.08};
  double d = rounded_cone_between(slim, {-0.66, 1.17, 0}, 0.43, {0.52, 1.15, 0}, 0.40);
  d = smooth_min(d, ellipsoid(p - Vec3d{-0.10, 1.02, 0}, {0.62, 0.42, 0.42}), 0.3);
  d = smooth_min(d, rounded_cone_between(p, {0.55, 1.25, 0}, 0.31, {1.02, 1.62, 0}, 0.20), 0.28);
  const double skull = rounded_cone_between(p, {1.10, 1.72, 0}, 0.205, {1.50, 1.44, 0}, 0.15);
  d = smooth_min(d, skull, 0.10);
  return smooth_min(d, ellipsoid(p - Vec3d{1.55, 1.40, 0}, {0.13, 0.14, 0.17}), 0.08);
}

double legs(const Vec3d& p) {
  const Vec3d q = mirrored(p);
  double front = rounded_cone_between(q, {0.50, 1.00, 0.22}, 0.20, {0.53, 0.52, 0.24}, 0.115);
  front = smooth_min(
      front, rounded_cone_between(q, {0.53, 0.52, 0.24}, 0.11, {0.53, 0.12, 0.24}, 0.10), 0.08);
  double hind = rounded_cone_between(q, {-0.70, 1.02, 0.22}, 0.24, {-0.66, 0.56, 0.24}, 0.125);
  hind = smooth_min(
      hind, rounded_cone_between(q, {-0.66, 0.56, 0.24}, 0.115, {-0.74, 0.12, 0.24}, 0.10), 0.08);
  const double cut = 0.02 - p.y;  // flat soles
  return smooth_max(std::min(front, hind), cut, 0.05);
}

double tail(const Vec3d& p) {
  const double cord =
      smooth_min(rounded_cone_between(p, {-1.02, 1.40, 0}, 0.06, {-1.22, 1.20, 0}, 0.045),
                 rounded_cone_between(p, {-1.22, 1.20, 0}, 0.045, {-1.26, 0.78, 0}, 0.04), 0.06);
  return smooth_min(cord, ellipsoid(p - Vec3d{-1.26, 0.68, 0}, {0.075, 0.15, 0.075}), 0.05);
}

double cow(const Vec3d& p) {
  const Vec3d q = mirrored(p);
  double d = smooth_min(body(p), legs(p), 0.16);
  d = smooth_min(d, udder(p), 0.08);
  d = smooth_min(d, tail(p), 0.08);
  const Basis ear = basis_along({1.03, 1.78, 0.27}, {0, 0.15, 1}, {1, 0, 0});
  d = smooth_min(d, ellipsoid(ear.to_local(q), {0.085, 0.17, 0.05}), 0.05);
  d = smooth_min(d, ellipsoid(q - kEyes, {0.055, 0.06, 0.05}), 0.02);
  return smooth_min(d, horn(p), 0.03);
}

/// Signed distance to the border of the nearest patch, negative within.
double patches(const Vec3d& p) {
  double nearest = 1;
  for (const Patch& patch : kPatches)
    nearest = smooth_min(nearest, ellipsoid(p - patch.center, patch.radii), 0.08);
  return nearest;
}

double seam(const Vec3d& p) {
  double nearest = patches(p);
  for (const double d : {muzzle(p), udder(p) - 0.015, p.y - kHoofTop, horn(p) - 0.02})
    if (std::abs(d) < std::abs(nearest)) nearest = d;
  return nearest;
}

ByteColor color(const Vec3d& p) {
  if (ellipsoid(mirrored(p) - kEyes, {0.06, 0.065, 0.055}) < 0) return kEye;
  if (horn(p) < 0.02) return kHorn;
  if (muzzle(p) < 0 || udder(p) < 0.015) return kPink;
  if (p.y < kHoofTop) return kHoof;
  if (p.x < -1.1 && p.y < 0.84) return kBlack;  // the tail's tuft
  return patches(p) < 0 ? kBlack : kWhite;
}

double edge_length(const Vec3d& p) {
  const double head = smooth_step(0.75, 1.05, p.x), low = smooth_step(0.7, 0.5, p.y);
  return 0.0755 - 0.0325 * std::max(head, 0.75 * low);
}

/// Turns the body about its middle and lifts it.
void throw_up(ElasticLattice& lattice) {
  const Vec3d middle{0, 1.1, 0};
  constexpr double kPitch = 0.05, kRoll = 0.03, kHeight = 2.3;
  const double cp = cosine(kPitch), sp = sine(kPitch), cr = cosine(kRoll), sr = sine(kRoll);
  for (std::size_t i = 0; i < lattice.positions().size(); ++i) {
    const Vec3d p = lattice.rest()[i] - middle;
    const Vec3d rolled{p.x, cr * p.y - sr * p.z, sr * p.y + cr * p.z};
    const Vec3d turned{cp * rolled.x - sp * rolled.y, sp * rolled.x + cp * rolled.y, rolled.z};
    lattice.positions()[i] = turned + middle + Vec3d{0, kHeight, 0};
    const Vec3d spin{-0.35, 0.5, -0.3};  // radians a second
    lattice.velocities()[i] = cross(spin, turned) + Vec3d{0.5, 0, 0.1};
  }
}

/// The floor keeps what touches it from sliding.
void on_floor(Vec3d& position, Vec3d& velocity) {
  constexpr double kGrip = 0.06, kBounce = 1;
  if (position.y >= 0) return;
  position.y = 0;
  velocity = {velocity.x * (1 - kGrip), std::abs(velocity.y) * kBounce, velocity.z * (1 - kGrip)};
}

/// The floor kicks, harder on one side: up it goes again, turning.
void kick(ElasticLattice& lattice) {
  Vec3d middle;
  for (const Vec3d& p : lattice.positions()) middle += p;
  middle = middle * (1.0 / static_cast<double>(lattice.positions().size()));
  const Vec3d spin{2.6, -0.5, 1.2};  // radians a second
  for (std::size_t i = 0; i < lattice.positions().size(); ++i)
    lattice.velocities()[i] +=
        Vec3d{-0.5, 6.4, -0.2} + cross(spin, lattice.positions()[i] - middle);
}

}  // namespace

SampleSequence make_cow() {
  const Aabbd box{{-1.45, -0.08, -0.66}, {1.85, 2.24, 0.66}};
  const TriangleMesh mesh = mesh_solid({cow, seam, box, 0.035, edge_length});
  SampleSequence sequence;
  sequence.triangles = mesh.triangles;
  for (const Vec3d& p : mesh.positions) sequence.colors.push_back(color(p));

  constexpr int kSteps = 32;
  constexpr double kCell = 0.11, kStiffness = 4500, kDamping = 0.35;
  ElasticLattice lattice(cow, box, kCell);
  const ElasticLattice::Embedding embedding(lattice, mesh.positions);
  throw_up(lattice);
  for (int key = 0; key < kKeys; ++key) {
    sequence.poses.push_back(embedding.positions(lattice));
    if (key == kKickKey) kick(lattice);
    for (int i = 0; i < kSteps; ++i)
      lattice.step({kKeySeconds / kSteps, kStiffness, kDamping, {0, -7.0, 0}, on_floor});
  }
  return sequence;
}

}  // namespace mdk
