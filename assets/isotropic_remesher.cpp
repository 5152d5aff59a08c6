// Every operation looks only at the triangles around one edge. Edges are visited in triangle order,
// never in the order of a hash table, so the result is the same on every run.
#include "assets/isotropic_remesher.h"

#include <cstdlib>
#include <utility>

namespace mdk {
namespace {

using Index = std::uint32_t;
using Triangle = std::array<Index, 3>;
using Edge = std::pair<Index, Index>;

class Remesher {
 public:
  Remesher(TriangleMesh mesh, const DistanceField& field, const RemeshOptions& options)
      : mesh_(std::move(mesh)), field_(field), options_(options) {
    around_.resize(mesh_.positions.size());
    for (Index t = 0; t < mesh_.triangles.size(); ++t)
      for (const Index v : mesh_.triangles[t]) around_[v].push_back(t);
  }

  TriangleMesh run() {
    for (int round = 0; round < options_.rounds; ++round) {
      split_long_edges();
      collapse_short_edges();
      flip_edges();
      slide_vertices();
    }
    return compacted();
  }

 private:
  Vec3d& at(Index v) { return mesh_.positions[v]; }
  Triangle& triangle(Index t) { return mesh_.triangles[t]; }
  bool removed(Index t) const { return mesh_.triangles[t][0] == mesh_.triangles[t][1]; }

  Vec3d area_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) const {
    return cross(b - a, c - a);
  }
  double target(const Vec3d& a, const Vec3d& b) const {
    return options_.edge_length((a + b) * 0.5);
  }

  /// Each edge once: of its two triangles, the one that runs along it from low to high index.
  std::vector<Edge> edges() const {
    std::vector<Edge> found;
    for (Index t = 0; t < mesh_.triangles.size(); ++t) {
      if (removed(t)) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const Index a = mesh_.triangles[t][i], b = mesh_.triangles[t][(i + 1) % 3];
        if (a < b) found.push_back({a, b});
      }
    }
    return found;
  }

  /// The triangle that runs from `a` to `b`, and the corner across; false where there is no such.
  bool find_side(Index a, Index b, Index& t_found, Index& across) const {
    for (const Index t : around_[a])
      for (std::size_t i = 0; i < 3; ++i)
        if (mesh_.triangles[t][i] == a && mesh_.triangles[t][(i + 1) % 3] == b) {
          t_found = t;
          across = mesh_.triangles[t][(i + 2) % 3];
          return true;
        }
    return false;
  }

  std::vector<Index> neighbours(Index v) const {
    std::vector<Index> ring;
    for (const Index t : around_[v])
      for (std::size_t i = 0; i < 3; ++i)
        if (mesh_.triangles[t][i] == v) ring.push_back(mesh_.triangles[t][(i + 1) % 3]);
    return ring;
  }

  void detach(Index v, Index t) { std::erase(around_[v], t); }
  void replace_corner(Index t, Index from, Index to) {
    for (Index& v : triangle(t))
      if (v == from) v = to;
  }

  void split_long_edges() {
    for (const auto& [a, b] : edges()) {
      const double len = length(at(b) - at(a));
      if (len > 4.0 / 3.0 * target(at(a), at(b))) split(a, b);
    }
  }

  void split(Index a, Index b) {
    Index t0 = 0, t1 = 0, c = 0, d = 0;
    if (!find_side(a, b, t0, c) || !find_side(b, a, t1, d)) return;
    const Index m = static_cast<Index>(mesh_.positions.size());
    mesh_.positions.push_back(settle((at(a) + at(b)) * 0.5));
    const Index n0 = static_cast<Index>(mesh_.triangles.size()), n1 = n0 + 1;
    // (a b c) becomes (a m c) and (m b c); (b a d) becomes (m a d) and (b m d).
    replace_corner(t0, b, m);
    replace_corner(t1, b, m);
    mesh_.triangles.push_back({m, b, c});
    mesh_.triangles.push_back({b, m, d});
    detach(b, t0);
    detach(b, t1);
    around_[b].insert(around_[b].end(), {n0, n1});
    around_[c].push_back(n0);
    around_[d].push_back(n1);
    around_.push_back({t0, t1, n0, n1});
  }

  void collapse_short_edges() {
    for (const auto& [a, b] : edges()) {
      if (around_[a].empty() || around_[b].empty()) continue;
      const double len = length(at(b) - at(a));
      if (len < 4.0 / 5.0 * target(at(a), at(b))) try_collapse(a, b);
    }
  }

  /// Draws `b` into `a`, unless the mesh would fold, pinch or get long edges.
  void try_collapse(Index a, Index b) {
    Index t0 = 0, t1 = 0, c = 0, d = 0;
    if (!find_side(a, b, t0, c) || !find_side(b, a, t1, d)) return;
    int shared = 0;
    for (const Index v : neighbours(a))
      for (const Index w : neighbours(b)) shared += v == w;
    // A corner across with three triangles would be left with two, back to back.
    if (shared != 2 || around_[c].size() <= 3 || around_[d].size() <= 3) return;
    const Vec3d p = settle((at(a) + at(b)) * 0.5);
    if (!may_move(a, p, t0, t1) || !may_move(b, p, t0, t1)) return;

    at(a) = p;
    detach(a, t0);
    detach(a, t1);
    detach(c, t0);
    detach(d, t1);
    for (const Index t : around_[b]) {
      if (t == t0 || t == t1) continue;
      replace_corner(t, b, a);
      around_[a].push_back(t);
    }
    around_[b].clear();
    triangle(t0) = triangle(t1) = {0, 0, 0};
  }

  /// May `v` go to `p`, the triangles `t0` and `t1` apart, with no long edge and no folded
  /// triangle?
  bool may_move(Index v, const Vec3d& p, Index t0, Index t1) {
    for (const Index t : around_[v]) {
      if (t == t0 || t == t1) continue;
      const Triangle corners = triangle(t);
      std::array<Vec3d, 3> before, after;
      for (std::size_t i = 0; i < 3; ++i) {
        before[i] = at(corners[i]);
        after[i] = corners[i] == v ? p : before[i];
        if (corners[i] != v && length(before[i] - p) > 4.0 / 3.0 * target(before[i], p))
          return false;
      }
      const Vec3d old_normal = normalized(area_normal(before[0], before[1], before[2]));
      const Vec3d new_normal = normalized(area_normal(after[0], after[1], after[2]));
      if (dot(old_normal, new_normal) < 0.5) return false;
    }
    return true;
  }

  void flip_edges() {
    for (const auto& [a, b] : edges()) {
      Index t0 = 0, t1 = 0, c = 0, d = 0;
      if (!find_side(a, b, t0, c) || !find_side(b, a, t1, d)) continue;
      if (on_seam(a) && on_seam(b)) continue;
      const bool wanted = (on_seam(c) && on_seam(d)) || flip_helps(a, b, c, d);
      if (wanted && flip_is_flat(a, b, c, d)) flip({a, b}, {c, d}, {t0, t1});
    }
  }

  bool on_seam(Index v) const {
    return options_.seam &&
           std::abs(options_.seam(mesh_.positions[v])) < 2 * options_.gradient_step;
  }

  bool flip_helps(Index a, Index b, Index c, Index d) const {
    const auto off = [&](Index v, int change) {
      return std::abs(static_cast<int>(around_[v].size()) + change - 6);
    };
    return off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1) <
           off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
  }

  /// Would (a b c), (b a d) turned into (c d b), (d c a) keep facing the way they do?
  bool flip_is_flat(Index a, Index b, Index c, Index d) {
    if (around_[a].size() <= 3 || around_[b].size() <= 3) return false;
    Index t = 0, across = 0;
    if (find_side(c, d, t, across) || find_side(d, c, t, across)) return false;
    const Vec3d before =
        normalized(area_normal(at(a), at(b), at(c))) + normalized(area_normal(at(b), at(a), at(d)));
    const Vec3d front = normalized(before);
    const Vec3d n0 = normalized(area_normal(at(c), at(d), at(b)));
    const Vec3d n1 = normalized(area_normal(at(d), at(c), at(a)));
    return length(before) > 1.6 && dot(n0, front) > 0.8 && dot(n1, front) > 0.8;
  }

  void flip(const Edge& old_edge, const Edge& new_edge, const Edge& triangles) {
    const auto [a, b] = old_edge;
    const auto [c, d] = new_edge;
    const auto [t0, t1] = triangles;
    triangle(t0) = {c, d, b};
    triangle(t1) = {d, c, a};
    detach(a, t0);
    detach(b, t1);
    around_[d].push_back(t0);
    around_[c].push_back(t1);
  }

  /// Each vertex goes to the middle of its triangles, big ones (for their place) counting more, but
  /// stays on the surface and folds nothing.
  void slide_vertices() {
    for (Index v = 0; v < around_.size(); ++v) {
      if (around_[v].empty()) continue;
      Vec3d sum, normal;
      double total = 0;
      for (const Index t : around_[v]) {
        const auto& [i, j, k] = triangle(t);
        const Vec3d center = (at(i) + at(j) + at(k)) * (1.0 / 3.0);
        const Vec3d n = area_normal(at(i), at(j), at(k));
        const double size = options_.edge_length(center);
        const double weight = length(n) / (size * size);
        sum += center * weight;
        total += weight;
        normal += n;
      }
      normal = normalized(normal);
      const Vec3d step = sum * (1 / total) - at(v);
      const Vec3d p = settle(at(v) + (step - normal * dot(step, normal)) * 0.7);
      if (folded_triangles(v, p, normal) <= folded_triangles(v, at(v), normal)) at(v) = p;
    }
  }

  /// How many triangles around `v` would turn away from `front` if it were at `p`.
  int folded_triangles(Index v, const Vec3d& p, const Vec3d& front) {
    int folded = 0;
    for (const Index t : around_[v]) {
      std::array<Vec3d, 3> q;
      for (std::size_t i = 0; i < 3; ++i) q[i] = triangle(t)[i] == v ? p : at(triangle(t)[i]);
      folded += dot(normalized(area_normal(q[0], q[1], q[2])), front) < 0.1;
    }
    return folded;
  }

  /// `p` drawn onto the surface, and onto the seam if that is near.
  Vec3d settle(Vec3d p) const {
    p = project_to_surface(field_, p, options_.gradient_step);
    if (!options_.seam) return p;
    const double reach = 0.45 * options_.edge_length(p);
    for (int i = 0; i < 2 && std::abs(options_.seam(p)) < reach; ++i) {
      p = project_to_surface(options_.seam, p, options_.gradient_step);
      p = project_to_surface(field_, p, options_.gradient_step);
    }
    return p;
  }

  TriangleMesh compacted() const {
    TriangleMesh result;
    std::vector<Index> new_index(mesh_.positions.size());
    for (Index v = 0; v < around_.size(); ++v) {
      if (around_[v].empty()) continue;
      new_index[v] = static_cast<Index>(result.positions.size());
      result.positions.push_back(mesh_.positions[v]);
    }
    for (Index t = 0; t < mesh_.triangles.size(); ++t) {
      if (removed(t)) continue;
      const auto& [a, b, c] = mesh_.triangles[t];
      result.triangles.push_back({new_index[a], new_index[b], new_index[c]});
    }
    return result;
  }

  TriangleMesh mesh_;
  const DistanceField& field_;
  const RemeshOptions& options_;
  std::vector<std::vector<Index>> around_;  ///< triangles at each vertex; empty: vertex removed
};

}  // namespace

TriangleMesh remesh(TriangleMesh mesh, const DistanceField& field, const RemeshOptions& options) {
  return Remesher(std::move(mesh), field, options).run();
}

Vec3d project_to_surface(const DistanceField& field, Vec3d p, double gradient_step) {
  // In a crease the gradient vanishes while the distance does not: never trust a slope below this.
  constexpr double kLeastSlope = 0.6;
  for (int step = 0; step < 3; ++step) {
    const Vec3d g = gradient(field, p, gradient_step);
    const double slope = std::max(length(g), kLeastSlope);
    p = p - g * (field(p) / (slope * slope));
  }
  return p;
}

}  // namespace mdk
