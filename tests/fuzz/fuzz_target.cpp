#include "tests/fuzz/fuzz_target.h"

#include <fcntl.h>
#include <unistd.h>

#include <stdexcept>

#include "common/base/error.h"
#include "common/base/parallel.h"

namespace mdk::test {
namespace {

constexpr std::size_t kLongestSentence = 2000;

bool is_sentence(const std::string& text) {
  return !text.empty() && text.size() <= kLongestSentence;
}

}  // namespace

std::string feed(const FuzzTarget& target, std::span<const unsigned char> bytes) {
  const ThreadLimit one_thread(1);  // inputs are tiny
  try {
    target.read(bytes);
    return {};
  } catch (const Error& error) {
    const std::string sentence = error.what();
    if (error.code() == ErrorCode::kInternal || error.code() == ErrorCode::kUsage)
      throw std::logic_error("refused with exit status " + std::to_string(error.exit_status()) +
                             ": " + sentence);
    if (!is_sentence(sentence))
      throw std::logic_error("refused with what is no sentence: " + sentence);
    return sentence;
  } catch (const std::logic_error&) {
    throw;
  } catch (const std::exception& other) {
    throw std::logic_error(std::string("threw what is no Error: ") + other.what());
  }
}

FuzzFile::FuzzFile(const std::string& name)
    : path_(folder_.file(name)),
      descriptor_(::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {}

FuzzFile::~FuzzFile() { ::close(descriptor_); }

const std::string& FuzzFile::holding(std::span<const unsigned char> bytes) {
  const auto size = static_cast<ssize_t>(bytes.size());
  if (::ftruncate(descriptor_, size) != 0 ||
      ::pwrite(descriptor_, bytes.data(), bytes.size(), 0) != size)
    throw std::runtime_error("cannot write " + path_);
  return path_;
}

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace mdk::test
