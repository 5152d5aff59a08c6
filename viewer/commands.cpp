#include "viewer/commands.h"

// GLFW only for the names of keys.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>

namespace mdk {
namespace {

struct Binding {
  int key;
  unsigned character;
  Command command;
};

constexpr std::array kBindings = {
    Binding{GLFW_KEY_SPACE, 0, Command::kPlayPause},
    Binding{GLFW_KEY_LEFT, 0, Command::kPreviousKey},
    Binding{GLFW_KEY_RIGHT, 0, Command::kNextKey},
    Binding{GLFW_KEY_HOME, 0, Command::kStart},
    Binding{GLFW_KEY_END, 0, Command::kEnd},
    Binding{GLFW_KEY_UP, '[', Command::kPreviousTechnique},
    Binding{GLFW_KEY_DOWN, ']', Command::kNextTechnique},
    Binding{0, 's', Command::kNextShading},
    Binding{0, 'v', Command::kNextCompare},
    Binding{0, 'a', Command::kShowAll},
    Binding{0, 'f', Command::kFit},
    Binding{0, 'r', Command::kResetView},
    Binding{0, 'p', Command::kSavePicture},
    Binding{0, 'P', Command::kSaveWindow},
    Binding{0, 'c', Command::kCopyCommand},
    Binding{0, 'i', Command::kBeginRange},
    Binding{0, 'o', Command::kEndRange},
    Binding{0, 'x', Command::kClearRange},
    Binding{0, 't', Command::kToggleTurntable},
    Binding{0, 'd', Command::kToggleColors},
    Binding{0, '+', Command::kLargerText},
    Binding{0, '-', Command::kSmallerText},
    Binding{0, 'e', Command::kExport},
    Binding{0, 'l', Command::kToggleFileMenu},
    Binding{GLFW_KEY_TAB, 0, Command::kTogglePanel},
    Binding{GLFW_KEY_F1, '?', Command::kToggleHelp},
    Binding{GLFW_KEY_ESCAPE, 0, Command::kDismiss},
    Binding{0, 'q', Command::kQuit},
};

constexpr std::array kHelp = {
    ShortcutHelp{"Space", "play or pause"},
    ShortcutHelp{"Left / Right", "previous or next key"},
    ShortcutHelp{"Home / End", "start or end of the range, else of the clip"},
    ShortcutHelp{"I / O", "a range to play begins or ends here"},
    ShortcutHelp{"X", "no range: play all of the clip"},
    ShortcutHelp{"Up / Down or [ ]", "previous or next technique"},
    ShortcutHelp{"1 to 9", "technique by number"},
    ShortcutHelp{"S", "next shading"},
    ShortcutHelp{"V", "compare techniques: side by side, wipe, difference, off"},
    ShortcutHelp{"A", "show all clusters"},
    ShortcutHelp{"F", "fit the model, keeping the direction"},
    ShortcutHelp{"R", "back to the first view"},
    ShortcutHelp{"T", "turntable: the camera goes slowly round"},
    ShortcutHelp{"P", "save the picture as PNG"},
    ShortcutHelp{"Shift + P", "save the whole window as PNG"},
    ShortcutHelp{"C", "copy the mdprep render command of the picture"},
    ShortcutHelp{"E", "export the range, else the clip, as pictures or film"},
    ShortcutHelp{"L", "load: recent files, or a path"},
    ShortcutHelp{"D", "dark or light"},
    ShortcutHelp{"+ / -", "larger or smaller text and buttons"},
    ShortcutHelp{"Tab", "show or hide the panel"},
    ShortcutHelp{"? or F1", "this list"},
    ShortcutHelp{"Esc", "close what stands open, cancel a bake or export; quit"},
    ShortcutHelp{"Q", "quit"},
    ShortcutHelp{"Click", "pick the triangle"},
    ShortcutHelp{"Left drag", "orbit"},
    ShortcutHelp{"Middle, right or Shift drag", "pan"},
    ShortcutHelp{"Wheel", "zoom to the pointer"},
};

const char* name_of_key(int key) {
  switch (key) {
    case GLFW_KEY_SPACE:
      return "Space";
    case GLFW_KEY_LEFT:
      return "Left";
    case GLFW_KEY_RIGHT:
      return "Right";
    case GLFW_KEY_UP:
      return "Up";
    case GLFW_KEY_DOWN:
      return "Down";
    case GLFW_KEY_HOME:
      return "Home";
    case GLFW_KEY_END:
      return "End";
    case GLFW_KEY_TAB:
      return "Tab";
    case GLFW_KEY_F1:
      return "F1";
    case GLFW_KEY_ESCAPE:
      return "Esc";
    default:
      return "a key without a name";
  }
}

std::string name_of_character(unsigned character) {
  const auto sign = static_cast<char>(character);
  if (sign >= 'a' && sign <= 'z') return {static_cast<char>(sign - 'a' + 'A')};
  if (sign >= 'A' && sign <= 'Z') return std::string("Shift + ") + sign;
  return {sign};
}

}  // namespace

std::optional<Action> action_for(const KeyEvent& event) {
  for (const Binding& binding : kBindings)
    if ((event.key != 0 && event.key == binding.key) ||
        (event.character != 0 && event.character == binding.character))
      return Action{binding.command};
  if (event.key >= GLFW_KEY_1 && event.key <= GLFW_KEY_9)
    return Action{Command::kTechniqueByNumber, static_cast<std::size_t>(event.key - GLFW_KEY_1)};
  return {};
}

std::vector<std::string> bound_keys() {
  std::vector<std::string> names;
  for (const Binding& binding : kBindings) {
    if (binding.key != 0) names.emplace_back(name_of_key(binding.key));
    if (binding.character != 0) names.push_back(name_of_character(binding.character));
  }
  return names;
}

std::span<const ShortcutHelp> shortcut_help() { return kHelp; }

}  // namespace mdk
