// Casts as tables: a header that names the columns, an instance a line.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <utility>

#include "formats/files/mapped_file.h"
#include "formats/files/text.h"
#include "preprocess/casts/cast.h"

namespace mdk {
namespace {

constexpr std::array<std::string_view, 13> kColumns = {"model", "x",    "y",     "z",     "heading",
                                                       "scale", "clip", "start", "speed", "wrap",
                                                       "id",    "tint", "mask"};

struct Cell {
  std::string text;
  CastPlace place;
};

/// Cells of a line: separated by commas, in double quotes where they hold one.
class CellReader {
 public:
  CellReader(const std::string& file, std::string_view text) : file_(file), text_(text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    if (text_.starts_with(kMark)) at_ = kMark.size();
  }

  /// False at the end. Empty lines are passed over.
  bool next(std::vector<Cell>& cells) {
    cells.clear();
    while (at_ < text_.size() && (text_[at_] == '\n' || text_[at_] == '\r')) step();
    if (at_ >= text_.size()) return false;
    for (;;) {
      cells.push_back(read_cell());
      if (at_ >= text_.size() || text_[at_] != ',') return true;
      step();
    }
  }

 private:
  void step() {
    const char c = text_[at_++];
    if (c == '\n')
      here_ = {here_.line + 1, 1};
    else if ((static_cast<unsigned char>(c) & 0xc0) != 0x80)
      ++here_.column;
  }
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) step();
  }
  bool at_end_of_cell() const {
    return at_ >= text_.size() || text_[at_] == ',' || text_[at_] == '\n' || text_[at_] == '\r';
  }

  Cell read_cell() {
    skip_blanks();
    Cell cell{{}, here_};
    if (at_ < text_.size() && text_[at_] == '"') {
      step();
      for (;; step()) {
        if (at_ >= text_.size()) throw cast_error(file_, cell.place, "a quote is not closed");
        if (text_[at_] == '"') {
          step();
          if (at_ >= text_.size() || text_[at_] != '"') break;
        }
        cell.text += text_[at_];
      }
      skip_blanks();
      if (!at_end_of_cell()) throw cast_error(file_, here_, "something follows a quoted cell");
      return cell;
    }
    for (; !at_end_of_cell(); step()) cell.text += text_[at_];
    while (!cell.text.empty() && (cell.text.back() == ' ' || cell.text.back() == '\t'))
      cell.text.pop_back();
    return cell;
  }

  const std::string& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  CastPlace here_{1, 1};
};

class Reader {
 public:
  Reader(const std::string& file, const CastOptions& options, SceneBuilder& scene)
      : file_(file), options_(options), scene_(scene) {
    column_.fill(kNone);
  }

  void read(std::string_view text) {
    CellReader lines(file_, text);
    if (!lines.next(cells_)) throw cast_error(file_, {}, "is empty; its first line names columns");
    read_header();
    for (const std::string& model : options_.models) models_.push_back(scene_.model(model));
    while (lines.next(cells_)) {
      if (cells_.size() != count_)
        refuse(cells_.front().place, "has " + std::to_string(cells_.size()) + " cells, not " +
                                         std::to_string(count_) + " as the header");
      read_line();
    }
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  [[noreturn]] void refuse(const CastPlace& place, const std::string& sentence) const {
    throw cast_error(file_, place, sentence);
  }

  void read_header() {
    count_ = cells_.size();
    for (std::size_t i = 0; i < count_; ++i) {
      const auto found = std::ranges::find(kColumns, cells_[i].text);
      if (found == kColumns.end()) {
        std::string known;
        for (const std::string_view name : kColumns)
          known.append(known.empty() ? "" : ", ").append(name);
        refuse(cells_[i].place,
               "no column has the name " + mdk::quoted(cells_[i].text) + "; there are " + known);
      }
      std::size_t& column = column_[static_cast<std::size_t>(found - kColumns.begin())];
      if (column != kNone)
        refuse(cells_[i].place, "the column " + mdk::quoted(cells_[i].text) + " is there twice");
      column = i;
    }
    if (!has("model") && options_.models.empty())
      refuse(cells_.front().place, "has no column \"model\"; name it, or give --model");
  }

  std::size_t column(std::string_view name) const {
    return column_[static_cast<std::size_t>(std::ranges::find(kColumns, name) - kColumns.begin())];
  }
  bool has(std::string_view name) const { return column(name) != kNone; }
  /// Null where there is no such column, or the cell is empty.
  const Cell* cell(std::string_view name) const {
    const std::size_t at = column(name);
    return at == kNone || cells_[at].text.empty() ? nullptr : &cells_[at];
  }
  double number(std::string_view name, double standard) const {
    const Cell* const c = cell(name);
    if (c == nullptr) return standard;
    const auto value = parsed<double>(c->text);
    if (!value || !std::isfinite(*value))
      refuse(c->place, std::string(name) + " must be a number, not " + mdk::quoted(c->text));
    return *value;
  }

  std::uint32_t model() {
    const Cell* const c = cell("model");
    if (c == nullptr) {
      if (models_.empty()) refuse(cells_.front().place, "names no model, and there is no --model");
      return models_[scene_.instance_count() % models_.size()];
    }
    if (c->text != last_model_name_) {
      last_model_ = scene_.model_of_cast(file_, c->place, c->text);
      last_model_name_ = c->text;
    }
    return last_model_;
  }

  std::uint32_t tint(const Cell& c) const {
    const std::string& t = c.text;
    const bool is_color = t.size() == 7 && t[0] == '#' &&
                          t.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!is_color) refuse(c.place, "tint must be #rrggbb, not " + mdk::quoted(t));
    const auto value = static_cast<std::uint32_t>(std::stoul(t.substr(1), nullptr, 16));
    return 0xff000000 | (value & 0xff) << 16 | (value & 0xff00) | value >> 16;
  }

  void read_line() {
    Actor actor;
    actor.model = model();
    actor.map = upright_map({number("x", 0), number("y", 0), number("z", 0)},
                            number("heading", 0) * std::numbers::pi / 180,
                            number("scale", options_.scale), options_.up);
    if (const Cell* const c = cell("clip"))
      actor.clip = c->text;
    else if (!options_.clip.empty())
      actor.clip = options_.clip;
    actor.start = number("start", 0);
    actor.speed = number("speed", 1);
    if (const Cell* const c = cell("wrap")) {
      if (c->text == "once")
        actor.wrap = ClipWrap::kOnce;
      else if (c->text == "ping-pong")
        actor.wrap = ClipWrap::kPingPong;
      else if (c->text != "loop")
        refuse(c->place, "wrap must be loop, once or ping-pong, not " + mdk::quoted(c->text));
    }
    if (const Cell* const c = cell("id")) {
      actor.id = parsed<std::int64_t>(c->text);
      if (!actor.id)
        refuse(c->place, "id must be a whole number of 64 bits, not " + mdk::quoted(c->text));
    }
    if (const Cell* const c = cell("tint")) actor.tint = tint(*c);
    if (const Cell* const c = cell("mask")) {
      const auto mask = parsed<std::uint32_t>(c->text);
      if (!mask) refuse(c->place, "mask must be a whole number from 0 to 4294967295");
      actor.mask = *mask;
    }
    if (const std::string fault = scene_.add(actor); !fault.empty())
      refuse(cells_.front().place, fault);
  }

  const std::string& file_;
  const CastOptions& options_;
  SceneBuilder& scene_;
  std::array<std::size_t, kColumns.size()> column_;
  std::size_t count_ = 0;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> models_;
  std::string last_model_name_;
  std::uint32_t last_model_ = 0;
};

}  // namespace

void read_csv_cast(const std::string& file, const CastOptions& options, SceneBuilder& scene) {
  const MappedFile bytes(file);
  Reader(file, options, scene)
      .read({reinterpret_cast<const char*>(bytes.bytes().data()), bytes.bytes().size()});
}

}  // namespace mdk
