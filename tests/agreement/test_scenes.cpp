#include "tests/agreement/test_scenes.h"

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace mdk::test {
namespace {

/// Fills keys of one clip from a function of (vertex's rest position, key in [0, 1]).
void animate(PoseSequence& s, std::uint32_t keys, const std::vector<Vec3f>& rest,
             const std::function<Vec3f(const Vec3f&, std::size_t, double)>& at) {
  s.vertex_count = static_cast<std::uint32_t>(rest.size());
  s.clips = {{"test", 0, keys}};
  for (std::uint32_t k = 0; k < keys; ++k) {
    const double phase = keys > 1 ? static_cast<double>(k) / (keys - 1) : 0;
    s.key_times.push_back(k / 30.0);
    for (std::size_t i = 0; i < rest.size(); ++i) s.positions.push_back(at(rest[i], i, phase));
  }
  s.appearance.materials = {Material{}};
  s.appearance.triangle_materials.assign(s.triangles.size(), 0);
}

Vec3f turned(const Vec3f& p, double angle) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

}  // namespace

PoseSequence bending_tube(std::uint32_t segments, std::uint32_t around, std::uint32_t keys) {
  PoseSequence s;
  std::vector<Vec3f> rest;
  for (std::uint32_t i = 0; i <= segments; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double angle = 2 * std::numbers::pi * j / around;
      rest.push_back({static_cast<float>(0.3 * std::cos(angle)),
                      4.0f * static_cast<float>(i) / static_cast<float>(segments),
                      static_cast<float>(0.3 * std::sin(angle))});
    }
  const auto index = [&](std::uint32_t i, std::uint32_t j) { return i * around + j % around; };
  for (std::uint32_t i = 0; i < segments; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      s.triangles.push_back({{index(i, j), index(i + 1, j), index(i, j + 1)}});
      s.triangles.push_back({{index(i, j + 1), index(i + 1, j), index(i + 1, j + 1)}});
    }
  for (std::uint32_t j = 1; j + 1 < around; ++j) {
    s.triangles.push_back({{index(0, 0), index(0, j), index(0, j + 1)}});
    s.triangles.push_back({{index(segments, 0), index(segments, j + 1), index(segments, j)}});
  }
  animate(s, keys, rest, [](const Vec3f& p, std::size_t, double phase) {
    const double bend = 1.6 * std::sin(2 * std::numbers::pi * phase) * p.y / 4;
    const float swell = 1 + 0.3f * static_cast<float>(std::sin(6 * phase + p.y));
    const Vec3f bent = turned({p.x * swell, p.y, p.z * swell}, bend);
    return Vec3f{bent.x + static_cast<float>(phase), bent.y, bent.z};
  });
  return s;
}

PoseSequence twisting_sphere(int levels, std::uint32_t keys) {
  PoseSequence s;
  std::vector<Vec3f> rest = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t i = 0; i < 8; ++i) {
    const std::uint32_t x = i & 1, y = 2 + (i >> 1 & 1), z = 4 + (i >> 2);
    const bool is_even = (x + y + z) % 2 == 0;
    s.triangles.push_back(is_even ? Triangle{{x, y, z}} : Triangle{{x, z, y}});
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, is_new] =
          middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(rest.size()));
      if (is_new) rest.push_back(normalized(rest[a] + rest[b]));
      return at->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [v] : s.triangles) {
      const std::uint32_t ab = middle(v[0], v[1]), bc = middle(v[1], v[2]), ca = middle(v[2], v[0]);
      for (const Triangle& t : {Triangle{{v[0], ab, ca}}, Triangle{{ab, v[1], bc}},
                                Triangle{{ca, bc, v[2]}}, Triangle{{ab, bc, ca}}})
        finer.push_back(t);
    }
    s.triangles = std::move(finer);
  }
  animate(s, keys, rest, [](const Vec3f& p, std::size_t, double phase) {
    const Vec3f twisted = turned({p.x, p.z, p.y}, 2 * phase * p.y);
    return Vec3f{twisted.x, twisted.z, twisted.y};
  });
  return s;
}

PoseSequence random_triangles(std::uint32_t count, std::uint32_t keys, float size, float offset) {
  PoseSequence s;
  std::mt19937 random(count * 31 + keys);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto point = [&] { return Vec3f{unit(random), unit(random), unit(random)}; };
  std::vector<Vec3f> rest;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3f a = point();
    Vec3f b = a + point() * 0.2f, c = a + point() * 0.2f;
    if (i % 7 == 1) c = a + (b - a) * 0.5f + point() * 1e-6f;                // a sliver
    if (i % 11 == 2) b = c = a;                                              // a point
    if (i % 13 == 3) c = b;                                                  // a line
    if (i % 5 == 4) b = {a.x, a.y + 0.2f, a.z}, c = {a.x, a.y, a.z + 0.2f};  // axis-aligned
    const auto first = static_cast<std::uint32_t>(rest.size());
    s.triangles.push_back({{first, first + 1, first + 2}});
    if (i % 17 == 5) s.triangles.push_back({{first, first + 1, first + 2}});  // twice
    if (i % 19 == 6) s.triangles.push_back({{first, first, first + 1}});
    rest.insert(rest.end(), {a, b, c});
  }
  std::vector<Vec3f> drift;
  for (std::size_t i = 0; i < rest.size(); ++i) drift.push_back(point() * 0.3f);
  animate(s, keys, rest, [&](const Vec3f& p, std::size_t i, double phase) {
    const Vec3f moved = turned(p + drift[i] * static_cast<float>(std::sin(5 * phase)), 2 * phase);
    return Vec3f{moved.x * size + offset, moved.y * size, moved.z * size};
  });
  return s;
}

PoseSequence edge_on_sheet(std::uint32_t count, std::uint32_t keys) {
  PoseSequence s;
  std::mt19937 random(count);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Vec3f> rest;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float y = unit(random), z = unit(random);
    for (std::uint32_t k = 0; k < 3; ++k) {
      rest.push_back({1e-7f * unit(random), y + 0.1f * unit(random), z + 0.1f * unit(random)});
    }
    s.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  animate(s, keys, rest, [](const Vec3f& p, std::size_t, double phase) {
    return Vec3f{p.x, p.y + static_cast<float>(phase), p.z};
  });
  return s;
}

PoseSequence flying_boxes(std::uint32_t count, std::uint32_t keys) {
  PoseSequence s;
  std::vector<Vec3f> rest;
  for (std::uint32_t b = 0; b < count; ++b) {
    const auto first = static_cast<std::uint32_t>(rest.size());
    for (int i = 0; i < 8; ++i)
      rest.push_back({i & 1 ? 0.2f : -0.2f, i & 2 ? 0.2f : -0.2f, i & 4 ? 0.2f : -0.2f});
    constexpr std::uint32_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& f : kFaces) {
      s.triangles.push_back({{first + f[0], first + f[1], first + f[2]}});
      s.triangles.push_back({{first + f[0], first + f[2], first + f[3]}});
    }
  }
  animate(s, keys, rest, [](const Vec3f& p, std::size_t i, double phase) {
    const auto box = static_cast<double>(i / 8);
    const auto away = static_cast<float>(3 * phase);
    const Vec3f spun = turned(p, (box + 1) * 3 * phase);
    return Vec3f{spun.x + away * static_cast<float>(std::cos(box * 2.4)),
                 spun.y + away * static_cast<float>(std::sin(box * 2.4)),
                 spun.z + away * static_cast<float>(std::cos(box * 1.7))};
  });
  return s;
}

std::vector<NamedSequence> agreement_scenes() {
  std::vector<NamedSequence> scenes;
  scenes.push_back({"bending tube", bending_tube(40, 24, 12)});
  scenes.push_back({"flying boxes", flying_boxes(12, 6)});
  scenes.push_back({"random triangles", random_triangles(800, 5, 1, 0)});
  scenes.push_back({"far from the origin", random_triangles(200, 3, 100, 1e6f)});
  scenes.push_back({"on a coarse grid, far from the origin", random_triangles(400, 3, 4, 1e6f)});
  scenes.push_back({"edge-on sheet", edge_on_sheet(600, 2)});
  scenes.push_back({"tiny", random_triangles(200, 3, 1e-6f, 0)});
  scenes.push_back({"one key", bending_tube(10, 8, 1)});

  PoseSequence sheet = bending_tube(12, 9, 4);
  for (Vec3f& p : sheet.positions) p.z = 0;
  scenes.push_back({"flat sheet", std::move(sheet)});

  PoseSequence collapsing = bending_tube(10, 8, 5);
  for (Vec3f& p : collapsing.pose(2)) p = {1, 2, 3};
  scenes.push_back({"collapses to a point", std::move(collapsing)});

  PoseSequence one = random_triangles(1, 4, 1, 0);
  scenes.push_back({"one triangle", std::move(one)});

  PoseSequence still = bending_tube(10, 8, 3);
  for (std::uint32_t k = 1; k < 3; ++k)
    for (std::size_t i = 0; i < still.vertex_count; ++i) still.pose(k)[i] = still.pose(0)[i];
  scenes.push_back({"does not move", std::move(still)});
  return scenes;
}

DecomposeResult bake(PoseSequence sequence) {
  SilentProgress silent;
  return decompose(std::move(sequence), {}, silent);
}

}  // namespace mdk::test
