// What glTF files compress: Draco meshes and meshopt buffer views, without the file around them.
#include <numeric>
#include <stdexcept>
#include <utility>

#include "formats/gltf/compression.h"
#include "tests/formats/compressed_gltf.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

constexpr int kSide = 6;

gltf::Accessor accessor_of(std::size_t count, int components, gltf::ComponentType type) {
  gltf::Accessor accessor;
  accessor.count = count;
  accessor.components = components;
  accessor.type = type;
  return accessor;
}

/// The accessors are those of the grid that the seeds are.
void read_draco(std::span<const unsigned char> bytes) {
  const Grid grid(kSide);
  gltf::Document document;
  document.path = "a.glb";
  document.accessors = {accessor_of(grid.vertices(), 3, gltf::ComponentType::kFloat32),
                        accessor_of(grid.indices.size(), 1, gltf::ComponentType::kUint32)};
  gltf::DracoPrimitive primitive;
  primitive.indices = 1;
  primitive.attributes = {{0, 0}};
  gltf::decode_draco(primitive, bytes, document);
}

std::vector<Bytes> draco_seeds() {
  std::vector<Bytes> seeds;
#ifdef MDK_HAVE_DRACO
  for (const DracoMethod method : {DracoMethod::kSequential, DracoMethod::kEdgebreaker})
    seeds.push_back(bytes_of(draco_code(Grid(kSide), method)));
#endif
  return seeds;
}

constexpr std::size_t kHeadBytes = 3;

/// Three bytes choose mode, filter and stride, among those that a checked file may have.
gltf::MeshoptView view_of(std::span<const unsigned char> head) {
  gltf::MeshoptView view;
  view.mode = static_cast<gltf::MeshoptMode>(head[0] % 3);
  if (view.mode != gltf::MeshoptMode::kAttributes) {
    view.count = Grid(kSide).indices.size();
    view.stride = head[2] % 2 == 0 ? 2 : 4;
    return view;
  }
  view.count = Grid(kSide).vertices();
  view.filter = static_cast<gltf::MeshoptFilter>(head[1] % 4);
  view.stride = std::size_t{4} * (1 + head[2] % 64);
  if (view.filter == gltf::MeshoptFilter::kQuaternion) view.stride = 8;
  if (view.filter == gltf::MeshoptFilter::kOctahedral) view.stride = head[2] % 2 == 0 ? 4 : 8;
  return view;
}

void read_meshopt(std::span<const unsigned char> bytes) {
  if (bytes.size() < kHeadBytes) return;
  const gltf::MeshoptView view = view_of(bytes);
  const gltf::Bytes decoded = gltf::decode_meshopt(view, bytes.subspan(kHeadBytes));
  if (!decoded.empty() && decoded.size() != view.count * view.stride)
    throw std::logic_error("decoded a view of another size");
}

std::vector<Bytes> meshopt_seeds() {
  std::vector<Bytes> seeds;
#ifdef MDK_HAVE_MESHOPT
  const Grid grid(kSide);
  const auto add = [&](Bytes head, const Code& code) {
    head.insert(head.end(), code.begin(), code.end());
    seeds.push_back(std::move(head));
  };
  for (unsigned char filter = 0; filter < 4; ++filter) {
    const Bytes head = {0, filter, 2};
    const gltf::MeshoptView view = view_of(head);
    Bytes content(view.count * view.stride);
    std::iota(content.begin(), content.end(), std::uint8_t{0});
    add(head, vertex_code(content.data(), view.count, view.stride));
  }
  add({1, 0, 1}, triangle_code(grid.indices, grid.vertices()));
  add({2, 0, 0}, index_code(grid.indices, grid.vertices()));
#endif
  return seeds;
}

}  // namespace

const FuzzTarget& draco_target() {
  static const FuzzTarget target = {"draco", read_draco, draco_seeds};
  return target;
}

const FuzzTarget& meshopt_target() {
  static const FuzzTarget target = {"meshopt", read_meshopt, meshopt_seeds};
  return target;
}

}  // namespace mdk::test
