// OptionText: the options of a command as text that tells two command lines apart exactly where
// they may have different results.
#pragma once

#include <map>
#include <string>

namespace CLI {
class App;
}

namespace mdk {

/// Which options count.
enum class OptionScope {
  kResults,  ///< all but those of machine and messages, which no result depends on
  kContent,  ///< and but those that name files: what shapes the content of an output
};

class OptionText {
 public:
  /// Notes the values `command` has before it is parsed. Make it once all options were added.
  explicit OptionText(CLI::App& command);

  /// "clusters=12\nfps=24\n" once the command was parsed: options that differ from what they are by
  /// default, by name, numbers in one spelling.
  std::string text(OptionScope scope) const;

 private:
  const CLI::App* command_;
  std::map<std::string, std::string> defaults_;
};

}  // namespace mdk
