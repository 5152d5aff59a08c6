// mdprep_manual FOLDER: writes mdprep's manual pages and bash completion there, made from the
// description that --help is made from, so that they cannot tell anything else. Runs while the
// project is built, and is not installed.
#include <algorithm>
#include <cctype>
#include <iostream>

#include "preprocess/commands/command_line.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

struct TextFile {
  std::string name, text;
};

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

std::string option_entry(const Option& option) {
  std::string term = "\\fB" + roff(option.name()) + "\\fR";
  if (!option.takes.empty()) term += " \\fI" + roff(option.takes) + "\\fR";
  return ".TP\n" + term + "\n" + roff(option.help) + "\n";
}

std::string option_entries(const Command& command) {
  std::string text;
  for (const Option& option : command.described_options()) text += option_entry(option);
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
std::string whatis(const Command& command) {
  std::string text = command.summary();
  std::replace(text.begin(), text.end(), '\n', ' ');
  for (const char* end : {". ", ": ", "; "}) text = text.substr(0, text.find(end));
  if (text.ends_with('.')) text.pop_back();
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string synopsis(const Command& command, const std::string& program) {
  std::string text = "\\fB" + roff(program) + " " + roff(command.name()) + "\\fR";
  for (const Option& option : command.described_options())
    if (!option.has_name())
      text +=
          " \\fI" + roff(option.name()) + "\\fR" + (option.kind == OptionKind::kSome ? "..." : "");
  return text + " [\\fIoptions\\fR]";
}

/// A page for man.
TextFile page_of(const Command& mdprep, const Command& command, const std::string& version) {
  const std::string name = mdprep.name() + "-" + command.name();
  return {name + ".1", heading(name, version) +
                           section("NAME", roff(name) + " \\- " + roff(whatis(command))) +
                           section("SYNOPSIS", synopsis(command, mdprep.name())) +
                           section("DESCRIPTION", roff(command.summary())) +
                           section("OPTIONS", option_entries(command)) +
                           section("NOTES AND EXAMPLES", as_is(command.notes())) +
                           section("SEE ALSO", "\\fB" + mdprep.name() + "\\fR(1)")};
}

TextFile page_of_program(const Command& mdprep, const std::string& version) {
  std::string commands, see_also;
  for (const auto& command : mdprep.subcommands()) {
    commands += ".TP\n\\fB" + roff(command->name()) + "\\fR\n" + roff(command->summary()) + "\n";
    see_also.append(see_also.empty() ? "" : ", ").append("\\fB");
    see_also.append(roff(mdprep.name() + "-" + command->name())).append("\\fR(1)");
  }
  commands.pop_back();
  return {mdprep.name() + ".1",
          heading(mdprep.name(), version) +
              section("NAME", mdprep.name() +
                                  " \\- prepare animated meshes for ray tracing, render and "
                                  "measure them") +
              section("SYNOPSIS", "\\fB" + mdprep.name() + "\\fR \\fICOMMAND\\fR ...") +
              section("DESCRIPTION", roff(mdprep.summary())) + section("COMMANDS", commands) +
              section("OPTIONS", option_entries(mdprep)) + section("NOTES", as_is(mdprep.notes())) +
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

/// Long ones first.
std::vector<std::string> flags_of(const Option& option) {
  if (!option.has_name()) return {};
  std::vector<std::string> flags = split(option.names, ',');
  std::reverse(flags.begin(), flags.end());
  return flags;
}

/// Cases of "command option" with the words that may follow, and of "command" with its options.
struct CompletionCases {
  std::string values, options;

  /// Of a subcommand, or with "" of the program.
  void add(const std::string& name, const Command& command) {
    std::vector<std::string> all;
    for (const Option& option : command.described_options()) {
      const std::vector<std::string> flags = flags_of(option);
      all.insert(all.end(), flags.begin(), flags.end());
      if (flags.empty() || option.kind == OptionKind::kFlag) continue;
      std::string pattern;
      for (const std::string& flag : flags)
        pattern += (pattern.empty() ? "'" : " | '") + name + " " + flag + "'";
      const std::vector<std::string> words = words_of_type(option.takes);
      values += "    " + pattern + ")\n      " +
                (words.empty() ? ""
                               : "COMPREPLY=($(compgen -W '" + joined(words) +
                                     "' -- \"$current\"))\n      ") +
                "return ;;\n";
    }
    options += "    '" + name + "') options='" + joined(all) + "' ;;\n";
  }
};

/// For bash: subcommands, options, and the words an option takes where there are only so many. All
/// else is completed as the name of a file.
std::string bash_completion(const Command& mdprep) {
  CompletionCases cases;
  std::vector<std::string> names;
  std::string pattern;
  cases.add("", mdprep);
  for (const auto& command : mdprep.subcommands()) {
    names.push_back(command->name());
    pattern += (pattern.empty() ? "" : " | ") + command->name();
    cases.add(command->name(), *command);
  }
  const std::string& name = mdprep.name();
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

void write_manual(const std::string& folder) {
  const Command mdprep = mdprep_command();
  const std::string version = version_text(tool_version());
  std::vector<TextFile> files = {page_of_program(mdprep, version)};
  for (const auto& command : mdprep.subcommands())
    files.push_back(page_of(mdprep, *command, version));
  files.push_back({"mdprep.bash", bash_completion(mdprep)});
  for (const TextFile& file : files) write_text_file(folder + "/" + file.name, file.text);
}

}  // namespace
}  // namespace mdk

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: mdprep_manual FOLDER\n";
    return 2;
  }
  try {
    mdk::write_manual(argv[1]);
    return 0;
  } catch (...) {
    const mdk::Failure failure = mdk::describe_failure(std::current_exception());
    std::cerr << "mdprep_manual: " << failure.sentence << "\n";
    return failure.status;
  }
}
