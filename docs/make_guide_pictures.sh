#!/usr/bin/env bash
# Makes the pictures of docs/user-guide.md: mdview on a virtual display, moved by hands that a script
# has. Needs a build (./run build), or MDK_BIN naming the folder of the programs, and Xvfb, xauth,
# xdotool and python3. Times in the pictures are those of the machine it runs on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ -z "${MDK_VIEWER_PICTURE_DISPLAY:-}" ]]; then
  MDK_VIEWER_PICTURE_DISPLAY=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0"
fi

bin=${MDK_BIN:-build/release/bin}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/mdprep" bake assets/hand.glb -o "$work/hand.mdk" -q
view=("$bin/mdview" "$work/hand.mdk" --size 1280x800 --time 0.9
      --camera "0.19 0.16 0.40 0.011 0.052 0.018 0 1 0 36")

# at WIDGET [ACROSS DOWN]: a place in it, as told by the window that was started last.
at() {
  python3 -c '
import json, sys
x, y, width, height = json.load(open(sys.argv[1]))["widgets"][sys.argv[2]]
across, down = map(float, sys.argv[3:] or (0.5, 0.5))
print(int(x + across * width), int(y + down * height))' "$work/widgets.json" "$@"
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
# picture NAME OPTION... -- STEP...: docs/images/viewer-NAME.png after the steps, each a command.
picture() {
  local name=$1 options=()
  shift
  while [[ "$1" != -- ]]; do options+=("$1"); shift; done
  shift
  "${view[@]}" "${options[@]}" --quit-after 2 --print-state > "$work/widgets.json"
  "${view[@]}" "${options[@]}" --no-state --screenshot "docs/images/viewer-$name.png" &
  local viewer=$!
  xdotool search --sync --onlyvisible --name mdview > "$work/window"
  sleep 1.5
  for step in "$@"; do eval "$step"; done
  xdotool key q
  wait "$viewer"
}

picture compare --compare wipe --technique fuzzy-bvh --against refit-bvh --tab compare \
  --shading clusters -- "xdotool mousemove 5 5 sleep 0.3"
picture pick --tab pick -- "click picture 0.5 0.56" "xdotool mousemove 5 5 sleep 0.3"
picture clusters --tab clusters --shading clusters -- "click local-boxes" \
  "xdotool mousemove $(printf '%s' "\$(at cluster:3)") sleep 0.5"
picture view -- "xdotool mousemove 5 5 sleep 0.3"
picture time-line -- "xdotool sleep 4 key 2 sleep 5 key 4 sleep 5 key 1 sleep 3" \
  "drag range-lane 0.3 0.7" "xdotool mousemove 5 5 sleep 0.3"
picture light --theme light --tab file --shading lit --samples 4 -- "xdotool mousemove 5 5 sleep 0.3"
# The empty window: the same without a file.
view=("$bin/mdview" --size 1280x800)
picture start -- "xdotool mousemove 5 5 sleep 0.3"
