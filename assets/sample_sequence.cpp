#include "assets/sample_sequence.h"

#include <bit>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "assets/isotropic_remesher.h"

namespace mdk {
namespace {

float rounded(double metres) { return static_cast<float>(std::round(metres * 1e6) / 1e6); }

void append(std::vector<std::uint8_t>& bytes, std::string_view text) {
  for (const char c : text) bytes.push_back(static_cast<std::uint8_t>(c));
}

void append_word(std::vector<std::uint8_t>& bytes, std::uint32_t word) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<std::uint8_t>(word >> shift));
}

void append_float(std::vector<std::uint8_t>& bytes, float value) {
  append_word(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

TriangleMesh mesh_solid(const SampleSolid& solid) {
  const RemeshOptions options{solid.edge_length, solid.seam, 10, solid.grid_cell * 0.05};
  return remesh(mesh_surface(solid.field, solid.box, solid.grid_cell), solid.field, options);
}

std::vector<std::uint8_t> encode_obj(const SampleSequence& sequence) {
  std::vector<std::uint8_t> bytes;
  char line[128];
  const std::vector<Vec3d>& pose = sequence.poses.front();
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const ByteColor& c = sequence.colors[i];
    std::snprintf(line, sizeof line, "v %.6f %.6f %.6f %.4f %.4f %.4f\n", pose[i].x, pose[i].y,
                  pose[i].z, c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
    append(bytes, line);
  }
  for (const auto& [a, b, c] : sequence.triangles) {
    std::snprintf(line, sizeof line, "f %u %u %u\n", a + 1, b + 1, c + 1);
    append(bytes, line);
  }
  return bytes;
}

std::vector<std::uint8_t> encode_pc2(const SampleSequence& sequence) {
  std::vector<std::uint8_t> bytes;
  append(bytes, std::string_view("POINTCACHE2\0", 12));
  append_word(bytes, 1);
  append_word(bytes, static_cast<std::uint32_t>(sequence.colors.size()));
  append_float(bytes, 0);
  append_float(bytes, 1);
  append_word(bytes, static_cast<std::uint32_t>(sequence.poses.size()));
  for (const std::vector<Vec3d>& pose : sequence.poses)
    for (const Vec3d& p : pose)
      for (std::size_t a = 0; a < 3; ++a) append_float(bytes, rounded(p[a]));
  return bytes;
}

}  // namespace mdk
