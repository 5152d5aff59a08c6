#!/usr/bin/env bash
# Makes docs/images/mdview.png: a screenshot of mdview on a virtual display after a visitor has played
# the sample hand and clicked through the techniques. For what it needs see viewer_hands.sh. Times in
# the picture are those of the machine it runs on: let nothing else run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=docs/viewer_hands.sh
source docs/viewer_hands.sh

bake_hand
view=("$work/hand.mdk" --size 1280x800 --camera "0.19 0.16 0.40 0.011 0.052 0.018 0 1 0 36")
widgets_of "${view[@]}" --tab cost
begin "${view[@]}" --tab cost --screenshot docs/images/mdview.png
click count-work
click tab:view
widgets_of "${view[@]}"
click play
for technique in static-kdtree rebuild-bvh refit-bvh fuzzy-kdtree; do
  click "technique:$technique"
  sleep 1
done
# Mid-grasp, still playing.
click time-line
xdotool mousemove 470 100 sleep 0.6
end
echo "$(state technique) $(state clip) $(state time) $(state last_frame.time_to_image_ms)"
