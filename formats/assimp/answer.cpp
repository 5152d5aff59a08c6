#include "formats/assimp/answer.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr std::string_view kFirstLine = "mdk-assimp 1";
constexpr std::string_view kLastLine = "glb";

void append_line(std::string& text, std::string_view word, std::string_view rest) {
  text.append(word).append(1, ' ');
  for (const char c : rest) text.push_back(c == '\n' ? ' ' : c);
  text.push_back('\n');
}

void write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      throw Error(ErrorCode::kIo,
                  std::string("the answer cannot be written: ") + std::strerror(errno));
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

void write_assimp_answer(const AssimpAnswer& answer, int file) {
  std::string text(kFirstLine);
  text.push_back('\n');
  append_line(text, "version", answer.version);
  for (const std::string& path : answer.files) append_line(text, "read", path);
  for (const std::string& note : answer.notes) append_line(text, "note", note);
  text.append(kLastLine).push_back('\n');
  write_all(file, text);
  write_all(file, {reinterpret_cast<const char*>(answer.glb.data()), answer.glb.size()});
}

AssimpAnswer parse_assimp_answer(std::span<const unsigned char> bytes) {
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  AssimpAnswer answer;
  for (bool is_first = true;; is_first = false) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    if (end == rest.npos || (is_first && line != kFirstLine))
      throw Error(ErrorCode::kInternal,
                  std::string(kAssimpProgram) + " gave no answer; install it again with mdprep");
    rest.remove_prefix(end + 1);
    if (line == kLastLine) break;
    const std::size_t blank = std::min(line.find(' '), line.size());
    const std::string_view word = line.substr(0, blank);
    const std::string text(line.substr(std::min(blank + 1, line.size())));
    if (word == "version") answer.version = text;
    if (word == "read") answer.files.push_back(text);
    if (word == "note") answer.notes.push_back(text);
  }
  answer.glb.assign(rest.begin(), rest.end());
  return answer;
}

}  // namespace mdk
