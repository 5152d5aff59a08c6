#!/usr/bin/env bash
# Makes the pictures of docs/user-guide.md: mdview on a virtual display, moved by hands that a script
# has. For what it needs see viewer_hands.sh. Times in the pictures are those of the machine it runs on.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=docs/viewer_hands.sh
source docs/viewer_hands.sh

bake_hand
view=("$work/hand.mdk" --size 1280x800 --time 0.9
      --camera "0.19 0.16 0.40 0.011 0.052 0.018 0 1 0 36")

# picture NAME OPTION... -- STEP...: docs/images/viewer-NAME.png after the steps, each a command.
picture() {
  local name=$1 options=()
  shift
  while [[ "$1" != -- ]]; do options+=("$1"); shift; done
  shift
  widgets_of "${view[@]}" "${options[@]}"
  begin "${view[@]}" "${options[@]}" --screenshot "docs/images/viewer-$name.png"
  for step in "$@"; do eval "$step"; done
  end
}
aside="xdotool mousemove 5 5 sleep 0.3"  # no widget is pointed at

picture compare --compare wipe --technique fuzzy-bvh --against refit-bvh --tab compare \
  --shading clusters -- "$aside"
picture pick --tab pick -- "click picture 0.5 0.56" "$aside"
picture clusters --tab clusters --shading clusters -- "click local-boxes" \
  "hover cluster:3"
picture view -- "$aside"
picture time-line -- "xdotool sleep 4 key 2 sleep 5 key 4 sleep 5 key 1 sleep 3" \
  "drag range-lane 0.3 0.7" "$aside"
picture light --theme light --tab file --shading lit --samples 4 -- "$aside"

"$bin/mdprep" bake assets/hand.glb -q -o "$work/posed.mdk" --decompose bones --sampling pose-space
view=("$work/posed.mdk" "${view[@]:1}" --shading clusters)
widgets_of "${view[@]}"
begin "${view[@]}"
click pose-by-hand 0.1 0.5
end
cp "$work/state.json" "$work/widgets.json"  # where joints and sliders are
begin "${view[@]}" --screenshot docs/images/viewer-pose.png
click pose-by-hand 0.1 0.5
for joint in index_1 middle_1; do
  click "joint:$joint"
  drag turn:x 0.5 0.7
done
eval "$aside"
end

view=(--size 1280x800)
picture start -- "$aside"
