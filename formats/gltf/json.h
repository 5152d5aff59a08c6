// JsonObject: one object of a glTF file's JSON, whose properties are checked one after another:
// each has its type, an index points at something, and what is wrong is said with its place.
// Nesting is bounded before anything recursive sees the text.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mdk::gltf {

using Json = nlohmann::json;

enum class Need { kOptional, kRequired };

/// Throws Error (kBadInput) for broken JSON and where arrays and objects are nested deeper than any
/// honest file does. Cost: two passes over the characters.
Json parse_json(const std::string& file, std::string_view text);

/// Functions throw Error (kBadInput) where the property `key` is not what it must be, or is absent
/// and required.
class JsonObject {
 public:
  /// Throws Error (kBadInput) where the value is no object. `file` and `root`, the whole JSON, must
  /// outlive it. `place`: for messages ("accessor 3").
  JsonObject(const std::string& file, const Json& root, std::string place, const Json& value);

  [[noreturn]] void fail(const std::string& sentence) const;
  const std::string& place() const { return place_; }
  bool has(const char* key) const { return value_.contains(key); }

  std::string string(const char* key, Need need) const;  ///< empty where it is absent
  bool boolean(const char* key) const;                   ///< false where it is absent
  void number(const char* key) const;                    ///< where it is there

  /// A whole number in [0, 2^53]; 0 where it is absent.
  std::size_t size(const char* key, Need need) const;
  /// A whole number that an int holds, because tinygltf keeps it in one.
  void small_size(const char* key, Need need) const;
  /// Whether the property, which is there, is one.
  bool is_small_size(const char* key) const;

  /// What numbers an entry of the file's top-level `list`; -1 where it is absent.
  int index(const char* key, const char* list, Need need) const;
  /// How many such numbers there are.
  std::size_t indices(const char* key, const char* list, Need need) const;

  /// A list of `count` numbers (0: any count), where it is there.
  void numbers(const char* key, std::size_t count) const;

  /// The same object under another place.
  JsonObject at(std::string place) const;
  /// Its place is that of this object.
  std::optional<JsonObject> object(const char* key, Need need) const;
  std::optional<JsonObject> extension(const char* name) const;
  /// Their places: `what` and a number. None where the list is absent.
  std::vector<JsonObject> objects(const char* key, const std::string& what, Need need) const;

  std::vector<std::string> keys() const;
  /// The strings of a list; null for what is no string.
  std::vector<std::optional<std::string>> strings(const char* key) const;

 private:
  const Json* member(const char* key, Need need, bool (Json::*is_right)() const noexcept,
                     const char* what) const;
  int index_value(const Json& value, const std::string& key, const char* list) const;

  const std::string& file_;
  const Json& root_;
  std::string place_;
  const Json& value_;
};

}  // namespace mdk::gltf
