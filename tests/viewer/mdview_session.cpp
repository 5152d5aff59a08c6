#include "tests/viewer/mdview_session.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include "tests/viewer/x_drop.h"

namespace mdk::test {
namespace {

constexpr double kPatience = 60;  // seconds; a busy machine may be slow

void pause_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

std::string read_text(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

ChildSetup mdview_setup(const std::string& folder, const std::vector<std::string>& words) {
  ChildSetup setup;
  setup.command = {MDK_MDVIEW, "--print-state"};
  setup.command.insert(setup.command.end(), words.begin(), words.end());
  setup.folder = folder;
  setup.stdout_file = folder + "/stdout.txt";
  setup.stderr_file = folder + "/stderr.txt";
  return setup;
}

MdviewResult collect(ChildProcess& process, const std::string& folder) {
  MdviewResult result;
  const auto status = process.wait(kPatience);
  result.messages = read_text(folder + "/stderr.txt");
  if (!status) {
    ADD_FAILURE() << "mdview does not end; it said: " << result.messages;
    return result;
  }
  result.status = *status;
  const std::string said = read_text(folder + "/stdout.txt");
  if (!said.empty()) result.state = nlohmann::json::parse(said);
  return result;
}

}  // namespace

MdviewSession::MdviewSession(const XServer& server, const std::string& folder,
                             const std::vector<std::string>& words)
    : display_(server.display()), folder_(folder) {
  ChildSetup setup = mdview_setup(folder, words);
  setup.display = display_;
  process_ = std::make_unique<ChildProcess>(setup);
}

void MdviewSession::wait_for_window() {
  xdotool({"search", "--sync", "--onlyvisible", "--name", "mdview"});
  pause_ms(800);
  let_it_draw();
}

// What happened is seen and drawn before the next event, however busy the machine. While it plays
// it never rests.
void MdviewSession::let_it_draw() {
  constexpr int kMinMs = 160, kLookMs = 20, kMaxLooks = 40;
  pause_ms(kMinMs);
  double before = -1;
  for (int i = 0; i < kMaxLooks; ++i) {
    const double now = process_->cpu_seconds();
    if (now == before && process_->asleep()) return;
    before = now;
    pause_ms(kLookMs);
  }
}

void MdviewSession::key(const std::string& name) {
  xdotool({"key", name});
  let_it_draw();
}

void MdviewSession::click(Point at) {
  xdotool({"mousemove", std::to_string(at.x), std::to_string(at.y)});
  let_it_draw();
  xdotool({"click", "1"});
  let_it_draw();
}

void MdviewSession::drag(Point from, Point by, int button) {
  const std::string name = std::to_string(button);
  xdotool({"mousemove", std::to_string(from.x), std::to_string(from.y)});
  let_it_draw();
  xdotool({"mousedown", name});
  let_it_draw();
  xdotool({"mousemove", std::to_string(from.x + by.x), std::to_string(from.y + by.y)});
  let_it_draw();
  xdotool({"mouseup", name});
  let_it_draw();
}

void MdviewSession::wheel_up(Point at) {
  xdotool({"mousemove", std::to_string(at.x), std::to_string(at.y)});
  let_it_draw();
  xdotool({"click", "4"});
  let_it_draw();
}

void MdviewSession::xdotool(std::vector<std::string> words) {
  EXPECT_EQ(try_xdotool(words), 0) << "xdotool " << words.front();
}

std::optional<int> MdviewSession::try_xdotool(std::vector<std::string> words) {
  ChildSetup setup;
  words.insert(words.begin(), "xdotool");
  setup.command = std::move(words);
  setup.display = display_;
  return ChildProcess(setup).wait(kPatience);
}

MdviewResult MdviewSession::finish() { return collect(*process_, folder_); }

MdviewResult MdviewSession::close() {
  close_window(display_, "mdview");
  return finish();
}

MdviewResult MdviewSession::quit() {
  xdotool({"key", "q"});
  return finish();
}

MdviewResult run_without_display(const std::string& folder, const std::vector<std::string>& words) {
  ChildProcess process(mdview_setup(folder, words));
  return collect(process, folder);
}

}  // namespace mdk::test
