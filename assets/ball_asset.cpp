#include "assets/ball_asset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "assets/ball_motion.h"
#include "assets/distance_field.h"
#include "assets/isotropic_remesher.h"
#include "assets/surface_mesher.h"

namespace mdk {
namespace {

constexpr double kMetresPerUnit = 0.01;  // the shapes are modelled in centimetres
constexpr double kGradientStep = 0.01;

using ByteColor = std::array<std::uint8_t, 4>;  ///< linear RGBA
constexpr ByteColor kCream{226, 214, 186, 255}, kCoral{196, 44, 30, 255}, kTeal{8, 116, 126, 255},
    kAmber{232, 140, 16, 255}, kOak{122, 86, 56, 255}, kWalnut{52, 34, 24, 255};

struct Solid {
  std::string name;
  Aabbd box;
  double grid_cell;
  DistanceField field, seam;
  std::function<double(const Vec3d&)> edge_length;
  std::function<ByteColor(const Vec3d&)> color;
};

GlbMesh make_mesh(const Solid& solid) {
  const RemeshOptions options{solid.edge_length, solid.seam, 10, kGradientStep};
  const TriangleMesh surface =
      remesh(mesh_surface(solid.field, solid.box, solid.grid_cell), solid.field, options);
  GlbMesh mesh;
  mesh.name = solid.name;
  // Colour belongs to triangles: where two meet, the vertices between them stand there twice.
  std::map<std::pair<std::uint32_t, ByteColor>, std::uint32_t> made;
  for (const auto& corners : surface.triangles) {
    Vec3d middle;
    for (const std::uint32_t v : corners) middle += surface.positions[v] * (1.0 / 3);
    const ByteColor color = solid.color(middle);
    auto& triangle = mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d& p = surface.positions[corners[i]];
      const auto next = static_cast<std::uint32_t>(mesh.positions.size());
      const auto [it, is_new] = made.try_emplace({corners[i], color}, next);
      triangle[i] = it->second;
      if (!is_new) continue;
      mesh.positions.push_back(p * kMetresPerUnit);
      mesh.normals.push_back(normalized(gradient(solid.field, p, kGradientStep)));
      mesh.colors.push_back(color);
    }
  }
  return mesh;
}

/// A play ball of six panels that meet at two caps; its poles lean towards the viewer.
class PanelBall {
 public:
  double distance(const Vec3d& p) const {
    // Panels bulge a little between their seams.
    return length(p) - kBallRadius + 0.16 * smooth_step(0.7, 0, std::abs(seam(p)));
  }

  double seam(const Vec3d& p) const {
    const Vec3d q = poles_.to_local(p);
    const double cap = std::sqrt(q.x * q.x + q.z * q.z) - kCap;
    double nearest = cap;
    if (cap > 0)
      for (const double side : sides(q))
        if (std::abs(side) < std::abs(nearest)) nearest = side;
    return nearest;
  }

  ByteColor color(const Vec3d& p) const {
    const Vec3d q = poles_.to_local(p);
    if (std::sqrt(q.x * q.x + q.z * q.z) < kCap) return kCream;
    const auto [a, b, c] = sides(q);
    // Round the ball, the signs run through +-- ++- +++ -++ --+ ---.
    const int panel = (a > 0) * 4 + (b > 0) * 2 + (c > 0);
    if (panel == 4) return kCoral;
    if (panel == 7) return kTeal;
    return panel == 1 ? kAmber : kCream;
  }

 private:
  static constexpr double kCap = 2.6;

  /// Signed distances to the three planes through the poles that part the panels.
  static std::array<double, 3> sides(const Vec3d& q) {
    constexpr double kHalf = 0.5, kRoot = 0.86602540378443865;
    return {q.x, kHalf * q.x + kRoot * q.z, -kHalf * q.x + kRoot * q.z};
  }

  Basis poles_ = basis_along({0, 0, 0}, {0.35, 0.45, 1}, {0, 1, 0});
};

Solid ball() {
  const PanelBall shape;
  const double reach = kBallRadius + 0.5;
  return {"ball",
          {{-reach, -reach, -reach}, {reach, reach, reach}},
          0.7,
          [shape](const Vec3d& p) { return shape.distance(p); },
          [shape](const Vec3d& p) { return shape.seam(p); },
          [](const Vec3d&) { return 0.72; },
          [shape](const Vec3d& p) { return shape.color(p); }};
}

/// A round wooden floor with two inlaid rings; its top is at y = 0.
Solid floor_disc() {
  constexpr double kRadius = 34, kThickness = 3, kRound = 1.2;
  const auto radial = [](const Vec3d& p) { return std::sqrt(p.x * p.x + p.z * p.z); };
  const auto seam = [radial](const Vec3d& p) {
    double nearest = 1e9;
    for (const double ring : {14.0, 15.5, 29.0, 30.5}) {
      const double d = radial(p) - ring;
      if (p.y > -1 && std::abs(d) < std::abs(nearest)) nearest = d;
    }
    return nearest;
  };
  return {"floor",
          {{-36, -4, -36}, {36, 1, 36}},
          1.0,
          [radial](const Vec3d& p) {
            const double side = std::max(radial(p) - kRadius + kRound, 0.0);
            const double away = std::abs(p.y + kThickness / 2) - kThickness / 2 + kRound;
            const double rim = std::sqrt(side * side + std::max(away, 0.0) * std::max(away, 0.0));
            return rim + std::min(std::max(away, radial(p) - kRadius + kRound), 0.0) - kRound;
          },
          seam,
          [radial](const Vec3d& p) {
            if (p.y < -2.2 && radial(p) < kRadius - 2) return 4.0;
            const double inner = std::abs(radial(p) - 14.75), outer = std::abs(radial(p) - 29.75);
            return 1.1 + 1.2 * smooth_step(1, 5, std::min({inner, outer, kRadius - radial(p)}));
          },
          [radial](const Vec3d& p) {
            const double r = radial(p);
            const bool inlaid = (r > 14 && r < 15.5) || (r > 29 && r < 30.5);
            return p.y > -1 && inlaid ? kWalnut : kOak;
          }};
}

GlbTrack track(int node, GlbPath path) { return {node, path, {}}; }

std::array<double, 4> values(const Quaternion& q) { return {q.x, q.y, q.z, q.w}; }

/// The tilted stretch is a turn, a scale along the axes, and the turn taken back: hence two nodes.
GlbClip make_clip(const BallClip& clip, int outer, int inner) {
  GlbTrack place = track(outer, GlbPath::kTranslation), tilt = track(outer, GlbPath::kRotation);
  GlbTrack stretch = track(outer, GlbPath::kScale), spin = track(inner, GlbPath::kRotation);
  for (const BallPose& pose : clip.poses) {
    const Vec3d c = pose.center * kMetresPerUnit;
    const double across = 1 / std::sqrt(pose.stretch);
    place.values.push_back({c.x, c.y, c.z});
    tilt.values.push_back(values(rotation_about(2, pose.tilt)));
    stretch.values.push_back({across, pose.stretch, across});
    spin.values.push_back(values(rotation_about(2, pose.spin - pose.tilt)));
  }
  return {clip.name, clip.times, {place, tilt, stretch, spin}};
}

}  // namespace

GlbScene make_ball_scene() {
  GlbScene scene;
  scene.copyright = "Apache-2.0";
  scene.meshes = {make_mesh(floor_disc()), make_mesh(ball())};
  GlbNode floor_node, outer, inner;
  floor_node.name = "floor";
  floor_node.mesh = 0;
  outer.name = "ball_stretch";
  outer.translation = {0, kBallRadius * kMetresPerUnit, 0};
  inner.name = "ball";
  inner.parent = 1;
  inner.mesh = 1;
  scene.nodes = {floor_node, outer, inner};
  for (const BallClip& clip : make_ball_clips()) scene.clips.push_back(make_clip(clip, 1, 2));
  return scene;
}

}  // namespace mdk
