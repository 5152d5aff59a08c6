#include "tests/preprocess/moving_meshes.h"

#include <cmath>
#include <cstring>

namespace mdk {
namespace {

template <class T>
void append(std::vector<unsigned char>& bytes, const std::vector<T>& items) {
  const std::size_t at = bytes.size(), size = items.size() * sizeof(T);
  bytes.resize(at + size);
  if (size > 0) std::memcpy(&bytes[at], items.data(), size);
}

}  // namespace

Mesh curved_sheet(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
      mesh.vertices.push_back({u, v, 0.3 * std::sin(3 * u) * std::cos(2 * v)});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({{a, b, d}});
      mesh.triangles.push_back({{a, d, c}});
    }
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh mesh = a;
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles)
    mesh.triangles.push_back({{t.v[0] + base, t.v[1] + base, t.v[2] + base}});
  return mesh;
}

Affine3d rigid_motion(const Vec3d& axis, double angle, const Vec3d& shift) {
  const Vec3d u = normalized(axis);
  const double c = std::cos(angle), s = std::sin(angle);
  const double outer[3] = {u.x, u.y, u.z};
  const double skew[3][3] = {{0, -u.z, u.y}, {u.z, 0, -u.x}, {-u.y, u.x, 0}};
  Affine3d a;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      a.m[i][j] = (i == j ? c : 0) + s * skew[i][j] + (1 - c) * outer[i] * outer[j];
    a.m[i][3] = shift[static_cast<std::size_t>(i)];
  }
  return a;
}

Affine3d random_affine(std::mt19937& random) {
  std::uniform_real_distribution<double> entry(-1, 1);
  Affine3d a;
  do {
    for (auto& row : a.m)
      for (double& m : row) m = entry(random);
  } while (std::abs(a.determinant()) < 0.05);
  return a;
}

Vec3d random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> entry(-size, size);
  const double x = entry(random), y = entry(random), z = entry(random);
  return {x, y, z};
}

PoseSequence make_sequence(const Mesh& mesh, std::uint32_t keys,
                           const std::function<Vec3d(std::uint32_t, std::uint32_t)>& position) {
  PoseSequence sequence;
  sequence.vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  sequence.triangles = mesh.triangles;
  sequence.clips = {{"motion", 0, keys}};
  for (std::uint32_t k = 0; k < keys; ++k) {
    sequence.key_times.push_back(k / 30.0);
    for (std::uint32_t i = 0; i < sequence.vertex_count; ++i)
      sequence.positions.push_back(to_float(position(k, i)));
  }
  sequence.appearance.materials.resize(1);
  sequence.appearance.triangle_materials.assign(mesh.triangles.size(), 0);
  return sequence;
}

PoseSequence independent_parts(std::uint32_t part_count, std::uint32_t keys,
                               std::vector<std::uint32_t>* part_of_triangle) {
  Mesh mesh;
  std::vector<std::uint32_t> part_of_vertex;
  if (part_of_triangle != nullptr) part_of_triangle->clear();
  for (std::uint32_t p = 0; p < part_count; ++p) {
    Mesh part = curved_sheet(6);
    for (Vec3d& v : part.vertices) v.x += 1.5 * p;
    mesh = joined(mesh, part);
    part_of_vertex.resize(mesh.vertices.size(), p);
    if (part_of_triangle != nullptr) part_of_triangle->resize(mesh.triangles.size(), p);
  }
  return make_sequence(mesh, keys, [&](std::uint32_t k, std::uint32_t i) {
    const double p = part_of_vertex[i], t = 0.1 * k;
    const Affine3d motion =
        rigid_motion({std::cos(p), std::sin(2 * p), 1}, t * (p - 0.4),
                     {0.3 * std::sin(t * (p + 1)), t * std::cos(p), 0.2 * p * t});
    return motion.point(mesh.vertices[i]);
  });
}

PoseSequence wild_motion(std::uint32_t seed, std::uint32_t keys) {
  std::mt19937 random(seed);
  const Mesh mesh = curved_sheet(5);
  std::vector<Affine3d> moves;
  for (std::uint32_t k = 0; k < keys; ++k) {
    const Vec3d axis = random_point(random, 1) + Vec3d{0, 0, 1.8};
    std::uniform_real_distribution<double> angle(-1.5, 1.5);
    const double turn = angle(random);
    moves.push_back(rigid_motion(axis, turn, random_point(random, 3)));
  }
  PoseSequence sequence = make_sequence(mesh, keys, [&](std::uint32_t k, std::uint32_t i) {
    const Vec3d v = mesh.vertices[i];
    const Vec3d bent = {v.x, v.y + 0.2 * std::sin(4 * v.x + k), v.z + 0.1 * k * v.x * v.y};
    return moves[k].point(bent + random_point(random, 0.02));
  });
  if (keys >= 4) sequence.clips = {{"first", 0, keys / 2}, {"second", keys / 2, keys - keys / 2}};
  for (const Clip& clip : sequence.clips)
    for (std::uint32_t k = 0; k < clip.key_count; ++k)
      sequence.key_times[clip.first_key + k] = k / 30.0;
  return sequence;
}

std::vector<unsigned char> model_bytes(const ModelStorage& model) {
  std::vector<unsigned char> bytes;
  append(bytes, std::vector<std::uint32_t>{model.vertex_count, model.rest_key});
  append(bytes, std::vector<double>{model.rest_diagonal});
  append(bytes, std::vector<Aabb>{model.bounds});
  append(bytes, model.triangles);
  append(bytes, model.source_triangles);
  append(bytes, model.clusters);
  append(bytes, model.local_from_world);
  append(bytes, model.key_boxes);
  append(bytes, model.cluster_world_boxes);
  append(bytes, model.segments);
  append(bytes, model.fuzzy_trees);
  append(bytes, model.fuzzy_boxes);
  append(bytes, model.kd_nodes);
  append(bytes, model.kd_refs);
  return bytes;
}

std::size_t mirrored_maps(const ModelStorage& model) {
  std::size_t mirrored = 0;
  for (const Affine3f& map : model.local_from_world)
    mirrored += !(to_double(map).determinant() > 0);
  return mirrored;
}

std::vector<Aabb> first_fuzzy_boxes(const ModelStorage& model) {
  std::vector<Aabb> boxes;
  for (std::size_t c = 0; c < model.clusters.size(); ++c)
    for (const Aabb& box : model.view().cluster_fuzzy_boxes(0, c)) boxes.push_back(box);
  return boxes;
}

}  // namespace mdk
