#include "tests/assets/glb_content.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace mdk {
namespace {

constexpr std::size_t kHeader = 12, kChunkHeader = 8;

template <class T>
T load(const std::vector<std::uint8_t>& bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T))
    throw std::runtime_error("a number lies outside the file");
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

std::vector<std::uint8_t> chunk(const std::vector<std::uint8_t>& file, std::size_t& offset,
                                std::uint32_t type) {
  const std::size_t size = load<std::uint32_t>(file, offset);
  if (load<std::uint32_t>(file, offset + 4) != type) throw std::runtime_error("wrong chunk type");
  offset += kChunkHeader;
  if (size % 4 != 0 || file.size() - offset < size) throw std::runtime_error("wrong chunk size");
  const auto begin = file.begin() + static_cast<std::ptrdiff_t>(offset);
  offset += size;
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

std::size_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 16;
}

/// The description without the bounds, which are floats and follow from the numbers.
nlohmann::json structure(const GlbContent& glb) {
  nlohmann::json json = glb.json;
  for (auto& accessor : json["accessors"]) {
    accessor.erase("min");
    accessor.erase("max");
  }
  return json;
}

double tolerance(const nlohmann::json& accessor) {
  if (accessor.at("componentType") == 5126) return 1e-4;
  return accessor.value("normalized", false) ? 2 : 0;
}

}  // namespace

std::vector<double> GlbContent::numbers(std::size_t accessor) const {
  const auto& a = json.at("accessors").at(accessor);
  const auto& view = json.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
  const std::size_t offset = view.at("byteOffset");
  const std::size_t count =
      a.at("count").get<std::size_t>() * component_count(a.at("type").get<std::string>());
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) switch (a.at("componentType").get<int>()) {
      case 5121:
        out.push_back(load<std::uint8_t>(buffer, offset + i));
        break;
      case 5123:
        out.push_back(load<std::uint16_t>(buffer, offset + 2 * i));
        break;
      case 5125:
        out.push_back(load<std::uint32_t>(buffer, offset + 4 * i));
        break;
      default:
        out.push_back(load<float>(buffer, offset + 4 * i));
    }
  return out;
}

std::vector<double> GlbContent::attribute(const std::string& name) const {
  return numbers(primitive().at("attributes").at(name).get<std::size_t>());
}

std::vector<double> GlbContent::indices() const {
  return numbers(primitive().at("indices").get<std::size_t>());
}

std::string difference(const GlbContent& a, const GlbContent& b) {
  if (structure(a) != structure(b)) return "the descriptions differ";
  for (std::size_t i = 0; i < a.json["accessors"].size(); ++i) {
    const double allowed = tolerance(a.json["accessors"][i]);
    const auto x = a.numbers(i), y = b.numbers(i);
    for (std::size_t k = 0; k < x.size(); ++k)
      if (std::abs(x[k] - y[k]) > allowed)
        return "accessor " + std::to_string(i) + ", number " + std::to_string(k) + ": " +
               std::to_string(x[k]) + " and " + std::to_string(y[k]);
  }
  return {};
}

GlbContent parse_glb(const std::vector<std::uint8_t>& file) {
  if (load<std::uint32_t>(file, 0) != 0x46546c67 || load<std::uint32_t>(file, 4) != 2 ||
      load<std::uint32_t>(file, 8) != file.size())
    throw std::runtime_error("wrong header");
  std::size_t offset = kHeader;
  const std::vector<std::uint8_t> text = chunk(file, offset, 0x4e4f534a);
  GlbContent content;
  content.json = nlohmann::json::parse(text.begin(), text.end());
  content.buffer = chunk(file, offset, 0x004e4942);
  return content;
}

std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + " cannot be read");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace mdk
