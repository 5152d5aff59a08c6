#include "formats/gltf/geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "common/base/error.h"
#include "formats/files/notes.h"
#include "formats/gltf/document.h"

namespace mdk::gltf {
namespace {

// What a small file may unfold to, in vertices: morph targets, or joint sets, may share an
// accessor.
constexpr std::size_t kMaxVertexCopies = std::size_t{1} << 30;

std::vector<Vec3f> as_vectors(const std::vector<float>& numbers) {
  std::vector<Vec3f> vectors(numbers.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
  return vectors;
}

/// Equal normals (with -0 equal to 0) give equal numbers, others almost surely different ones;
/// never 0.
std::uint64_t normal_group(const float* normal) {
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (int c = 0; c < 3; ++c) {
    hash = (hash ^ std::bit_cast<std::uint32_t>(normal[c] + 0.0f)) * 0xff51afd7ed558ccdu;
    hash ^= hash >> 33;
  }
  return hash | 1;
}

/// The index list of any triangle mode as triangles (glTF 2.0 §3.7.2.1). `corner(i)` is the i-th
/// index of `count`.
template <class Corner>
std::vector<Triangle> unroll(PrimitiveMode mode, std::size_t count, const Corner& corner) {
  std::vector<Triangle> triangles;
  if (count < 3) return triangles;
  if (mode == PrimitiveMode::kTriangles) {
    for (std::size_t i = 0; i + 2 < count; i += 3)
      triangles.push_back({{corner(i), corner(i + 1), corner(i + 2)}});
    return triangles;
  }
  for (std::size_t i = 0; i + 2 < count; ++i) {
    if (mode == PrimitiveMode::kStrip)
      triangles.push_back({{corner(i), corner(i + 1 + i % 2), corner(i + 2 - i % 2)}});
    else
      triangles.push_back({{corner(i + 1), corner(i + 2), corner(0)}});
  }
  return triangles;
}

class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, const Primitive& from, std::string place,
                  std::vector<std::string>& notes)
      : document_(document), from_(from), place_(std::move(place)), notes_(notes) {}

  PrimitiveGeometry read() {
    out_.material = from_.material;
    out_.positions = as_vectors(attribute(from_.positions, 3, "POSITION"));
    read_triangles();
    if (out_.triangles.empty()) return std::move(out_);
    read_normals();
    read_targets();
    if (!from_.joints.empty()) read_influences();
    read_texcoords();
    read_colors();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const {
    throw bad_input(document_.path, place_ + ": " + sentence);
  }

  void check_copies(std::size_t count, const std::string& what) const {
    if (count > kMaxVertexCopies / out_.positions.size())
      throw Error(ErrorCode::kOverLimit,
                  document_.path + ": " + place_ + " has too many " + what + " for its size");
  }

  void expect_vertex_count(const Accessor& a, const std::string& name) const {
    if (from_.positions != kNone && a.count != entry(document_.accessors, from_.positions).count)
      fail(name + " and POSITION differ in length");
  }

  std::vector<float> attribute(int accessor, int components, const std::string& name) const {
    expect_vertex_count(expect_components(document_, accessor, components, place_ + ": " + name),
                        name);
    return read_floats(document_, accessor);
  }

  void read_triangles() {
    const std::size_t vertices = out_.positions.size();
    if (vertices > 0xffffffffu) fail("has more vertices than can be counted");
    std::size_t corners = vertices;
    if (from_.indices == kNone) {
      out_.triangles =
          unroll(from_.mode, vertices, [](std::size_t i) { return static_cast<std::uint32_t>(i); });
    } else {
      expect_components(document_, from_.indices, 1, place_ + ": the index list");
      const std::vector<std::uint32_t> indices = read_unsigned(document_, from_.indices);
      for (std::uint32_t v : indices)
        if (v >= vertices)
          fail("refers to vertex " + std::to_string(v) + " of " + std::to_string(vertices));
      corners = indices.size();
      out_.triangles = unroll(from_.mode, corners, [&](std::size_t i) { return indices[i]; });
    }
    if (from_.mode == PrimitiveMode::kTriangles && corners % 3 != 0)
      add_note(notes_, place_ + " ends with an incomplete triangle, which is left out");
  }

  void read_normals() {
    out_.smoothing_groups.assign(out_.positions.size(), 0);
    if (from_.normals == kNone) return;
    const std::vector<float> normals = attribute(from_.normals, 3, "NORMAL");
    out_.has_normals = true;
    for (std::size_t i = 0; i < out_.positions.size(); ++i)
      out_.smoothing_groups[i] = normal_group(&normals[3 * i]);
  }

  void read_targets() {
    check_copies(from_.target_offsets.size(), "morph targets");
    for (int accessor : from_.target_offsets) {
      std::vector<Vec3f> offsets;
      if (accessor != kNone)
        offsets = as_vectors(attribute(accessor, 3, "the POSITION of a morph target"));
      if (std::ranges::all_of(offsets, [](const Vec3f& d) { return d == Vec3f{}; })) offsets = {};
      out_.target_offsets.push_back(std::move(offsets));
    }
  }

  void read_influences() {
    check_copies(4 * from_.joints.size(), "joint sets");
    std::vector<std::vector<std::uint32_t>> joints;
    std::vector<std::vector<float>> weights;
    for (std::size_t set = 0; set < from_.joints.size(); ++set) {
      const std::string name = "JOINTS_" + std::to_string(set);
      expect_vertex_count(expect_components(document_, from_.joints[set], 4, place_ + ": " + name),
                          name);
      joints.push_back(read_unsigned(document_, from_.joints[set]));
      weights.push_back(attribute(from_.weights[set], 4, "WEIGHTS_" + std::to_string(set)));
    }
    out_.first_influence.push_back(0);
    for (std::size_t i = 0; i < out_.positions.size(); ++i) {
      const std::size_t first = out_.influences.size();
      double sum = 0;
      for (std::size_t set = 0; set < joints.size(); ++set) {
        for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
          if (weights[set][k] < 0) fail("has a negative joint weight");
          if (weights[set][k] == 0) continue;
          out_.influences.push_back({joints[set][k], weights[set][k]});
          out_.joint_count = std::max(out_.joint_count, std::min(joints[set][k], 0xfffffffeu) + 1);
          sum += weights[set][k];
        }
      }
      for (std::size_t k = first; k < out_.influences.size(); ++k) out_.influences[k].weight /= sum;
      out_.first_influence.push_back(static_cast<std::uint32_t>(out_.influences.size()));
    }
  }

  void read_texcoords() {
    if (from_.material == kNone) return;
    const MaterialSource& m = entry(document_.materials, from_.material);
    const auto set = static_cast<std::size_t>(m.texcoord_set);
    if (m.image == kNone) return;
    if (set >= from_.texcoords.size()) {
      add_note(notes_,
               place_ + " has a texture but not its coordinates; its plain colour is shown");
      return;
    }
    const std::vector<float> uv =
        attribute(from_.texcoords[set], 2, "TEXCOORD_" + std::to_string(set));
    out_.texcoords.resize(out_.positions.size());
    for (std::size_t i = 0; i < out_.texcoords.size(); ++i) {
      const Vec3d p{uv[2 * i], uv[2 * i + 1], 1};
      const auto finite = [](double value) {
        const float f = static_cast<float>(value);
        return std::isfinite(f) ? f : 0.0f;
      };
      out_.texcoords[i] = {finite(dot(m.u_row, p)), finite(dot(m.v_row, p))};
    }
  }

  void read_colors() {
    if (from_.colors == kNone) return;
    const int components = entry(document_.accessors, from_.colors).components == 3 ? 3 : 4;
    const std::vector<float> values = attribute(from_.colors, components, "COLOR_0");
    const auto width = static_cast<std::size_t>(components);
    out_.colors.assign(out_.positions.size(), 0xffffffffu);
    for (std::size_t i = 0; i < out_.colors.size(); ++i) {
      std::uint32_t color = width == 3 ? 0xff000000u : 0u;
      for (std::size_t c = 0; c < width; ++c) {
        const float value = std::clamp(values[i * width + c], 0.0f, 1.0f);
        color |= static_cast<std::uint32_t>(std::lround(value * 255.0f)) << (8 * c);
      }
      out_.colors[i] = color;
    }
  }

  const Document& document_;
  const Primitive& from_;
  const std::string place_;
  std::vector<std::string>& notes_;
  PrimitiveGeometry out_;
};

}  // namespace

MeshGeometry read_mesh(const Document& document, int mesh, std::vector<std::string>& notes) {
  MeshGeometry geometry;
  const std::vector<Primitive>& primitives = entry(document.meshes, mesh).primitives;
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    const std::string place = "mesh " + std::to_string(mesh) + ", primitive " + std::to_string(p);
    if (primitives[p].mode < PrimitiveMode::kTriangles) {
      add_note(notes, "points and lines are left out");
    } else if (primitives[p].positions == kNone) {
      add_note(notes, place + " has no positions and is left out");
    } else {
      PrimitiveGeometry read = PrimitiveReader(document, primitives[p], place, notes).read();
      if (!read.triangles.empty()) geometry.primitives.push_back(std::move(read));
    }
  }
  return geometry;
}

}  // namespace mdk::gltf
