// Model space: metres, the dolphin looks to +x, its back to +y. Springs above and below the spine
// shorten in turn, a wave that runs to the tail; water resists whatever moves against its skin, and
// that alone drives the animal on.
#include "assets/dolphin_asset.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "assets/elastic_lattice.h"
#include "assets/wave.h"

namespace mdk {
namespace {

constexpr int kKeys = 101;
constexpr double kKeySeconds = 1.0 / 30;

constexpr ByteColor kBack{72, 92, 120}, kSide{126, 150, 176}, kBelly{236, 238, 234},
    kEye{14, 14, 18};
constexpr Vec3d kEyePlace{0.80, 0.02, 0.165};

Vec3d mirrored(const Vec3d& p) { return {p.x, p.y, std::abs(p.z)}; }

double trunk(const Vec3d& p) {
  double d = rounded_cone_between(p, {0.30, 0, 0}, 0.245, {0.72, -0.01, 0}, 0.19);
  d = smooth_min(d, rounded_cone_between(p, {0.30, 0, 0}, 0.245, {-0.45, 0.01, 0}, 0.15), 0.12);
  d = smooth_min(d, rounded_cone_between(p, {-0.45, 0.01, 0}, 0.15, {-1.08, 0.03, 0}, 0.055), 0.1);
  const Vec3d flat{p.x, p.y * 1.15, p.z};
  const double snout =
      rounded_cone_between(flat, {0.84, -0.07, 0}, 0.085, {1.14, -0.095, 0}, 0.045);
  return smooth_min(d, snout, 0.05);
}

/// A blade from `root` to `tip`, `width` wide at the root, flat along `normal`.
double blade(const Vec3d& p, const Vec3d& root, const Vec3d& tip, const Vec3d& normal,
             double width) {
  const Basis basis = basis_along(root, tip - root, normal);
  const double thin = 0.36;
  const Vec3d q = basis.to_local(p);
  return thin * rounded_cone({q.x, q.y, q.z / thin}, width, 0.42 * width, length(tip - root));
}

double dolphin(const Vec3d& p) {
  const Vec3d q = mirrored(p);
  double d = trunk(p);
  d = smooth_min(d, blade(p, {0.02, 0.17, 0}, {-0.17, 0.42, 0}, {0, 0, 1}, 0.13), 0.06);
  d = smooth_min(d, blade(q, {0.42, -0.14, 0.17}, {0.16, -0.30, 0.46}, {0.2, 1, 0.3}, 0.10), 0.05);
  d = smooth_min(d, blade(q, {-1.08, 0.03, 0.02}, {-1.32, 0.03, 0.36}, {0, 1, 0}, 0.12), 0.05);
  return smooth_min(d, ellipsoid(q - kEyePlace, {0.035, 0.03, 0.03}), 0.015);
}

/// Height over the line between belly and side.
double over_belly(const Vec3d& p) {
  const double line = -0.075 - 0.05 * smooth_step(-0.2, -0.8, p.x) + 0.02 * sine(p.x * 0.9);
  return p.y - line - 0.06 * smooth_step(0.4, 0.9, p.x);
}
double over_side(const Vec3d& p) { return p.y - 0.085 + 0.06 * smooth_step(0.5, 0.9, p.x); }
bool on_flipper(const Vec3d& p) { return p.x < 0.5 && std::abs(p.z) > 0.235; }

double seam(const Vec3d& p) {
  const double belly = over_belly(p), side = over_side(p);
  return std::abs(belly) < std::abs(side) ? belly : side;
}

ByteColor color(const Vec3d& p) {
  if (ellipsoid(mirrored(p) - kEyePlace, {0.04, 0.034, 0.035}) < 0) return kEye;
  if (p.x < -0.98 || on_flipper(p) || over_side(p) > 0) return kBack;
  return over_belly(p) < 0 ? kBelly : kSide;
}

double edge_length(const Vec3d& p) {
  const double fin = std::max({smooth_step(0.2, 0.3, p.y), smooth_step(0.2, 0.28, std::abs(p.z)),
                               smooth_step(-0.95, -1.1, p.x), smooth_step(0.75, 0.95, p.x)});
  return 0.0274 - 0.0094 * fin;
}

/// Rest lengths of a body bent about z by a wave and about y by a steady turn.
class Muscles {
 public:
  explicit Muscles(const ElasticLattice& lattice) {
    for (const LatticeSpring& spring : lattice.springs()) {
      const Vec3d a = lattice.rest()[spring.a], b = lattice.rest()[spring.b];
      fibres_.push_back({(a + b) * 0.5, b - a});
    }
  }

  void contract(double seconds, ElasticLattice& lattice) const {
    constexpr double kBeats = 1.5, kWave = 2.6;  // per second; metres
    const double effort = smooth_step(0, 0.6, seconds);
    const double turn = 0.55 * smooth_step(1.2, 2.0, seconds);
    for (std::size_t i = 0; i < fibres_.size(); ++i) {
      const Fibre& f = fibres_[i];
      const double tail = smooth_step(0.7, -1.0, f.middle.x);
      const double beat = sine(kBeats * seconds + f.middle.x / kWave);
      const double bend = effort * (0.25 + 1.75 * tail) * beat;
      const double scale = 1 + bend * f.middle.y - turn * (1 - 0.5 * tail) * f.middle.z;
      lattice.springs()[i].rest =
          length(Vec3d{f.along.x * std::min(std::max(scale, 0.5), 1.5), f.along.y, f.along.z});
    }
  }

 private:
  struct Fibre {
    Vec3d middle, along;  ///< at rest
  };
  std::vector<Fibre> fibres_;
};

/// Each face of the skin is slowed along its normal, whichever way it goes.
void resist(ElasticLattice& lattice, double seconds) {
  constexpr double kWater = 60;  // per second, for a face of one cell
  std::vector<Vec3d>& velocities = lattice.velocities();
  const std::vector<Vec3d>& positions = lattice.positions();
  for (const LatticeFace& f : lattice.faces()) {
    const Vec3d normal =
        normalized(cross(positions[f[2]] - positions[f[0]], positions[f[3]] - positions[f[1]]));
    Vec3d mean;
    for (const std::uint32_t v : f) mean += velocities[v] * 0.25;
    const Vec3d loss = normal * (dot(mean, normal) * kWater * seconds * 0.25);
    for (const std::uint32_t v : f) velocities[v] += -loss;
  }
}

}  // namespace

SampleSequence make_dolphin() {
  const Aabbd box{{-1.50, -0.48, -0.56}, {1.24, 0.54, 0.56}};
  const TriangleMesh mesh = mesh_solid({dolphin, seam, box, 0.022, edge_length});
  SampleSequence sequence;
  sequence.triangles = mesh.triangles;
  for (const Vec3d& p : mesh.positions) sequence.colors.push_back(color(p));

  constexpr int kSteps = 24;
  constexpr double kCell = 0.08, kStiffness = 14000, kDamping = 2;
  ElasticLattice lattice(dolphin, box, kCell);
  const ElasticLattice::Embedding embedding(lattice, mesh.positions);
  const Muscles muscles(lattice);
  for (int key = 0; key < kKeys; ++key) {
    sequence.poses.push_back(embedding.positions(lattice));
    for (int i = 0; i < kSteps; ++i) {
      muscles.contract((key + static_cast<double>(i) / kSteps) * kKeySeconds, lattice);
      resist(lattice, kKeySeconds / kSteps);
      lattice.step({kKeySeconds / kSteps, kStiffness, kDamping, {}, {}});
    }
  }
  return sequence;
}

}  // namespace mdk
