// What the validate() of every structure needs: which of its nodes, leaves or items have been
// linked to, and how deep they lie. Nodes are checked from the first to the last: the root is
// reached, and each node reaches its children. A node that is not reached when its turn comes has
// no link, or one that does not point forward; so there are no cycles.
#pragma once

#include <cassert>
#include <cstdint>
#include <string>
#include <vector>

namespace mdk {

class LinkCheck {
 public:
  /// Of `count` things; `thing` is what messages call one of them.
  LinkCheck(const char* thing, std::size_t count, std::uint32_t max_depth = 0)
      : thing_(thing), max_depth_(max_depth), depths_(count, kNotReached) {
    assert(max_depth < kNotReached);
  }

  bool is_reached(std::size_t i) const { return depths_[i] != kNotReached; }
  std::uint32_t depth(std::size_t i) const { return depths_[i]; }
  std::string name(std::size_t i) const { return thing_ + ' ' + std::to_string(i); }

  /// Notes a link to `i`. Returns what is wrong with it, or nothing.
  std::string reach(std::size_t i, std::uint32_t depth = 0) {
    if (i >= depths_.size()) return "it links to " + name(i) + ", which there is not";
    if (is_reached(i)) return "it is not the first to link to " + name(i);
    if (depth > max_depth_) return "it links to " + name(i) + ", which is too deep";
    depths_[i] = static_cast<std::uint8_t>(depth);
    return "";
  }

  /// What is wrong where something has no link, or nothing.
  std::string find_missing() const {
    for (std::size_t i = 0; i < depths_.size(); ++i)
      if (!is_reached(i)) return "nothing links to " + name(i);
    return "";
  }

 private:
  static constexpr std::uint8_t kNotReached = 0xff;

  std::string thing_;
  std::uint32_t max_depth_;
  std::vector<std::uint8_t> depths_;
};

}  // namespace mdk
