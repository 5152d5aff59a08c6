// Casts in JSON, mdk-scene/1. nlohmann-json cuts the text into words; who counts its characters
// knows where each value starts, so that every complaint can name the place. Instances are taken as
// they come, so that a million of them need no tree.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/files/mapped_file.h"
#include "formats/files/text.h"
#include "preprocess/casts/cast.h"

namespace mdk {
namespace {

constexpr const char* kSchema = "mdk-scene/1";
constexpr std::size_t kMaxDepth = 16;

struct Value {
  enum class Kind { kNull, kBool, kNumber, kText, kList, kObject };

  Kind kind = Kind::kNull;
  CastPlace place;
  double number = 0;
  std::optional<std::int64_t> whole;  ///< of a whole number
  std::string text;
  std::vector<Value> items;                              ///< of a list or an object
  std::vector<std::pair<std::string, CastPlace>> names;  ///< of an object's items

  const Value* find(std::string_view name) const {
    for (std::size_t i = 0; i < items.size(); ++i)  // the last name's item may be on its way
      if (names[i].first == name) return &items[i];
    return nullptr;
  }
};

/// Knows where the value that was read last began.
struct Cursor {
  CastPlace here{1, 1}, value;
  bool is_between = true;

  void pass(char c) {
    if (is_between && c != ' ' && c != '\t' && c != '\r' && c != '\n' && c != ',' && c != ':') {
      value = here;
      is_between = false;
    }
    if (c == '\n')
      here = {here.line + 1, 1};
    else if ((static_cast<unsigned char>(c) & 0xc0) != 0x80)
      ++here.column;
  }
};

/// Characters of a text, counted as they are passed.
class Characters {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Characters(const char* at, Cursor* cursor) : at_(at), cursor_(cursor) {}
  reference operator*() const { return *at_; }
  Characters& operator++() {
    cursor_->pass(*at_++);
    return *this;
  }
  Characters operator++(int) {
    const Characters before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Characters& other) const { return at_ == other.at_; }
  bool operator!=(const Characters& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  Cursor* cursor_;
};

class Reader {
 public:
  Reader(const std::string& file, SceneBuilder& scene) : file_(file), scene_(scene) {}

  void read(std::span<const std::byte> bytes) {
    const char* const text = reinterpret_cast<const char*>(bytes.data());
    nlohmann::json::sax_parse(Characters(text, &cursor_), Characters(text + bytes.size(), &cursor_),
                              this);
    finish();
  }

  // What the parser calls.
  bool null() { return take({}); }
  bool boolean(bool value) {
    Value v;
    v.kind = Value::Kind::kBool;
    v.number = value ? 1 : 0;
    return take(std::move(v));
  }
  bool number_integer(std::int64_t value) {
    return take(number(static_cast<double>(value), value));
  }
  bool number_unsigned(std::uint64_t value) {
    if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
      return take(number(static_cast<double>(value), {}));
    return take(number(static_cast<double>(value), static_cast<std::int64_t>(value)));
  }
  bool number_float(double value, const std::string&) { return take(number(value, {})); }
  bool string(std::string& text) {
    Value v;
    v.kind = Value::Kind::kText;
    v.text = std::move(text);
    return take(std::move(v));
  }
  bool binary(std::vector<std::uint8_t>&) { return false; }
  bool start_object(std::size_t) { return open(Value::Kind::kObject); }
  bool start_array(std::size_t) { return open(Value::Kind::kList); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    Value& object = open_.back();
    if (std::ranges::find(object.names, name, &std::pair<std::string, CastPlace>::first) !=
        object.names.end())
      refuse(started(), mdk::quoted(name) + " is there twice");
    object.names.emplace_back(std::move(name), started());
    return true;
  }
  bool parse_error(std::size_t, const std::string& token, const nlohmann::json::exception& error) {
    const bool is_range = error.id == 406;
    const CastPlace place = cursor_.is_between ? cursor_.here : cursor_.value;
    if (is_range) refuse(place, "a number is out of range");
    refuse(place,
           token.empty() ? "is no JSON from here" : "is no JSON from here, " + mdk::quoted(token));
  }

 private:
  [[noreturn]] void refuse(const CastPlace& place, const std::string& sentence) const {
    throw cast_error(file_, place, sentence);
  }

  static Value number(double value, std::optional<std::int64_t> whole) {
    Value v;
    v.kind = Value::Kind::kNumber;
    v.number = value;
    v.whole = whole;
    return v;
  }

  /// Where the word began that was just read.
  CastPlace started() {
    cursor_.is_between = true;
    return cursor_.value;
  }

  bool open(Value::Kind kind) {
    if (open_.size() >= kMaxDepth) refuse(started(), "is nested too deeply");
    Value v;
    v.kind = kind;
    v.place = started();
    open_.push_back(std::move(v));
    return true;
  }
  bool close() {
    started();
    Value v = std::move(open_.back());
    open_.pop_back();
    if (open_.empty()) {
      root_ = std::move(v);
      return true;
    }
    return put(std::move(v));
  }
  bool take(Value v) {
    v.place = started();
    if (open_.empty()) refuse(v.place, "must be an object, { … }");
    return put(std::move(v));
  }
  /// An instance is taken at once where the models are known.
  bool put(Value v) {
    Value &parent = open_.back(), &root = open_.front();
    if (open_.size() == 2 && parent.kind == Value::Kind::kList && !root.names.empty() &&
        root.names.back().first == "instances" && root.find("models") != nullptr) {
      read_models(*root.find("models"));
      read_instance(v);
      return true;
    }
    parent.items.push_back(std::move(v));
    return true;
  }

  void finish() {
    require_names(root_, {"schema", "models", "instances"});
    const Value* const schema = root_.find("schema");
    if (schema == nullptr || schema->text != kSchema)
      refuse(schema == nullptr ? root_.place : schema->place,
             "must say \"schema\": \"" + std::string(kSchema) + "\"");
    const Value* const models = root_.find("models");
    const Value* const instances = root_.find("instances");
    if (models == nullptr) refuse(root_.place, "has no \"models\", a list of files");
    if (instances == nullptr) refuse(root_.place, "has no \"instances\", a list");
    if (instances->kind != Value::Kind::kList) refuse(instances->place, "must be a list, [ … ]");
    read_models(*models);
    for (const Value& instance : instances->items) read_instance(instance);
  }

  void require_names(const Value& object, std::initializer_list<std::string_view> known) const {
    if (object.kind != Value::Kind::kObject) refuse(object.place, "must be an object, { … }");
    for (const auto& [name, place] : object.names) {
      if (std::ranges::find(known, name) != known.end()) continue;
      std::string names;
      for (const std::string_view one : known) names.append(names.empty() ? "" : ", ").append(one);
      refuse(place, mdk::quoted(name) + " is no field of this object; there are " + names);
    }
  }

  void read_models(const Value& list) {
    if (models_known_) return;
    models_known_ = true;
    if (list.kind != Value::Kind::kList || list.items.empty())
      refuse(list.place, "must be a list of at least one model, [{\"file\": \"a.mdk\"}]");
    for (const Value& item : list.items) {
      require_names(item, {"file"});
      const Value* const name = item.find("file");
      if (name == nullptr || name->kind != Value::Kind::kText || name->text.empty())
        refuse(item.place, "a model needs a \"file\": the name of a .mdk");
      models_.push_back(scene_.model_of_cast(file_, name->place, name->text));
    }
  }

  double real(const Value& value) const {
    if (value.kind != Value::Kind::kNumber) refuse(value.place, "must be a number");
    return value.number;
  }
  std::vector<double> reals(const Value& value, std::size_t count) const {
    if (value.kind != Value::Kind::kList || value.items.size() != count)
      refuse(value.place, "must be a list of " + std::to_string(count) + " numbers");
    std::vector<double> numbers;
    for (const Value& item : value.items) numbers.push_back(real(item));
    return numbers;
  }
  const std::string& text(const Value& value) const {
    if (value.kind != Value::Kind::kText) refuse(value.place, "must be a text");
    return value.text;
  }
  template <class T>
  T one_of(const Value& value, std::initializer_list<std::pair<std::string_view, T>> words) const {
    std::string known;
    for (const auto& [word, meaning] : words) {
      if (value.kind == Value::Kind::kText && value.text == word) return meaning;
      known.append(known.empty() ? "\"" : ", \"").append(word).append("\"");
    }
    refuse(value.place, "must be one of " + known);
  }

  /// position, orientation and scale, where they are given.
  PathKey transform(const Value& of) const {
    PathKey key;
    if (const Value* const v = of.find("position")) {
      const auto p = reals(*v, 3);
      key.translation = to_float(Vec3d{p[0], p[1], p[2]});
    }
    if (const Value* const v = of.find("orientation")) {
      const auto q = reals(*v, 4);
      const double size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (!(std::abs(size - 1) <= 0.01))
        refuse(v->place, "must be a unit quaternion, [x, y, z, w]");
      for (std::size_t i = 0; i < 4; ++i) key.rotation[i] = static_cast<float>(q[i] / size);
    }
    if (const Value* const v = of.find("scale")) {
      if (v->kind == Value::Kind::kNumber) {
        const auto s = static_cast<float>(v->number);
        key.scale = {s, s, s};
      } else {
        const auto s = reals(*v, 3);
        key.scale = to_float(Vec3d{s[0], s[1], s[2]});
      }
    }
    return key;
  }

  Affine3f map(const Value& of) const {
    const Value* const matrix = of.find("matrix");
    if (matrix == nullptr) return key_map(transform(of));
    for (const char* const other : {"position", "orientation", "scale"})
      if (const Value* const v = of.find(other))
        refuse(v->place, "\"matrix\" stands instead of it; leave one of them out");
    const auto m = reals(*matrix, 16);
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      refuse(matrix->place, "must have the last row 0 0 0 1: numbers 4, 8, 12 and 16");
    Affine3f map;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column)
        map.m[row][column] = static_cast<float>(m[4 * column + row]);
    return map;
  }

  std::uint32_t read_path(const Value& of, const Value& keys) {
    if (keys.kind != Value::Kind::kList || keys.items.empty())
      refuse(keys.place, "must be a list of at least one key");
    std::vector<PathKey> path;
    for (const Value& item : keys.items) {
      require_names(item, {"time", "position", "orientation", "scale"});
      const Value* const time = item.find("time");
      if (time == nullptr) refuse(item.place, "a key needs a \"time\" in seconds");
      PathKey key = transform(item);
      key.time = real(*time);
      path.push_back(key);
    }
    PathEnds ends = PathEnds::kHold;
    if (const Value* const v = of.find("path"))
      ends = one_of<PathEnds>(
          *v, {{"hold", PathEnds::kHold}, {"hide", PathEnds::kHide}, {"loop", PathEnds::kLoop}});
    std::uint32_t index = 0;
    const std::string fault = scene_.add_path(path, ends, index);
    if (!fault.empty()) refuse(keys.place, fault);
    return index;
  }

  void read_instance(const Value& value) {
    require_names(value, {"model", "position", "orientation", "scale", "matrix", "keys", "path",
                          "clip", "start", "speed", "wrap", "tint", "mask", "id"});
    Actor actor;
    const Value* const model = value.find("model");
    if (model == nullptr) refuse(value.place, "an instance needs a \"model\": its number");
    if (!model->whole || *model->whole < 0 ||
        static_cast<std::uint64_t>(*model->whole) >= models_.size())
      refuse(model->place,
             "must be the number of a model, 0 to " + std::to_string(models_.size() - 1));
    actor.model = models_[static_cast<std::size_t>(*model->whole)];
    actor.map = map(value);
    if (const Value* const v = value.find("keys"))
      actor.path = read_path(value, *v);
    else if (const Value* const ends = value.find("path"))
      refuse(ends->place, "says how a path ends, but there are no \"keys\"");
    if (const Value* const v = value.find("clip")) actor.clip = text(*v);
    if (const Value* const v = value.find("start")) actor.start = real(*v);
    if (const Value* const v = value.find("speed")) actor.speed = real(*v);
    if (const Value* const v = value.find("wrap"))
      actor.wrap = one_of<ClipWrap>(*v, {{"loop", ClipWrap::kLoop},
                                         {"once", ClipWrap::kOnce},
                                         {"ping-pong", ClipWrap::kPingPong}});
    if (const Value* const v = value.find("tint")) {
      actor.tint = 0xff000000;
      const auto rgb = reals(*v, 3);
      for (std::size_t i = 0; i < 3; ++i) {
        if (!(rgb[i] >= 0 && rgb[i] <= 1)) refuse(v->place, "must be three numbers from 0 to 1");
        actor.tint |= static_cast<std::uint32_t>(std::lround(rgb[i] * 255)) << (8 * i);
      }
    }
    if (const Value* const v = value.find("mask")) {
      if (!v->whole || *v->whole < 0 || *v->whole > 0xffffffff)
        refuse(v->place, "must be a whole number from 0 to 4294967295");
      actor.mask = static_cast<std::uint32_t>(*v->whole);
    }
    if (const Value* const v = value.find("id")) {
      if (!v->whole) refuse(v->place, "must be a whole number of 64 bits");
      actor.id = *v->whole;
    }
    if (const std::string fault = scene_.add(actor); !fault.empty()) refuse(value.place, fault);
  }

  std::string file_;
  SceneBuilder& scene_;
  Cursor cursor_;
  std::vector<Value> open_;
  Value root_;
  bool models_known_ = false;
  std::vector<std::uint32_t> models_;
};

}  // namespace

void read_json_cast(const std::string& file, SceneBuilder& scene) {
  const MappedFile text(file);
  Reader(file, scene).read(text.bytes());
}

}  // namespace mdk
