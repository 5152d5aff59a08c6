// Small made-up animations with known answers.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

struct Mesh {
  std::vector<Vec3d> vertices;
  std::vector<Triangle> triangles;
};

/// A curved sheet of n x n quads (2 n^2 triangles) with corners near (0, 0) and (1, 1).
Mesh curved_sheet(std::uint32_t n);

/// Both meshes, without shared vertices.
Mesh joined(const Mesh& a, const Mesh& b);

/// Turns by `angle` radians about `axis` (not zero), then moves by `shift`.
Affine3d rigid_motion(const Vec3d& axis, double angle, const Vec3d& shift);

/// A linear part with entries in [-1, 1] whose determinant is at least 0.05, and a shift.
Affine3d random_affine(std::mt19937& random);

Vec3d random_point(std::mt19937& random, double size);

/// One clip of `keys` keys, 30 a second: vertex i of key k at position(k, i).
PoseSequence make_sequence(const Mesh& mesh, std::uint32_t keys,
                           const std::function<Vec3d(std::uint32_t, std::uint32_t)>& position);

/// `part_count` curved sheets side by side; each turns and wanders on its own over `keys` keys.
/// `part_of_triangle` (if given) receives the part of each triangle.
PoseSequence independent_parts(std::uint32_t part_count, std::uint32_t keys,
                               std::vector<std::uint32_t>* part_of_triangle = nullptr);

/// A sheet that bends, twists, shakes and turns fast: `keys` keys in two clips (one, below 4 keys).
PoseSequence wild_motion(std::uint32_t seed, std::uint32_t keys);

/// Every byte of the model that a file would hold, for comparing two models.
std::vector<unsigned char> model_bytes(const ModelStorage& model);

/// How many maps of a model turn inside out, or are flat.
std::size_t mirrored_maps(const ModelStorage& model);

/// Fuzzy boxes of a model's first segment, in triangle order.
std::vector<Aabb> first_fuzzy_boxes(const ModelStorage& model);

}  // namespace mdk
