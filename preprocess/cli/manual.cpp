#include "preprocess/cli/manual.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

using Options = std::vector<const CLI::Option*>;
using Subcommands = std::vector<const CLI::App*>;

Subcommands subcommands_of(const CLI::App& app) { return app.get_subcommands({}); }
Options options_of(const CLI::App& app) { return app.get_options({}); }

/// Text between macros: nothing in it is one.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const bool at_line_start = result.empty() || result.back() == '\n';
    if (at_line_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result;
}

std::string section(const std::string& title, const std::string& body) {
  return body.empty() ? "" : ".SH " + title + "\n" + body + "\n";
}

/// Lines as they are, for examples.
std::string as_is(const std::string& text) {
  return text.empty() ? "" : ".nf\n" + roff(text) + "\n.fi";
}

std::string option_entry(const CLI::Option& option) {
  const bool is_positional = option.get_positional();
  std::string term = "\\fB" + roff(option.get_name(is_positional)) + "\\fR";
  if (option.get_type_size() > 0 && !option.get_type_name().empty() && !is_positional)
    term += " \\fI" + roff(option.get_type_name()) + "\\fR";
  return ".TP\n" + term + "\n" + roff(option.get_description()) + "\n";
}

std::string option_entries(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : options_of(app)) text += option_entry(*option);
  if (!text.empty()) text.pop_back();
  return text;
}

std::string heading(const std::string& name, const std::string& version) {
  std::string title = name;
  std::transform(title.begin(), title.end(), title.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return ".TH " + roff(title) + " 1 \"\" \"mdk " + version + "\" \"mdk\"\n";
}

/// The first sentence, in one line, for apropos.
std::string whatis(const CLI::App& app) {
  std::string text = app.get_description();
  std::replace(text.begin(), text.end(), '\n', ' ');
  text = text.substr(0, text.find_first_of(".:;"));
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string synopsis(const CLI::App& command, const std::string& program) {
  std::string text = "\\fB" + roff(program) + " " + roff(command.get_name()) + "\\fR";
  for (const CLI::Option* option : options_of(command))
    if (option->get_positional())
      text += " \\fI" + roff(option->get_name(true)) + "\\fR" +
              (option->get_expected_max() > 1 ? "..." : "");
  return text + " [\\fIoptions\\fR]";
}

ManualPage page_of(const CLI::App& app, const CLI::App& command, const std::string& version) {
  const std::string name = app.get_name() + "-" + command.get_name();
  return {name + ".1", heading(name, version) +
                           section("NAME", roff(name) + " \\- " + roff(whatis(command))) +
                           section("SYNOPSIS", synopsis(command, app.get_name())) +
                           section("DESCRIPTION", roff(command.get_description())) +
                           section("OPTIONS", option_entries(command)) +
                           section("NOTES AND EXAMPLES", as_is(command.get_footer())) +
                           section("SEE ALSO", "\\fB" + app.get_name() + "\\fR(1)")};
}

ManualPage page_of_program(const CLI::App& app, const std::string& version) {
  std::string commands, see_also;
  for (const CLI::App* command : subcommands_of(app)) {
    commands += ".TP\n\\fB" + roff(command->get_name()) + "\\fR\n" +
                roff(command->get_description()) + "\n";
    see_also.append(see_also.empty() ? "" : ", ").append("\\fB");
    see_also.append(roff(app.get_name() + "-" + command->get_name())).append("\\fR(1)");
  }
  commands.pop_back();
  return {
      app.get_name() + ".1",
      heading(app.get_name(), version) +
          section("NAME", app.get_name() + " \\- " +
                              "prepare animated meshes for ray tracing, render and measure them") +
          section("SYNOPSIS", "\\fB" + app.get_name() + "\\fR \\fICOMMAND\\fR ...") +
          section("DESCRIPTION", roff(app.get_description())) + section("COMMANDS", commands) +
          section("OPTIONS", option_entries(app)) + section("NOTES", as_is(app.get_footer())) +
          section("SEE ALSO", see_also)};
}

/// "cycle|pose-space": {"cycle", "pose-space"}. A part in capitals stands for something: no word.
std::vector<std::string> words_of_type(const std::string& type) {
  std::vector<std::string> words;
  for (const std::string& word : split(type, '|')) {
    const auto fits = [](unsigned char c) {
      return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-';
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), fits)) words.push_back(word);
  }
  return words;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::vector<std::string> flags_of(const CLI::Option& option) {
  std::vector<std::string> flags;
  for (const std::string& name : option.get_lnames()) flags.push_back("--" + name);
  for (const std::string& name : option.get_snames()) flags.push_back("-" + name);
  return flags;
}

/// Cases of "command option" with the words that may follow, and of "command" with its options.
struct CompletionCases {
  std::string values, options;

  void add(const std::string& command, const CLI::App& app) {
    std::vector<std::string> all;
    for (const CLI::Option* option : options_of(app)) {
      const std::vector<std::string> flags = flags_of(*option);
      all.insert(all.end(), flags.begin(), flags.end());
      if (flags.empty() || option->get_type_size() == 0) continue;
      std::string pattern;
      for (const std::string& flag : flags)
        pattern += (pattern.empty() ? "'" : " | '") + command + " " + flag + "'";
      const std::vector<std::string> words = words_of_type(option->get_type_name());
      values += "    " + pattern + ")\n      " +
                (words.empty() ? ""
                               : "COMPREPLY=($(compgen -W '" + joined(words) +
                                     "' -- \"$current\"))\n      ") +
                "return ;;\n";
    }
    options += "    '" + command + "') options='" + joined(all) + "' ;;\n";
  }
};

}  // namespace

std::vector<ManualPage> manual_pages(const CLI::App& app, const std::string& version) {
  std::vector<ManualPage> pages = {page_of_program(app, version)};
  for (const CLI::App* command : subcommands_of(app))
    pages.push_back(page_of(app, *command, version));
  return pages;
}

std::string bash_completion(const CLI::App& app) {
  CompletionCases cases;
  std::vector<std::string> names;
  std::string pattern;
  cases.add("", app);
  for (const CLI::App* command : subcommands_of(app)) {
    names.push_back(command->get_name());
    pattern += (pattern.empty() ? "" : " | ") + command->get_name();
    cases.add(command->get_name(), *command);
  }
  const std::string& name = app.get_name();
  return "# Completion for " + name + " in bash.\n_" + name +
         "() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  local command= options= i\n"
         "  if [[ $current == '=' ]]; then current=; previous='='; fi  # --option=value is three "
         "words\n"
         "  if [[ $previous == '=' ]]; then\n"
         "    for ((i = COMP_CWORD; i > 1; --i)); do\n"
         "      if [[ ${COMP_WORDS[i]} == '=' ]]; then previous=${COMP_WORDS[i - 1]}; break; fi\n"
         "    done\n"
         "  fi\n"
         "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
         "    case ${COMP_WORDS[i]} in\n"
         "    " +
         pattern +
         ") command=${COMP_WORDS[i]}; break ;;\n"
         "    esac\n"
         "  done\n"
         "  COMPREPLY=()\n"
         "  case \"$command $previous\" in\n" +
         cases.values +
         "  esac\n"
         "  case $command in\n" +
         cases.options +
         "  esac\n"
         "  if [[ $current == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "  elif [[ -z $command ]]; then\n"
         "    COMPREPLY=($(compgen -W '" +
         joined(names) +
         "' -- \"$current\"))\n"
         "  fi\n"
         "}\n"
         "complete -o default -F _" +
         name + " " + name + "\n";
}

}  // namespace mdk
