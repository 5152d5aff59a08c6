# Hands that move mdview on a virtual display, for the scripts that source this: it starts them again
# under Xvfb, bakes the sample hand into the folder $work, which goes away at the end, and gives them
# at, click, drag and widgets_of. Needs a build (./run build), or MDK_BIN naming the folder of the
# programs, and Xvfb, xauth, xdotool and python3.
# shellcheck shell=bash
if [[ -z "${MDK_VIEWER_DISPLAY:-}" ]]; then
  MDK_VIEWER_DISPLAY=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$@"
fi

bin=${MDK_BIN:-$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)/build/release/bin}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

bake_hand() { "$bin/mdprep" bake assets/hand.glb -o "$work/hand.mdk" -q; }

# widgets_of WORD…: where everything will be in a window that is started so.
widgets_of() { "$bin/mdview" "$@" --quit-after 2 --print-state > "$work/widgets.json"; }

# at WIDGET [ACROSS DOWN]: a place in it, in parts of its size; its middle, if none is given.
at() {
  python3 -c '
import json, sys
x, y, width, height = json.load(open(sys.argv[1]))["widgets"][sys.argv[2]]
across, down = map(float, sys.argv[3:] or (0.5, 0.5))
print(int(x + across * width), int(y + down * height))' "$work/widgets.json" "$@"
}
hover() {
  # shellcheck disable=SC2046  # two words
  xdotool mousemove $(at "$@") sleep 0.5
}
click() {
  # shellcheck disable=SC2046  # two words
  xdotool mousemove $(at "$@") sleep 0.3 click 1 sleep 0.5
}
drag() {  # along a widget: drag WIDGET FROM TO, parts of its width
  # shellcheck disable=SC2046  # two words each
  xdotool mousemove $(at "$1" "$2" 0.5) sleep 0.2 mousedown 1 sleep 0.2 \
    mousemove $(at "$1" "$3" 0.5) sleep 0.3 mouseup 1 sleep 0.3
}
# begin WORD…: starts mdview and waits for its window; end: lets it quit, its state in $work/state.json.
begin() {
  "$bin/mdview" "$@" --print-state > "$work/state.json" &
  viewer=$!
  xdotool search --sync --onlyvisible --name mdview > /dev/null
  sleep 1
}
end() {
  xdotool key q
  wait "$viewer"
}
# state NAME: of the last state, such as last_frame.hits.
state() {
  python3 -c 'import functools, json, sys
print(functools.reduce(lambda at, name: at[name], sys.argv[2].split("."), json.load(open(sys.argv[1]))))' \
    "$work/state.json" "$1"
}
