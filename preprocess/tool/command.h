// Command: what a program or a subcommand takes, said once: the names of each option, what help
// tells of it, and how its text becomes a typed value. Parsing, --help, manual pages, completion
// and the text that tells two command lines apart all come from this description. CLI11 does the
// parsing, in command.cpp alone.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "formats/files/atomic_file.h"
#include "preprocess/tool/failure.h"

namespace mdk {

/// What a subcommand is told by whoever starts it, and what it tells back.
struct CommandContext {
  Interrupts& interrupts;
  Overwrite overwrite = Overwrite::kAlways;  ///< how to write outputs
  std::uint64_t options_hash = 0;            ///< of the options that shape the content of outputs

  // Filled in by bake, verify and render.
  std::vector<std::string> inputs = {};  ///< every file that was read
  std::vector<std::string> unread = {};  ///< files that would have been, could they be read: images
  std::vector<std::string> outputs = {};  ///< every file that was made, but for reports
  std::string report = {};                ///< JSON, or empty
};

enum class OptionKind {
  kFlag,
  kOne,      ///< takes a word
  kOneEach,  ///< takes a word each time it is given
  kTwo,      ///< takes two
  kSome,     ///< takes one or more
};

/// What depends on an option.
enum class OptionEffect {
  kValue,  ///< content: a number, say, in any spelling. A needless second run is cheap, a stale
           ///< result is not: so it is where nobody says otherwise
  kName,   ///< content: a name, so that "10" and "10.0" are two
  kFile,   ///< where results are found, or what is read: it names a file
  kNone,   ///< no result: machine and messages
};

struct Option {
  std::string names;  ///< "-o,--output"; or "FILE", for words without a name before them
  std::string takes;  ///< what follows the name, as help shows it: "all|N"
  std::string help;
  OptionKind kind = OptionKind::kOne;
  std::string standard = {};  ///< the text that counts where it is not given; empty: none does

  /// Is given each text, once all were parsed. Throws Error that says what is wrong with it.
  std::function<void(const std::string& text)> take = {};

  OptionEffect effect = OptionEffect::kValue;
  bool is_required = false;
  bool is_hidden = false;                  ///< not in help
  std::string needs = {};                  ///< an option that must be given with it
  std::vector<std::string> excludes = {};  ///< options that must not
  std::vector<std::string> given = {};     ///< texts on the command line

  Option& required() {
    is_required = true;
    return *this;
  }
  Option& with(OptionEffect what_depends) {
    effect = what_depends;
    return *this;
  }
  bool has_name() const { return names.starts_with('-'); }
  /// Given, or else the standard one.
  const std::string& text() const { return given.empty() ? standard : given.front(); }
  /// "--output", or "INPUT": the longest of its names.
  std::string name() const;
};

/// Which options count.
enum class OptionScope {
  kResults,  ///< all but those that no result depends on
  kContent,  ///< and but those that name files: what shapes the content of an output
};

class Command {
 public:
  Command(std::string name, std::string summary)
      : name_(std::move(name)), summary_(std::move(summary)) {}

  // Each adds an option, and returns it for what is special about it.
  Option& add_flag(const std::string& names, const std::string& help, bool& value);
  Option& add_text(const std::string& names, const std::string& takes, const std::string& help,
                   std::string& value);
  Option& add_texts(OptionKind kind, const std::string& names, const std::string& takes,
                    const std::string& help, std::vector<std::string>& values);
  /// parser(text) makes the value. It is called with `standard` where the option is not given,
  /// unless that is empty.
  template <class T, class Parse>
  Option& add_value(const std::string& names, const std::string& takes, const std::string& help,
                    const std::string& standard, T& value, Parse parser) {
    options_.push_back({names, takes, help, OptionKind::kOne, standard,
                        [&value, parser](const std::string& text) { value = parser(text); }});
    return options_.back();
  }

  /// The one of this name that was added before, if any.
  const Option* find_option(const std::string& name) const;
  Option& option(const std::string& name) { return const_cast<Option&>(*find_option(name)); }

  /// What must hold of all values together. Throws Error.
  void add_check(std::function<void()> check) { checks_.push_back(std::move(check)); }

  /// Notes and examples at the end of the help.
  void set_notes(std::string notes) { notes_ = std::move(notes); }
  /// What --version prints.
  void set_version(std::string version) { version_ = std::move(version); }
  /// What run() does.
  void set_body(std::function<void(CommandContext&)> body) { body_ = std::move(body); }

  /// One of the subcommands, of which a command line must name one. Lives as long as this.
  Command& add_subcommand(const std::string& name, const std::string& summary);

  /// Words after the program's name. Once. False where they only ask for help or the version, which
  /// goes to `out`. Throws Error: kUsage, or what a parser throws, with the option's name before
  /// it.
  bool parse(const std::vector<std::string>& words, std::ostream& out);

  /// The subcommand that was named; this one where there are none.
  const Command& chosen() const { return chosen_ == nullptr ? *this : *chosen_; }

  /// Runs what was parsed. Throws Error, or Interrupted after Ctrl-C.
  void run(CommandContext& context) const;

  const std::string& name() const { return name_; }
  const std::string& summary() const { return summary_; }
  const std::string& notes() const { return notes_; }
  /// With --help and --version first.
  std::vector<Option> described_options() const;
  const std::vector<std::unique_ptr<Command>>& subcommands() const { return subcommands_; }

  /// "clusters=12\nfps=24\n" once it was parsed: options that differ from their standard, by name,
  /// numbers in one spelling. Two command lines have one text exactly where they must have the same
  /// results.
  std::string options_text(OptionScope scope) const;

 private:
  friend class CommandParser;

  void take_values();

  std::string name_, summary_, notes_, version_;
  std::vector<Option> options_;
  std::vector<std::function<void()>> checks_;
  std::function<void(CommandContext&)> body_;
  std::vector<std::unique_ptr<Command>> subcommands_;
  const Command* chosen_ = nullptr;
};

}  // namespace mdk
