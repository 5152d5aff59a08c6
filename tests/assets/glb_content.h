// Reads back what a .glb file holds, number by number, without the project's own reader.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mdk {

struct GlbContent {
  nlohmann::json json;
  std::vector<std::uint8_t> buffer;

  /// The numbers of an accessor as stored, one after another.
  std::vector<double> numbers(std::size_t accessor) const;
  /// Those of an attribute of the first mesh, "POSITION".
  std::vector<double> attribute(const std::string& name) const;
  std::vector<double> indices() const;
  const nlohmann::json& primitive() const { return json["meshes"][0]["primitives"][0]; }
};

/// What is different in `b`, in words; empty where both hold the same. Whole numbers must be equal,
/// normalised ones within two steps, floats within 1e-4: mathematical libraries round differently.
std::string difference(const GlbContent& a, const GlbContent& b);

/// Throws where the container is not a well-formed version 2 file.
GlbContent parse_glb(const std::vector<std::uint8_t>& file);
std::vector<std::uint8_t> read_bytes(const std::string& path);

}  // namespace mdk
