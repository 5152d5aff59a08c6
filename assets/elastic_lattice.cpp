// Springs run along all 28 pairs of a cube's corners; neighbours share theirs. Forces are summed in
// a fixed order, so the same body always falls the same way.
#include "assets/elastic_lattice.h"

#include <algorithm>
#include <set>
#include <utility>

namespace mdk {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

}  // namespace

ElasticLattice::ElasticLattice(const DistanceField& field, const Aabbd& box, double cell)
    : lo_(box.lo), cell_(cell) {
  for (std::size_t a = 0; a < 3; ++a)
    count_[a] = static_cast<std::size_t>(std::ceil(box.extent()[a] / cell));
  CornerNumbers corner_number;
  make_cubes(field, corner_number);
  make_springs(corner_number);
  make_faces();
  positions_ = rest_;
  velocities_.assign(rest_.size(), {});
}

void ElasticLattice::make_cubes(const DistanceField& field, CornerNumbers& corner_number) {
  // A cube whose centre is further out than its half diagonal does not meet the solid.
  const double reach = 0.8661 * cell_;
  cube_of_.assign(count_[0] * count_[1] * count_[2], kNone);
  for (std::size_t k = 0; k < count_[2]; ++k)
    for (std::size_t j = 0; j < count_[1]; ++j)
      for (std::size_t i = 0; i < count_[0]; ++i) {
        const auto at = [&](double x, double y, double z) {
          return lo_ + Vec3d{static_cast<double>(i) + x, static_cast<double>(j) + y,
                             static_cast<double>(k) + z} *
                           cell_;
        };
        if (field(at(0.5, 0.5, 0.5)) > reach) continue;
        Cube cube;
        for (std::size_t c = 0; c < 8; ++c) {
          const std::size_t x = c & 1, y = c >> 1 & 1, z = c >> 2;
          const auto [it, is_new] = corner_number.try_emplace(
              {i + x, j + y, k + z}, static_cast<std::uint32_t>(rest_.size()));
          cube[c] = it->second;
          if (is_new)
            rest_.push_back(
                at(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)));
        }
        cube_of_[cube_index(i, j, k)] = static_cast<std::uint32_t>(cubes_.size());
        cubes_.push_back(cube);
        cube_places_.push_back({i, j, k});
      }
}

void ElasticLattice::make_springs(const CornerNumbers& corner_number) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const Cube& cube : cubes_)
    for (std::size_t a = 0; a < 8; ++a)
      for (std::size_t b = a + 1; b < 8; ++b) {
        const auto pair = std::minmax(cube[a], cube[b]);
        if (!seen.insert(pair).second) continue;
        springs_.push_back(
            {pair.first, pair.second, length(rest_[pair.second] - rest_[pair.first])});
      }
  // Longer ones along the axes keep thin parts from folding inside out for good.
  for (const auto& [place, number] : corner_number)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const std::size_t cells : {2, 3}) {
        auto far = place;
        far[axis] += cells;
        const auto it = corner_number.find(far);
        if (it == corner_number.end()) continue;
        springs_.push_back({number, it->second, cell_ * static_cast<double>(cells)});
      }
}

void ElasticLattice::make_faces() {
  // Corners of the faces towards -x, +x, -y, +y, -z, +z, counter-clockwise from outside.
  constexpr std::size_t kCorners[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (std::size_t c = 0; c < cubes_.size(); ++c)
    for (std::size_t side = 0; side < 6; ++side) {
      auto place = cube_places_[c];
      const std::size_t axis = side / 2;
      const bool at_end = side % 2 ? place[axis] + 1 == count_[axis] : place[axis] == 0;
      if (!at_end) {
        place[axis] += side % 2 ? 1 : std::size_t(-1);
        if (cube_of_[cube_index(place[0], place[1], place[2])] != kNone) continue;
      }
      LatticeFace face;
      for (std::size_t i = 0; i < 4; ++i) face[i] = cubes_[c][kCorners[side][i]];
      faces_.push_back(face);
    }
}

void ElasticLattice::step(const StepRules& rules) {
  std::vector<Vec3d> gain(positions_.size(), rules.acceleration * rules.seconds);
  for (const LatticeSpring& spring : springs_) {
    const Vec3d apart = positions_[spring.b] - positions_[spring.a];
    const double now = length(apart);
    if (now == 0) continue;
    const Vec3d along = apart * (1 / now);
    const double parting = dot(velocities_[spring.b] - velocities_[spring.a], along);
    const double pull = rules.stiffness * (now - spring.rest) + rules.damping * parting;
    const Vec3d impulse = along * (pull * rules.seconds);
    gain[spring.a] += impulse;
    gain[spring.b] += -impulse;
  }
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    velocities_[i] += gain[i];
    positions_[i] += velocities_[i] * rules.seconds;
    if (rules.contact) rules.contact(positions_[i], velocities_[i]);
  }
}

ElasticLattice::Embedding::Embedding(const ElasticLattice& lattice,
                                     const std::vector<Vec3d>& rest_points) {
  for (const Vec3d& p : rest_points) {
    std::array<std::size_t, 3> place{};
    Place found;
    for (std::size_t a = 0; a < 3; ++a) {
      const double steps = (p[a] - lattice.lo_[a]) / lattice.cell_;
      place[a] = std::min(static_cast<std::size_t>(std::max(steps, 0.0)), lattice.count_[a] - 1);
      found.inside[a] = steps - static_cast<double>(place[a]);
    }
    found.cube = lattice.cube_of_[lattice.cube_index(place[0], place[1], place[2])];
    places_.push_back(found);
  }
}

std::vector<Vec3d> ElasticLattice::Embedding::positions(const ElasticLattice& lattice) const {
  std::vector<Vec3d> out;
  out.reserve(places_.size());
  for (const Place& place : places_) {
    const Cube& cube = lattice.cubes_[place.cube];
    Vec3d sum;
    for (std::size_t c = 0; c < 8; ++c) {
      const double x = c & 1 ? place.inside.x : 1 - place.inside.x;
      const double y = c >> 1 & 1 ? place.inside.y : 1 - place.inside.y;
      const double z = c >> 2 ? place.inside.z : 1 - place.inside.z;
      sum += lattice.positions_[cube[c]] * (x * y * z);
    }
    out.push_back(sum);
  }
  return out;
}

}  // namespace mdk
