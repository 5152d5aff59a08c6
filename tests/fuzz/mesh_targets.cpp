// Meshes of one pose: .obj and .ply, and materials: .mtl, from memory.
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "formats/mesh/materials.h"
#include "formats/mesh/triangle_mesh.h"
#include "tests/formats/ply_builder.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

std::string_view text_of(std::span<const unsigned char> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void require_sound(const MaterialUse& use, std::size_t triangles) {
  if (!use.triangles.empty() && use.triangles.size() != triangles)
    throw std::logic_error("read more or fewer materials than triangles");
  for (const std::uint32_t material : use.triangles)
    if (material >= use.names.size()) throw std::logic_error("read a material without name");
  if (!use.corners.empty() && use.corners.size() != 3 * triangles)
    throw std::logic_error("read more or fewer texture coordinates than corners");
  for (const TexCoord& corner : use.corners)
    if (!std::isfinite(corner.u) || !std::isfinite(corner.v))
      throw std::logic_error("read a texture coordinate that is not finite");
}

void require_sound(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw std::logic_error("read a mesh without triangles");
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle.v)
      if (corner >= mesh.vertices.size()) throw std::logic_error("read a corner without vertex");
  for (const Vec3f& vertex : mesh.vertices)
    for (std::size_t a = 0; a < 3; ++a)
      if (!std::isfinite(vertex[a])) throw std::logic_error("read a vertex that is not finite");
  if (!mesh.vertex_colors.empty() && mesh.vertex_colors.size() != mesh.vertices.size())
    throw std::logic_error("read more or fewer colours than vertices");
  require_sound(mesh.materials, mesh.triangles.size());
}

std::vector<Bytes> obj_seeds() {
  return {
      bytes_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
      bytes_of("# a square\nmtllib square.mtl\nv -1 -1 0 1 0 0\nv 1 -1 0 0 1 0\r\nv 1 1 0 0 0 1\n"
               "v -1 1e-3 0 1 1 1\nvt 0 0\nvn 0 0 1\nusemtl red\ns off\nf 1/1/1 2/1/1 3/1/1 "
               "4//1\n"),
      bytes_of("o late\nf 1 2 3\nv 0 0 0\n\tv 1.5 .5 +0\nv 0 1 \\\n 0\nf -3/1 2/2 -1/3\n")};
}

std::vector<Bytes> mtl_seeds() {
  return {
      bytes_of("# two\nnewmtl dark red\nKd 0.5 0 1e-3\nKs 1 1 1\nd 0.5\nnewmtl b\nKd 0.25\n"
               "map_Kd -o 0.5 0 0 -clamp on wood dark.png\nmap_Ks a.png\n")};
}

void require_sound(const MtlMaterial& material) {
  for (const float channel : material.material.base_color)
    if (!(channel >= 0 && channel <= 1)) throw std::logic_error("read a colour out of range");
}

std::string ply_header(const std::string& vertex_properties) {
  return "comment a square\nelement vertex 4\n" + vertex_properties +
         "element face 2\nproperty list uchar int vertex_indices\nproperty uchar flag\n"
         "element edge 1\nproperty short a\n";
}

Bytes ply_square(PlyEncoding encoding) {
  PlyBuilder ply(encoding, ply_header("property float x\nproperty double y\nproperty float z\n"
                                      "property uchar red\nproperty uchar green\n"
                                      "property uchar blue\n"));
  for (int i = 0; i < 4; ++i) {
    ply.number(static_cast<float>(i % 2)).number(static_cast<double>(i / 2)).number(0.5f);
    for (int c = 0; c < 3; ++c) ply.number(static_cast<std::uint8_t>(80 * c));
  }
  for (int face = 0; face < 2; ++face) {
    const int corners = 3 + face;
    ply.number(static_cast<std::uint8_t>(corners));
    for (int c = 0; c < corners; ++c) ply.number(c);
    ply.number(std::uint8_t{1});
  }
  ply.number(std::int16_t{7});
  return bytes_of(ply.file());
}

std::vector<Bytes> ply_seeds() {
  return {ply_square(PlyEncoding::kText), ply_square(PlyEncoding::kLittleEndian),
          ply_square(PlyEncoding::kBigEndian)};
}

}  // namespace

const FuzzTarget& obj_target() {
  static const FuzzTarget target = {
      "obj",
      [](std::span<const unsigned char> bytes) {
        require_sound(parse_obj("a.obj", text_of(bytes), ObjContent::kShapeAndMaterials));
      },
      obj_seeds};
  return target;
}

const FuzzTarget& mtl_target() {
  static const FuzzTarget target = {
      "mtl",
      [](std::span<const unsigned char> bytes) {
        std::vector<std::string> notes;
        for (const MtlMaterial& material : parse_mtl("a.mtl", text_of(bytes), notes))
          require_sound(material);
      },
      mtl_seeds};
  return target;
}

const FuzzTarget& ply_target() {
  static const FuzzTarget target = {"ply",
                                    [](std::span<const unsigned char> bytes) {
                                      require_sound(parse_ply("a.ply", text_of(bytes)));
                                    },
                                    ply_seeds};
  return target;
}

}  // namespace mdk::test
