#include "preprocess/cli/depfile.h"

#include "common/base/error.h"

namespace mdk {
namespace {

std::string escaped(const std::string& name) {
  std::string text;
  std::size_t backslashes = 0;  // that end `text`: they double where they stand before an escape
  for (const char c : name) {
    if (c == '\n' || c == '\r')
      throw Error(ErrorCode::kUsage,
                  "--depfile: the name of a file has a line break, which no "
                  "depfile can hold; rename it");
    if (c == ' ' || c == '\t' || c == '#') text.append(backslashes + 1, '\\');
    if (c == '$') text += '$';
    text += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return text;
}

}  // namespace

std::string depfile_text(const std::string& target, std::span<const std::string> dependencies) {
  std::string text = escaped(target) + ":";
  for (const std::string& name : dependencies) text += " \\\n  " + escaped(name);
  return text + "\n";
}

}  // namespace mdk
