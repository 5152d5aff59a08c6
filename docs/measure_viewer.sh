#!/usr/bin/env bash
# Measures the habits of mdview that docs/user-guide.md gives figures for: how soon the first picture
# stands, what rest costs, what a jump in time costs beside playing, and whether the panel keeps its
# rate while a picture is slow. On a virtual display, with OpenGL in software: let nothing else run.
# usage: docs/measure_viewer.sh FILE.mdk…   For what it needs see viewer_hands.sh.
set -euo pipefail
(($# > 0)) || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
# shellcheck source=docs/viewer_hands.sh
source "$(dirname "${BASH_SOURCE[0]}")/viewer_hands.sh"

median() { printf '%s\n' "$@" | sort -g | sed -n "$((($# + 1) / 2))p"; }
cpu_ticks() { awk '{print $14 + $15}' "/proc/$viewer/stat"; }
size=(--size 1280x800)

for file in "$@"; do
  basename "$file"
  first=() opened=()
  for _ in {1..9}; do
    "$bin/mdview" "$file" "${size[@]}" --quit-after 1 --print-state > "$work/state.json"
    first+=("$(state first_picture_ms)")
  done
  for _ in {1..5}; do
    begin "${size[@]}"
    xdotool key l sleep 0.3
    xdotool type --delay 20 "$(realpath "$file")"
    xdotool key Return sleep 1
    end
    opened+=("$(state open_ms)")
  done
  printf '  first picture: %.0f ms after the program began (median of 9, least %.0f)\n' \
    "$(median "${first[@]}")" "$(printf '%s\n' "${first[@]}" | sort -g | head -n 1)"
  printf '  opened in a running viewer: %.0f ms to its picture (median of 5)\n' "$(median "${opened[@]}")"

  begin "$file" "${size[@]}" --play
  sleep 3
  end
  playing=$(state median_time_to_image_ms)
  widgets_of "$file" "${size[@]}"
  begin "$file" "${size[@]}"
  RANDOM=7
  for _ in {1..40}; do
    # shellcheck disable=SC2046  # two words
    xdotool mousemove $(at time-line "$(python3 -c "print(0.02 + 0.96 * $RANDOM / 32768)")" 0.5) \
      click 1 sleep 0.12
  done
  end
  printf '  time to image: %.1f ms playing, %.1f ms at random jumps (medians of 15)\n' \
    "$playing" "$(state median_time_to_image_ms)"

  begin "$file" "${size[@]}"
  sleep 12  # until the cost curve is whole
  before=$(cpu_ticks)
  sleep 5
  after=$(cpu_ticks)
  end
  printf '  at rest: %s CPU ticks of %s in 5 s\n' $((after - before)) $((5 * $(getconf CLK_TCK)))

  begin "$file" "${size[@]}" --technique brute-force --play
  sleep 4
  end
  printf '  brute force, playing: the window was drawn %s times in about 5 s while %s pictures came\n' \
    "$(state window_draws)" "$(state frames_shown)"
done
