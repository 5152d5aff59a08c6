// Each cube of a regular grid is split into six tetrahedra around one of its space diagonals. Where
// the field changes sign along an edge, a vertex; within a tetrahedron one triangle (one corner
// apart from three) or two (two and two). Neighbours agree on the diagonals of their shared faces,
// so the surface closes.
#include "assets/surface_mesher.h"

#include <cstddef>
#include <unordered_map>
#include <utility>

namespace mdk {
namespace {

// Corners of a cube are numbered by bits: x = 1, y = 2, z = 4. All six tetrahedra run from corner 0
// to corner 7, and all are positively oriented.
constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                   {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

class MarchingTetrahedra {
 public:
  MarchingTetrahedra(const DistanceField& field, const Aabbd& box, double cell)
      : lo_(box.lo), cell_(cell) {
    for (std::size_t a = 0; a < 3; ++a)
      n_[a] = static_cast<std::size_t>(std::ceil(box.extent()[a] / cell)) + 1;
    values_.reserve(n_[0] * n_[1] * n_[2]);
    for (std::size_t k = 0; k < n_[2]; ++k)
      for (std::size_t j = 0; j < n_[1]; ++j)
        for (std::size_t i = 0; i < n_[0]; ++i) values_.push_back(field(corner(i, j, k)));
  }

  TriangleMesh run() {
    for (std::size_t k = 0; k + 1 < n_[2]; ++k)
      for (std::size_t j = 0; j + 1 < n_[1]; ++j)
        for (std::size_t i = 0; i + 1 < n_[0]; ++i) march_cube(i, j, k);
    return std::move(mesh_);
  }

 private:
  std::size_t id(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * n_[1] + j) * n_[0] + i;
  }
  Vec3d corner(std::size_t i, std::size_t j, std::size_t k) const {
    return {lo_.x + cell_ * static_cast<double>(i), lo_.y + cell_ * static_cast<double>(j),
            lo_.z + cell_ * static_cast<double>(k)};
  }
  Vec3d corner(std::size_t id) const {
    return corner(id % n_[0], id / n_[0] % n_[1], id / (n_[0] * n_[1]));
  }
  bool inside(std::size_t id) const { return values_[id] < 0; }

  void march_cube(std::size_t i, std::size_t j, std::size_t k) {
    std::size_t ids[8];
    int count = 0;
    for (std::size_t c = 0; c < 8; ++c) {
      ids[c] = id(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
      count += inside(ids[c]);
    }
    if (count == 0 || count == 8) return;
    for (const auto& t : kTetrahedra)
      march_tetrahedron({ids[t[0]], ids[t[1]], ids[t[2]], ids[t[3]]});
  }

  void march_tetrahedron(const std::array<std::size_t, 4>& t) {
    std::array<std::size_t, 4> in{}, out{};
    std::size_t ins = 0, outs = 0;
    for (const std::size_t c : t) (inside(c) ? in[ins++] : out[outs++]) = c;
    // Vertices are numbered as they are made, so each is made in a statement of its own: compilers
    // are free in the order of arguments.
    if (ins == 2) {
      const auto a = cut(in[0], out[0]);
      const auto b = cut(in[0], out[1]);
      const auto c = cut(in[1], out[1]);
      const auto d = cut(in[1], out[0]);
      add_triangle({a, b, c}, in[0], out[0]);
      add_triangle({a, c, d}, in[0], out[0]);
    } else if (ins == 1 || ins == 3) {
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i)
        corners[i] = ins == 1 ? cut(in[0], out[i]) : cut(in[i], out[0]);
      add_triangle(corners, in[0], out[0]);
    }
  }

  /// The vertex on the grid edge from an inner to an outer corner, made when first asked for.
  std::uint32_t cut(std::size_t in, std::size_t out) {
    const auto key = static_cast<std::uint64_t>(std::min(in, out)) * values_.size() +
                     static_cast<std::uint64_t>(std::max(in, out));
    const auto [it, is_new] =
        vertex_of_edge_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      // Kept away from the corners: no triangle may shrink to a point.
      const double s = std::clamp(values_[in] / (values_[in] - values_[out]), 0.02, 0.98);
      mesh_.positions.push_back(corner(in) + (corner(out) - corner(in)) * s);
    }
    return it->second;
  }

  /// Winds the triangle so that its front looks from the inner corner to the outer one.
  void add_triangle(const std::array<std::uint32_t, 3>& corners, std::size_t in, std::size_t out) {
    const auto& [a, b, c] = corners;
    const Vec3d pa = mesh_.positions[a];
    const Vec3d normal = cross(mesh_.positions[b] - pa, mesh_.positions[c] - pa);
    const bool front = dot(normal, corner(out) - pa) - dot(normal, corner(in) - pa) > 0;
    mesh_.triangles.push_back(front ? std::array{a, b, c} : std::array{a, c, b});
  }

  Vec3d lo_;
  double cell_;
  std::array<std::size_t, 3> n_{};
  std::vector<double> values_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex_of_edge_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh mesh_surface(const DistanceField& field, const Aabbd& box, double cell) {
  return MarchingTetrahedra(field, box, cell).run();
}

}  // namespace mdk
