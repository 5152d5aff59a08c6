#!/usr/bin/env bash
# Measures the habits of mdview that docs/user-guide.md gives figures for: how soon the first picture
# stands, what rest costs, what a jump in time costs beside playing, and whether the panel keeps its
# rate while a picture is slow. On a virtual display, with OpenGL in software: let nothing else run.
# usage: docs/measure_viewer.sh FILE.mdk…   Needs a build, Xvfb, xauth, xdotool and python3.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
(($# > 0)) || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
if [[ -z "${MDK_MEASURE_DISPLAY:-}" ]]; then
  MDK_MEASURE_DISPLAY=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$@"
fi
mdview=${MDK_BIN:-$here/build/release/bin}/mdview
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

state() {  # of the last run: state NAME
  python3 -c 'import functools, json, sys
print(functools.reduce(lambda at, name: at[name], sys.argv[2].split("."), json.load(open(sys.argv[1]))))' "$work/state.json" "$1"
}
begin() {
  "$mdview" "$@" --size 1280x800 --print-state > "$work/state.json" &
  viewer=$!
  xdotool search --sync --onlyvisible --name mdview > /dev/null
  sleep 1
}
end() { xdotool key q; wait "$viewer"; }
cpu_ticks() { awk '{print $14 + $15}' "/proc/$viewer/stat"; }

for file in "$@"; do
  echo "$(basename "$file")"
  times=()
  for _ in 1 2 3 4 5; do
    "$mdview" "$file" --size 1280x800 --quit-after 1 --print-state > "$work/state.json"
    times+=("$(state first_picture_ms)")
  done
  printf '  first picture, median of 5: %.0f ms after the program began\n' \
    "$(printf '%s\n' "${times[@]}" | sort -g | sed -n 3p)"

  begin "$file" --play
  sleep 3
  end
  playing=$(state median_time_to_image_ms)
  read -r x y width height < <(state widgets.time-line | tr -d '[],')
  begin "$file"
  RANDOM=7
  for _ in $(seq 40); do
    xdotool mousemove "$(python3 -c "print(int($x + 20 + ($width - 40) * $RANDOM / 32768))")" \
      "$(python3 -c "print(int($y + $height / 2))")" click 1 sleep 0.12
  done
  end
  printf '  time to image: %.1f ms playing, %.1f ms at random jumps (medians of 15)\n' \
    "$playing" "$(state median_time_to_image_ms)"

  begin "$file"
  sleep 12  # until the cost curve is whole
  before=$(cpu_ticks)
  sleep 5
  after=$(cpu_ticks)
  end
  printf '  at rest: %s CPU ticks of %s in 5 s\n' $((after - before)) $((5 * $(getconf CLK_TCK)))

  begin "$file" --technique brute-force --play
  sleep 4
  end
  printf '  brute force, playing: the window was drawn %s times in about 5 s while %s pictures came\n' \
    "$(state window_draws)" "$(state frames_shown)"
done
