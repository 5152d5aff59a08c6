// Manual pages and shell completion, made from the description that --help is made from, so that
// they cannot tell anything else.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace mdk {

struct ManualPage {
  std::string name;  ///< "mdprep-bake.1"
  std::string text;  ///< for man
};

/// One for the program, and one for each subcommand.
std::vector<ManualPage> manual_pages(const CLI::App& app, const std::string& version);

/// For bash: subcommands, options, and the words an option takes where there are only so many. All
/// else is completed as the name of a file.
std::string bash_completion(const CLI::App& app);

}  // namespace mdk
