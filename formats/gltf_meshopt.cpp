#include "formats/gltf_meshopt.h"

#ifdef MDK_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif

namespace mdk::gltf {

#ifdef MDK_HAVE_MESHOPT

bool can_decode_meshopt() { return true; }

Bytes decode_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed) {
  Bytes bytes(view.count * view.stride);
  const auto decode = [&] {
    switch (view.mode) {
      case MeshoptMode::kAttributes:
        return meshopt_decodeVertexBuffer(bytes.data(), view.count, view.stride, compressed.data(),
                                          compressed.size());
      case MeshoptMode::kTriangles:
        return meshopt_decodeIndexBuffer(bytes.data(), view.count, view.stride, compressed.data(),
                                         compressed.size());
      default:
        return meshopt_decodeIndexSequence(bytes.data(), view.count, view.stride, compressed.data(),
                                           compressed.size());
    }
  };
  if (decode() != 0) return {};
  if (view.filter == MeshoptFilter::kOctahedral)
    meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  if (view.filter == MeshoptFilter::kQuaternion)
    meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  if (view.filter == MeshoptFilter::kExponential)
    meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
  return bytes;
}

#else

bool can_decode_meshopt() { return false; }

Bytes decode_meshopt(const MeshoptView&, std::span<const unsigned char>) { return {}; }

#endif

}  // namespace mdk::gltf
