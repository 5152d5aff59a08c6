// Scenes of boxes for the tests of structures: each named, each made from a fixed seed.
#pragma once

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "common/math/aabb.h"

namespace mdk::test {

/// Uniform numbers from std::mt19937_64 alone: the standard distributions differ between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  float between(float lo, float hi) {
    return std::clamp(static_cast<float>(lo + unit() * (static_cast<double>(hi) - lo)), lo, hi);
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  Vec3f point(const Aabb& box) {
    return {between(box.lo.x, box.hi.x), between(box.lo.y, box.hi.y), between(box.lo.z, box.hi.z)};
  }

 private:
  std::mt19937_64 engine_;
};

inline Aabb box_at(const Vec3f& lo, const Vec3f& size) { return {lo, lo + size}; }

/// `count` boxes with corners in a cube of side `side` and edges up to `edge`.
inline std::vector<Aabb> scattered_boxes(std::size_t count, float side, float edge,
                                         std::uint64_t seed) {
  Random random(seed);
  const Aabb cube{{0, 0, 0}, {side, side, side}}, sizes{{0, 0, 0}, {edge, edge, edge}};
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i)
    boxes.push_back(box_at(random.point(cube), random.point(sizes)));
  return boxes;
}

struct BoxScene {
  std::string name;
  std::vector<Aabb> boxes;

  friend std::ostream& operator<<(std::ostream& out, const BoxScene& scene) {
    return out << scene.name;
  }
};

/// The scene's name as GoogleTest wants it.
struct SceneName {
  template <class Tested>
  std::string operator()(const Tested& tested) const {
    std::string name = tested.param.name;
    for (char& c : name)
      if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    return name;
  }
};

/// Easy scenes and every kind of awkward one: shared faces, flat, identical, nested, huge, tiny.
inline std::vector<BoxScene> box_scenes() {
  std::vector<BoxScene> scenes;
  scenes.push_back({"one box", {box_at({1, 2, 3}, {4, 5, 6})}});
  scenes.push_back({"one point", {box_at({1, 2, 3}, {0, 0, 0})}});
  scenes.push_back({"scattered", scattered_boxes(700, 1, 0.05f, 11)});
  scenes.push_back({"overlapping", scattered_boxes(300, 1, 0.8f, 12)});
  scenes.push_back({"identical", std::vector<Aabb>(200, box_at({-1, -1, -1}, {2, 1, 3}))});
  scenes.push_back({"identical points", std::vector<Aabb>(200, box_at({5, 5, 5}, {0, 0, 0}))});
  scenes.push_back({"huge coordinates", scattered_boxes(400, 1e6f, 3e4f, 13)});
  scenes.push_back({"tiny coordinates", scattered_boxes(400, 1e-6f, 3e-8f, 14)});
  scenes.push_back({"coordinates near the end of float", scattered_boxes(100, 3e38f, 1e37f, 15)});
  scenes.push_back({"denormal coordinates", scattered_boxes(100, 1e-41f, 1e-42f, 16)});

  BoxScene lattice{"lattice with shared faces", {}};
  for (int i = 0; i < 7 * 7 * 7; ++i)
    lattice.boxes.push_back(box_at({float(i % 7), float(i / 7 % 7), float(i / 49)}, {1, 1, 1}));
  scenes.push_back(lattice);

  BoxScene flat{"flat in one, two and three axes, on a lattice", {}};
  Random random(17);
  for (int i = 0; i < 600; ++i) {
    const auto cell = [&] { return static_cast<float>(random.below(6)); };
    const auto size = [&] { return static_cast<float>(random.below(3)); };
    flat.boxes.push_back(box_at({cell(), cell(), cell()}, {size(), size(), size()}));
  }
  scenes.push_back(flat);

  BoxScene plane{"all in one plane", scattered_boxes(300, 1, 0.1f, 18)};
  for (Aabb& box : plane.boxes) box.lo.y = box.hi.y = 0.25f;
  scenes.push_back(plane);

  BoxScene line{"all on one line", scattered_boxes(300, 1, 0.01f, 19)};
  for (Aabb& box : line.boxes) box.lo.y = box.hi.y = box.lo.z = box.hi.z = -2;
  scenes.push_back(line);

  BoxScene nested{"nested", {}};
  for (int i = 1; i <= 200; ++i) {
    const float r = static_cast<float>(i) * 0.125f;
    nested.boxes.push_back({{-r, -r, -r}, {r, r, r}});
  }
  scenes.push_back(nested);

  BoxScene powers{"every power of two", {}};
  for (int e = -120; e < 120; ++e) {
    const float x = std::ldexp(1.0f, e);
    powers.boxes.push_back(box_at({x, 0, 0}, {x * 0.25f, 1, 1}));
  }
  scenes.push_back(powers);

  BoxScene mixed{"a few large boxes over many small ones", scattered_boxes(500, 1, 0.02f, 20)};
  const std::vector<Aabb> large = scattered_boxes(20, 0.3f, 0.9f, 21);
  mixed.boxes.insert(mixed.boxes.end(), large.begin(), large.end());
  scenes.push_back(mixed);
  return scenes;
}

inline bool overlap(const Aabb& a, const Aabb& b) { return !intersection(a, b).empty(); }

/// Small, large and flat boxes to ask for, in and a little around `bounds`.
inline Aabb random_query(Random& random, const Aabb& bounds) {
  Aabb query;
  query.extend(random.point(bounds));
  if (random.below(4) != 0) query.extend(random.point(bounds));
  return query;
}

}  // namespace mdk::test
