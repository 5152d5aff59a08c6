// ClusterVertices: which vertices belong to which cluster, so that a cluster can be posed alone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/motion/model.h"

namespace mdk {

/// Every vertex that a triangle uses is owned by the first cluster that uses it. Memory: O(runs of
/// vertices + pairs of clusters that touch).
class ClusterVertices {
 public:
  /// Cost: O(triangles).
  explicit ClusterVertices(const Model& model);

  /// The vertices that cluster `c` owns, as ascending ranges.
  std::span<const VertexRange> owned(std::uint32_t c) const { return owned_.of(c); }
  /// The clusters that own the corners of its triangles, itself among them where it owns any.
  std::span<const std::uint32_t> owners(std::uint32_t c) const { return owners_.of(c); }
  /// The clusters it shares a vertex with, itself included.
  std::span<const std::uint32_t> around(std::uint32_t c) const { return around_.of(c); }

 private:
  /// One list per cluster, one after another.
  template <class T>
  struct Lists {
    std::vector<std::uint32_t> first{0};
    std::vector<T> items;

    std::span<const T> of(std::uint32_t c) const {
      return std::span(items).subspan(first[c], first[c + 1] - first[c]);
    }
    void end_list() { first.push_back(static_cast<std::uint32_t>(items.size())); }
  };

  Lists<VertexRange> owned_;
  Lists<std::uint32_t> owners_, around_;
};

}  // namespace mdk
