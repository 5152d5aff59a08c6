#include "viewer/panel/commands.h"

// GLFW only for the names of keys.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace mdk {
namespace {

Binding key(int key, Command command) { return {{key, 0}, command}; }
Binding character(char sign, Command command) {
  return {{0, static_cast<unsigned char>(sign)}, command};
}

}  // namespace

std::span<const Shortcut> shortcuts() {
  using enum Command;
  static const std::vector<Shortcut> table = {
      {"Space", "play or pause", {key(GLFW_KEY_SPACE, kPlayPause)}},
      {"Left / Right",
       "previous or next key",
       {key(GLFW_KEY_LEFT, kPreviousKey), key(GLFW_KEY_RIGHT, kNextKey)}},
      {"Home / End",
       "start or end of the range, else of the clip",
       {key(GLFW_KEY_HOME, kStart), key(GLFW_KEY_END, kEnd)}},
      {"I / O",
       "a range to play begins or ends here",
       {character('i', kBeginRange), character('o', kEndRange)}},
      {"X", "no range: play all of the clip", {character('x', kClearRange)}},
      {"Up / Down or [ ]",
       "previous or next technique",
       {key(GLFW_KEY_UP, kPreviousTechnique), key(GLFW_KEY_DOWN, kNextTechnique),
        character('[', kPreviousTechnique), character(']', kNextTechnique)}},
      {"1 to 9", "technique by number", {}},
      {"S", "next shading", {character('s', kNextShading)}},
      {"V",
       "compare techniques: side by side, wipe, difference, off",
       {character('v', kNextCompare)}},
      {"A", "show all clusters", {character('a', kShowAll)}},
      {"F", "fit the model, keeping the direction", {character('f', kFit)}},
      {"R", "back to the first view", {character('r', kResetView)}},
      {"T", "turntable: the camera goes slowly round", {character('t', kToggleTurntable)}},
      {"P", "save the picture as PNG", {character('p', kSavePicture)}},
      {"Shift + P", "save the whole window as PNG", {character('P', kSaveWindow)}},
      {"C", "copy the mdprep render command of the picture", {character('c', kCopyCommand)}},
      {"E", "export the range, else the clip, as pictures or film", {character('e', kExport)}},
      {"L", "load: recent files, or a path", {character('l', kToggleFileMenu)}},
      {"D", "dark or light", {character('d', kToggleColors)}},
      {"+ / -",
       "larger or smaller text and buttons",
       {character('+', kLargerText), character('-', kSmallerText)}},
      {"Tab", "show or hide the panel", {key(GLFW_KEY_TAB, kTogglePanel)}},
      {"? or F1", "this list", {character('?', kToggleHelp), key(GLFW_KEY_F1, kToggleHelp)}},
      {"Esc",
       "close what stands open, cancel a bake or export; quit",
       {key(GLFW_KEY_ESCAPE, kDismiss)}},
      {"Q", "quit", {character('q', kQuit)}},
      {"Click", "pick the triangle", {}},
      {"Left drag", "orbit", {}},
      {"Middle, right or Shift drag", "pan", {}},
      {"Wheel", "zoom to the pointer", {}},
  };
  return table;
}

std::optional<Action> action_for(const KeyEvent& event) {
  for (const Shortcut& shortcut : shortcuts())
    for (const Binding& binding : shortcut.bindings)
      if ((event.key != 0 && event.key == binding.event.key) ||
          (event.character != 0 && event.character == binding.event.character))
        return Action{binding.command};
  if (event.key >= GLFW_KEY_1 && event.key <= GLFW_KEY_9)
    return Action{Command::kTechniqueByNumber, static_cast<std::size_t>(event.key - GLFW_KEY_1)};
  return {};
}

}  // namespace mdk
