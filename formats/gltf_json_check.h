// JsonCheck: reads one property after another of a glTF file's JSON, and says which one is wrong.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace mdk::gltf {

using Json = nlohmann::json;

enum class Need { kOptional, kRequired };

/// Every function takes the object `o`, its place ("accessor 3") for messages, and a property's
/// name, and throws Error (kBadInput) where the property is not what it must be.
class JsonCheck {
 public:
  /// Both must outlive this.
  JsonCheck(const std::string& file, const Json& root) : file_(file), root_(root) {}

  [[noreturn]] void fail(const std::string& place, const std::string& sentence) const;

  /// The member, or null where it is absent and may be.
  const Json* member(const Json& o, const std::string& at, const char* key, Need need) const;
  const Json* array(const Json& o, const std::string& at, const char* key, Need need) const;
  const Json* object(const Json& o, const std::string& at, const char* key, Need need) const;

  void string(const Json& o, const std::string& at, const char* key, Need need) const;
  void boolean(const Json& o, const std::string& at, const char* key) const;
  void number(const Json& o, const std::string& at, const char* key) const;

  /// A whole number in [0, 2^53]; 0 where it is absent.
  std::size_t size(const Json& o, const std::string& at, const char* key, Need need) const;
  /// A whole number that an int holds, because tinygltf keeps it in one.
  void small_size(const Json& o, const std::string& at, const char* key, Need need) const;

  /// Something that `value` numbers in the file's top-level `list`.
  void index_value(const Json& value, const std::string& at, const char* key,
                   const char* list) const;
  void index(const Json& o, const std::string& at, const char* key, const char* list,
             Need need) const;
  void indices(const Json& o, const std::string& at, const char* key, const char* list,
               Need need) const;

  /// A list of `count` numbers (0: any count).
  void numbers(const Json& o, const std::string& at, const char* key, std::size_t count) const;

  const Json& root() const { return root_; }

 private:
  const std::string& file_;
  const Json& root_;
};

}  // namespace mdk::gltf
