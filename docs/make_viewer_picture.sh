#!/usr/bin/env bash
# Makes docs/images/mdview.png: a screenshot of mdview on a virtual display after a visitor has played
# the sample hand and clicked through the techniques. Needs a build (./run build), or MDK_BIN naming
# the folder of the programs, and Xvfb, xauth, xdotool and python3. Times in the picture are those of
# the machine it runs on: let nothing else run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ -z "${MDK_VIEWER_PICTURE_DISPLAY:-}" ]]; then
  MDK_VIEWER_PICTURE_DISPLAY=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0"
fi

bin=${MDK_BIN:-build/release/bin}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$bin/mdprep" bake assets/hand.glb -o "$work/hand.mdk" -q
view=("$bin/mdview" "$work/hand.mdk" --size 1280x800
      --camera "0.19 0.16 0.40 0.011 0.052 0.018 0 1 0 36")

# The same window tells beforehand where everything will be, page by page of the panel.
for tab in cost view; do
  "${view[@]}" --tab $tab --quit-after 2 --print-state > "$work/$tab.json"
done
click() {
  local at
  at=$(python3 -c '
import json, sys
x, y, width, height = json.load(open(sys.argv[1]))["widgets"][sys.argv[2]]
print(int(x + width / 2), int(y + height / 2))' "$work/${2:-view}.json" "$1")
  # shellcheck disable=SC2086  # two words
  xdotool mousemove $at sleep 0.2 click 1
}

"${view[@]}" --screenshot docs/images/mdview.png --print-state > "$work/state.json" &
viewer=$!
xdotool search --sync --onlyvisible --name mdview > "$work/window"
sleep 1
click tab:cost
click count-work cost
click tab:view
click play
for technique in static-kdtree rebuild-bvh refit-bvh fuzzy-kdtree; do
  click "technique:$technique"
  sleep 1.2
done
# Mid-grasp, still playing.
click time-line
xdotool mousemove 470 100 sleep 0.6 key q
wait "$viewer"
python3 -c '
import json, sys
state = json.load(open(sys.argv[1]))
print(state["technique"], state["clip"], state["time"], state["last_frame"]["time_to_image_ms"])
' "$work/state.json"
