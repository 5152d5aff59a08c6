#include "formats/gltf_json_check.h"

#include <cstdint>
#include <limits>

#include "common/base/error.h"
#include "common/base/text.h"

namespace mdk::gltf {

void JsonCheck::fail(const std::string& place, const std::string& sentence) const {
  throw bad_input(file_, printable_line(place + " " + sentence));
}

const Json* JsonCheck::member(const Json& o, const std::string& at, const char* key,
                              Need need) const {
  const auto it = o.find(key);
  if (it != o.end()) return &*it;
  if (need == Need::kRequired) fail(at, "has no \"" + std::string(key) + "\"");
  return nullptr;
}

const Json* JsonCheck::array(const Json& o, const std::string& at, const char* key,
                             Need need) const {
  const Json* a = member(o, at, key, need);
  if (a && !a->is_array()) fail(at, "has a \"" + std::string(key) + "\" that is not a list");
  return a;
}

const Json* JsonCheck::object(const Json& o, const std::string& at, const char* key,
                              Need need) const {
  const Json* m = member(o, at, key, need);
  if (m && !m->is_object()) fail(at, "has a \"" + std::string(key) + "\" that is not an object");
  return m;
}

void JsonCheck::string(const Json& o, const std::string& at, const char* key, Need need) const {
  const Json* m = member(o, at, key, need);
  if (m && !m->is_string()) fail(at, "has a \"" + std::string(key) + "\" that is not a string");
}

void JsonCheck::boolean(const Json& o, const std::string& at, const char* key) const {
  const Json* m = member(o, at, key, Need::kOptional);
  if (m && !m->is_boolean()) fail(at, "has a \"" + std::string(key) + "\" that is not a boolean");
}

void JsonCheck::number(const Json& o, const std::string& at, const char* key) const {
  const Json* m = member(o, at, key, Need::kOptional);
  if (m && !m->is_number()) fail(at, "has a \"" + std::string(key) + "\" that is not a number");
}

std::size_t JsonCheck::size(const Json& o, const std::string& at, const char* key,
                            Need need) const {
  const Json* m = member(o, at, key, need);
  if (!m) return 0;
  if (!m->is_number_unsigned() || m->get<std::uint64_t>() > (std::uint64_t{1} << 53))
    fail(at, "has a \"" + std::string(key) + "\" that is not a usable whole number");
  return m->get<std::size_t>();
}

void JsonCheck::small_size(const Json& o, const std::string& at, const char* key, Need need) const {
  if (size(o, at, key, need) > std::size_t{std::numeric_limits<std::int32_t>::max()})
    fail(at, "has a \"" + std::string(key) + "\" that is too large");
}

void JsonCheck::index_value(const Json& value, const std::string& at, const char* key,
                            const char* list) const {
  const auto it = root_.find(list);
  const std::size_t count = it != root_.end() && it->is_array() ? it->size() : 0;
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
    fail(at, "has a \"" + std::string(key) + "\" of " + value.dump().substr(0, 40) +
                 ", which is none of the " + std::to_string(count) + " " + list);
}

void JsonCheck::index(const Json& o, const std::string& at, const char* key, const char* list,
                      Need need) const {
  if (const Json* m = member(o, at, key, need)) index_value(*m, at, key, list);
}

void JsonCheck::indices(const Json& o, const std::string& at, const char* key, const char* list,
                        Need need) const {
  if (const Json* a = array(o, at, key, need))
    for (const Json& value : *a) index_value(value, at, key, list);
}

void JsonCheck::numbers(const Json& o, const std::string& at, const char* key,
                        std::size_t count) const {
  const Json* a = array(o, at, key, Need::kOptional);
  if (!a) return;
  if (count != 0 && a->size() != count)
    fail(at, "has a \"" + std::string(key) + "\" without " + std::to_string(count) + " numbers");
  for (const Json& value : *a)
    if (!value.is_number())
      fail(at, "has a \"" + std::string(key) + "\" holding something that is not a number");
}

}  // namespace mdk::gltf
