// The real viewer under a few hundred events that nobody would think of, in an order that a seed
// fixes: it must neither fail nor hang. Where an event ends it, it goes on in another run.
#include <array>
#include <iterator>
#include <random>
#include <stdexcept>

#include "tests/viewer/mdview_gui.h"
#include "tests/viewer/x_drop.h"

namespace mdk::test {
namespace {

constexpr int kEvents = 300, kWidth = 1000, kHeight = 700;

constexpr std::array kKeys = {"space",       "Left",         "Right",    "Up",     "Down",
                              "Home",        "End",          "Tab",      "Return", "F1",
                              "Delete",      "BackSpace",    "1",        "4",      "9",
                              "bracketleft", "bracketright", "question", "plus",   "minus",
                              "slash",       "asciitilde",   "period",   "Escape"};

class RandomHand {
 public:
  explicit RandomHand(std::uint64_t seed) : random_(seed) {}

  // The library's distributions differ from one library to the next; a seed shall not.
  double uniform(double min, double max) {
    return min + (max - min) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>(uniform(0, static_cast<double>(count)));
  }
  std::string number(double min, double max) {
    return std::to_string(static_cast<int>(uniform(min, max)));
  }

  /// Mostly to a widget, at times anywhere in the window or just outside.
  std::vector<std::string> move(const nlohmann::json& widgets) {
    std::array<double, 4> place = {-5, -5, kWidth + 10, kHeight + 10};
    if (!widgets.empty() && index(5) > 0) {
      auto widget = widgets.begin();
      std::advance(widget, static_cast<std::ptrdiff_t>(index(widgets.size())));
      widget->get_to(place);
    }
    return {"mousemove", "--", number(place[0], place[0] + place[2]),
            number(place[1], place[1] + place[3])};
  }

  /// Words for xdotool; none: something is to be dropped.
  std::vector<std::string> next(const nlohmann::json& widgets) {
    const double what = uniform(0, 100);
    if (what < 38) return move(widgets);
    if (what < 68) return {what < 53 ? "mousedown" : "mouseup", index(4) == 0 ? number(1, 4) : "1"};
    if (what < 76) return {"click", "--repeat", number(1, 5), index(2) == 0 ? "4" : "5"};
    if (what < 87) return {"key", kKeys[index(kKeys.size())]};
    if (what < 98) return {"key", std::string(1, static_cast<char>('a' + index(26)))};
    if (what < 99.3)
      return {"search",     "--onlyvisible",  "--name",       "mdview",
              "windowsize", number(64, 1280), number(64, 800)};
    return {};
  }

 private:
  std::mt19937_64 random_;
};

TEST_F(MdviewGui, SurvivesAFewHundredRandomEvents) {
  write_text("bad.glb", "no model at all");
  write_text("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const std::vector<std::string> words = {"bar.mdk", "--size", "1000x700"};
  for (const char* tab : {"view", "cost", "compare", "clusters", "pick", "file"}) {
    std::vector<std::string> with_tab = words;
    with_tab.insert(with_tab.end(), {"--tab", tab});
    learn_widgets(with_tab);
  }
  const auto drop = [&](const std::string& path) {
    try {
      drop_file(server_->display(), "mdview", path);
    } catch (const std::runtime_error&) {  // the last event has ended it
    }
  };
  const std::vector<std::string> drops = {"bar.mdk", "bad.glb", "square.obj", "missing.mdk", "."};
  for (const std::uint64_t seed : {1, 2}) {
    RandomHand hand(seed);
    int draws = 0;
    std::unique_ptr<MdviewSession> session;
    const auto end = [&] {
      const MdviewResult result = session->running() ? session->close() : session->finish();
      EXPECT_EQ(result.status, 0) << "seed " << seed << ": " << result.messages;
      draws += result.state.value("window_draws", 0);
      session.reset();
    };
    for (int event = 0; event < kEvents && !HasFailure(); ++event) {
      if (session && !session->running()) end();
      if (!session) {
        session = start(words);
        session->wait_for_window();
      }
      const std::vector<std::string> doing = hand.next(widgets_);
      if (doing.empty())
        drop(folder_.file(drops[hand.index(drops.size())]));
      else
        session->try_xdotool(doing);
    }
    end();
    EXPECT_GT(draws, 50);
  }
}

}  // namespace
}  // namespace mdk::test
