// An elastic body: a lattice of cubes about a solid, held together by springs, with the solid's
// surface embedded in it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "assets/distance_field.h"
#include "common/math/aabb.h"

namespace mdk {

struct LatticeSpring {
  std::uint32_t a = 0, b = 0;
  double rest = 0;  ///< present rest length; muscles change it
};

/// A square on the outside of the lattice, counter-clockwise from outside.
using LatticeFace = std::array<std::uint32_t, 4>;

class ElasticLattice {
 public:
  /// Fills `box` with cubes of side `cell` wherever they meet the solid of `field`.
  ElasticLattice(const DistanceField& field, const Aabbd& box, double cell);

  /// One step of symplectic Euler for particles of unit mass. Stable while seconds is below about
  /// 2 / sqrt(60 stiffness).
  struct StepRules {
    double seconds = 0;
    double stiffness = 0;  ///< of a spring, N/m
    double damping = 0;    ///< of its change of length, N s/m
    Vec3d acceleration;
    /// Keeps a particle out of where it may not be.
    std::function<void(Vec3d& position, Vec3d& velocity)> contact;
  };
  void step(const StepRules& rules);

  /// Where points that were at `rest_points` at the beginning are now. Each must lie in a cube.
  class Embedding {
   public:
    Embedding(const ElasticLattice& lattice, const std::vector<Vec3d>& rest_points);
    std::vector<Vec3d> positions(const ElasticLattice& lattice) const;

   private:
    struct Place {
      std::uint32_t cube = 0;
      Vec3d inside;  ///< 0 to 1 along each side
    };
    std::vector<Place> places_;
  };

  const std::vector<Vec3d>& rest() const { return rest_; }
  std::vector<Vec3d>& positions() { return positions_; }
  std::vector<Vec3d>& velocities() { return velocities_; }
  const std::vector<LatticeSpring>& springs() const { return springs_; }
  std::vector<LatticeSpring>& springs() { return springs_; }
  const std::vector<LatticeFace>& faces() const { return faces_; }
  double cell() const { return cell_; }

 private:
  using CornerNumbers = std::map<std::array<std::size_t, 3>, std::uint32_t>;
  using Cube = std::array<std::uint32_t, 8>;  ///< corners by bits: x = 1, y = 2, z = 4

  std::size_t cube_index(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * count_[1] + j) * count_[0] + i;
  }
  void make_cubes(const DistanceField& field, CornerNumbers& corner_number);
  void make_springs(const CornerNumbers& corner_number);
  void make_faces();

  Vec3d lo_;
  double cell_;
  std::array<std::size_t, 3> count_{};
  std::vector<std::uint32_t> cube_of_;  ///< per place of the grid, or kNone
  std::vector<Cube> cubes_;
  std::vector<std::array<std::size_t, 3>> cube_places_;
  std::vector<Vec3d> rest_, positions_, velocities_;
  std::vector<LatticeSpring> springs_;
  std::vector<LatticeFace> faces_;
};

}  // namespace mdk
