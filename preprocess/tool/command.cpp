#include "preprocess/tool/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <list>
#include <map>
#include <span>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr const char* kHelpNames = "-h,--help";
constexpr const char* kHelpText = "Print this and exit.";
constexpr const char* kVersionText = "Print the version and exit.";

/// "30.0" and "3e1" become "30"; other words stay.
std::string one_spelling(const std::string& word) {
  double value = 0;
  return read_real(word, value) ? shortest_text(value) : word;
}

std::string value_text(const Option& option, const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += "\n ";
    text += option.effect == OptionEffect::kValue ? one_spelling(word) : word;
  }
  return text;
}

}  // namespace

std::string Option::name() const { return split(names, ',').back(); }

Option& Command::add_flag(const std::string& names, const std::string& help, bool& value) {
  options_.push_back(
      {names, "", help, OptionKind::kFlag, "", [&value](const std::string&) { value = true; }});
  return options_.back();
}

Option& Command::add_text(const std::string& names, const std::string& takes,
                          const std::string& help, std::string& value) {
  return add_value(names, takes, help, "", value, [](const std::string& text) { return text; });
}

Option& Command::add_texts(OptionKind kind, const std::string& names, const std::string& takes,
                           const std::string& help, std::vector<std::string>& values) {
  options_.push_back({names, takes, help, kind, "",
                      [&values](const std::string& text) { values.push_back(text); }});
  return options_.back();
}

Command& Command::add_subcommand(const std::string& name, const std::string& summary) {
  return *subcommands_.emplace_back(std::make_unique<Command>(name, summary));
}

/// Tells CLI11 what a command takes, and the command what CLI11 found.
class CommandParser {
 public:
  CommandParser(Command& command, CLI::App& app) : command_(command), app_(app) {
    app.set_help_flag(kHelpNames, kHelpText);
    app.footer(command.notes_);
    if (!command.version_.empty())
      app.set_version_flag("--version", command.version_)->description(kVersionText);
    for (const Option& option : command.options_) found_.push_back(add(option));
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const Option& option = command.options_[i];
      if (!option.needs.empty()) found_[i]->needs(app.get_option(option.needs));
      for (const std::string& other : option.excludes) found_[i]->excludes(app.get_option(other));
    }
    if (!command.subcommands_.empty()) app.require_subcommand(1);
    for (const auto& subcommand : command.subcommands_)
      below_.emplace_back(*subcommand,
                          *app.add_subcommand(subcommand->name_, subcommand->summary_));
  }

  bool parse(const std::vector<std::string>& words, std::ostream& out) {
    try {
      app_.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    } catch (const CLI::ParseError& problem) {
      if (problem.get_exit_code() != 0) throw Error(ErrorCode::kUsage, sentence(problem.what()));
      app_.exit(problem, out, out);
      return false;
    }
    keep_words();
    for (CommandParser& parser : below_) {
      if (!parser.app_.parsed()) continue;
      parser.keep_words();
      command_.chosen_ = &parser.command_;
    }
    return true;
  }

 private:
  CLI::Option* add(const Option& option) {
    CLI::Option* added = nullptr;
    if (option.kind == OptionKind::kFlag) {
      added = app_.add_flag(option.names, flag_, option.help);
    } else if (option.kind == OptionKind::kOne) {
      added = app_.add_option(option.names, word_, option.help)->type_name(option.takes);
    } else {
      added = app_.add_option(option.names, words_, option.help)->type_name(option.takes);
      if (option.kind == OptionKind::kTwo) added->expected(2);
      if (option.kind == OptionKind::kSome) added->expected(1, -1);
      if (option.kind == OptionKind::kOneEach) added->allow_extra_args(false);
    }
    if (option.is_required) added->required();
    if (option.is_hidden) added->group("");
    return added;
  }

  void keep_words() {
    for (std::size_t i = 0; i < found_.size(); ++i)
      if (found_[i]->count() > 0) command_.options_[i].given = found_[i]->results();
  }

  /// CLI11's sentence with what to do about it.
  std::string sentence(std::string problem) const {
    std::replace(problem.begin(), problem.end(), '\n', ' ');
    const auto chosen = app_.get_subcommands();
    const std::string command = chosen.empty() ? "" : " " + chosen.front()->get_name();
    return problem + "; see '" + app_.get_name() + command + " --help'";
  }

  Command& command_;
  CLI::App& app_;
  std::vector<CLI::Option*> found_;  ///< one for each of the command's options
  std::list<CommandParser> below_;

  // What CLI11 writes to; options keep the texts themselves.
  bool flag_ = false;
  std::string word_;
  std::vector<std::string> words_;
};

bool Command::parse(const std::vector<std::string>& words, std::ostream& out) {
  CLI::App app{summary_, name_};
  if (!CommandParser(*this, app).parse(words, out)) return false;
  take_values();
  return true;
}

void Command::take_values() {
  for (const Option& option : options_) {
    std::vector<std::string> texts = option.given;
    if (texts.empty() && !option.standard.empty()) texts = {option.standard};
    for (const std::string& text : texts)
      with_name(option.name() + " " + text, [&] { option.take(text); });
  }
  for (const auto& check : checks_) check();
  for (const auto& subcommand : subcommands_)
    if (subcommand.get() == chosen_) subcommand->take_values();
}

void Command::run(CommandContext& context) const {
  const std::string content = chosen().options_text(OptionScope::kContent);
  context.options_hash = checksum_of(std::as_bytes(std::span(content)));
  chosen().body_(context);
}

std::vector<Option> Command::described_options() const {
  std::vector<Option> described = {{kHelpNames, "", kHelpText, OptionKind::kFlag}};
  if (!version_.empty()) described.push_back({"--version", "", kVersionText, OptionKind::kFlag});
  described.insert(described.end(), options_.begin(), options_.end());
  return described;
}

const Option* Command::find_option(const std::string& name) const {
  const auto found = std::find_if(options_.begin(), options_.end(),
                                  [&](const Option& option) { return option.name() == name; });
  return found == options_.end() ? nullptr : &*found;
}

std::string Command::options_text(OptionScope scope) const {
  std::map<std::string, std::string> lines;
  for (const Option& option : options_) {
    const bool counts = option.effect != OptionEffect::kNone &&
                        (scope == OptionScope::kResults || option.effect != OptionEffect::kFile);
    if (option.given.empty() || !counts) continue;
    const std::string value = value_text(option, option.given);
    std::string name = option.name();
    name.erase(0, name.find_first_not_of('-'));
    if (value != value_text(option, {option.standard})) lines[name] = value;
  }
  std::string text;
  for (const auto& [name, value] : lines) text += name + "=" + value + "\n";
  return text;
}

}  // namespace mdk
