#include "formats/gltf/json.h"

#include <cstdint>
#include <limits>
#include <utility>

#include "common/base/error.h"
#include "common/base/text.h"

namespace mdk::gltf {
namespace {

constexpr int kMaxNesting = 256;
constexpr std::size_t kMaxInt = std::numeric_limits<std::int32_t>::max();

std::string quote(const std::string& key) { return "\"" + key + "\""; }

/// One pass over the characters, no recursion.
void check_nesting(const std::string& file, std::string_view json) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMaxNesting)
        throw bad_input(file, "the JSON is nested more than " + std::to_string(kMaxNesting) +
                                  " deep at byte " + std::to_string(i));
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

}  // namespace

Json parse_json(const std::string& file, std::string_view text) {
  check_nesting(file, text);
  try {
    return Json::parse(text.begin(), text.end());
  } catch (const Json::parse_error& e) {
    throw bad_input(file, "the JSON is broken at byte " + std::to_string(e.byte));
  } catch (const Json::exception&) {
    throw bad_input(file, "the JSON holds a number that is out of range");
  }
}

JsonObject::JsonObject(const std::string& file, const Json& root, std::string place,
                       const Json& value)
    : file_(file), root_(root), place_(std::move(place)), value_(value) {
  if (!value_.is_object()) fail("is not an object");
}

void JsonObject::fail(const std::string& sentence) const {
  throw bad_input(file_, printable_line(place_ + " " + sentence));
}

/// `what` is_right() asks for; null where the member is absent and may be.
const Json* JsonObject::member(const char* key, Need need, bool (Json::*is_right)() const noexcept,
                               const char* what) const {
  const auto it = value_.find(key);
  if (it == value_.end()) {
    if (need == Need::kRequired) fail("has no " + quote(key));
    return nullptr;
  }
  if (!((*it).*is_right)()) fail("has a " + quote(key) + " that is not " + what);
  return &*it;
}

std::string JsonObject::string(const char* key, Need need) const {
  const Json* m = member(key, need, &Json::is_string, "a string");
  return m ? m->get<std::string>() : std::string();
}

bool JsonObject::boolean(const char* key) const {
  const Json* m = member(key, Need::kOptional, &Json::is_boolean, "a boolean");
  return m && m->get<bool>();
}

void JsonObject::number(const char* key) const {
  member(key, Need::kOptional, &Json::is_number, "a number");
}

std::size_t JsonObject::size(const char* key, Need need) const {
  constexpr const char* kWhat = "a usable whole number";
  const Json* m = member(key, need, &Json::is_number_unsigned, kWhat);
  if (m && m->get<std::uint64_t>() > (std::uint64_t{1} << 53))
    fail("has a " + quote(key) + " that is not " + kWhat);
  return m ? m->get<std::size_t>() : 0;
}

void JsonObject::small_size(const char* key, Need need) const {
  if (size(key, need) > kMaxInt) fail("has a " + quote(key) + " that is too large");
}

bool JsonObject::is_small_size(const char* key) const {
  const Json& value = value_.at(key);
  return value.is_number_unsigned() && value.get<std::uint64_t>() <= kMaxInt;
}

int JsonObject::index_value(const Json& value, const std::string& key, const char* list) const {
  const auto it = root_.find(list);
  const std::size_t count = it != root_.end() && it->is_array() ? it->size() : 0;
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= count)
    fail("has a " + quote(key) + " of " + value.dump().substr(0, 40) + ", which is none of the " +
         std::to_string(count) + " " + list);
  return value.get<int>();
}

int JsonObject::index(const char* key, const char* list, Need need) const {
  const auto it = value_.find(key);
  if (it != value_.end()) return index_value(*it, key, list);
  if (need == Need::kRequired) fail("has no " + quote(key));
  return -1;
}

std::size_t JsonObject::indices(const char* key, const char* list, Need need) const {
  const Json* values = member(key, need, &Json::is_array, "a list");
  if (!values) return 0;
  for (const Json& value : *values) index_value(value, key, list);
  return values->size();
}

void JsonObject::numbers(const char* key, std::size_t count) const {
  const Json* values = member(key, Need::kOptional, &Json::is_array, "a list");
  if (!values) return;
  if (count != 0 && values->size() != count)
    fail("has a " + quote(key) + " without " + std::to_string(count) + " numbers");
  for (const Json& value : *values)
    if (!value.is_number()) fail("has a " + quote(key) + " holding something that is not a number");
}

JsonObject JsonObject::at(std::string place) const {
  return {file_, root_, std::move(place), value_};
}

std::optional<JsonObject> JsonObject::object(const char* key, Need need) const {
  const Json* m = member(key, need, &Json::is_object, "an object");
  if (!m) return std::nullopt;
  return JsonObject(file_, root_, place_, *m);
}

std::optional<JsonObject> JsonObject::extension(const char* name) const {
  const std::optional<JsonObject> all = object("extensions", Need::kOptional);
  return all ? all->object(name, Need::kOptional) : std::nullopt;
}

std::vector<JsonObject> JsonObject::objects(const char* key, const std::string& what,
                                            Need need) const {
  std::vector<JsonObject> all;
  if (const Json* list = member(key, need, &Json::is_array, "a list"))
    for (const Json& value : *list)
      all.emplace_back(file_, root_, what + " " + std::to_string(all.size()), value);
  return all;
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> all;
  for (const auto& [key, value] : value_.items()) all.push_back(key);
  return all;
}

std::vector<std::optional<std::string>> JsonObject::strings(const char* key) const {
  std::vector<std::optional<std::string>> all;
  if (const Json* list = member(key, Need::kOptional, &Json::is_array, "a list"))
    for (const Json& value : *list)
      all.push_back(value.is_string() ? std::optional(value.get<std::string>()) : std::nullopt);
  return all;
}

}  // namespace mdk::gltf
