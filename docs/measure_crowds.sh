#!/usr/bin/env bash
# What pictures of crowds cost: stadiums of the sample hand, 1,000 to 1,000,000 of them, ours beside a hierarchy
# for each character that is refitted in every frame (as far as 4 GB go). Writes docs/results/crowds.md.
# usage: docs/measure_crowds.sh [THREADS]   (default: 2) Needs a build, jq and a quiet machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
threads=${1:-2}
mdprep=build/release/bin/mdprep
[[ -x $mdprep ]] || { echo "there is no $mdprep; run ./run build first" >&2; exit 1; }
work=build/release/crowds
mkdir -p "$work"
[[ -f $work/hand.mdk ]] || $mdprep bake assets/hand.glb -o "$work/hand.mdk" -q
page=docs/results/crowds.md
# Eye above the near stand, looking down on the field: the camera of each size, since stadiums grow.
camera_of() {
  case $1 in
    1000) echo "0 1.52 2.39 0 0.3 0 0 1 0 45" ;;
    10000) echo "0 4.4 7.6 0 0.9 0 0 1 0 45" ;;
    100000) echo "0 13.5 24 0 2.8 0 0 1 0 45" ;;
    1000000) echo "0 42 76 0 9 0 0 1 0 45" ;;
  esac
}
rows=
for count in 1000 10000 100000 1000000; do
  scene=$work/stadium-$count.mds
  [[ -f $scene ]] || $mdprep scene --scatter stadium --count "$count" "$work/hand.mdk" -o "$scene" -q
  frames=5
  ((count < 1000000)) || frames=3
  $mdprep bench "$scene" --size 1024x1024 --frames $frames --rounds 2 --threads "$threads" \
    --camera "$(camera_of "$count")" --json "$work/$count.json" --judge none -q >&2
  rows+=$(jq -r '.models[] | .instances as $n | .techniques[] |
    "| \($n) | `\(.id)` | \(.update_ms * 1000 | round / 1000) | \(.trace_ms | round) | \(.shade_ms | round) | " +
    "\(.time_to_image_ms | round) | \(.structure_bytes / 1e5 | round / 10) | \(.cache_bytes / 1e5 | round / 10) | " +
    "\(.instances_posed) |"' "$work/$count.json")$'\n'
done
isa=$(jq -r .isa "$work/1000.json")
cat >"$page" <<EOF
# Crowds

Stadiums of the sample hand (16,474 triangles), everyone at a time of their own, 1024x1024, diffuse, $threads threads, $isa: medians
over frames, the faster of two rounds each. Made by \`docs/measure_crowds.sh\`. *Structure* and *cache* are what is held beside the mapped files: the
cache is key poses and normals of the model and the pools of instances. *Posed*: instances whose rays were worked out in
a frame. \`refit-bvh\` has a hierarchy for each character, posed and refitted in every frame, topology shared; it is left out where it
would take more than 4 GB.

| characters | technique | update ms | trace ms | shade ms | image ms | structure MB | cache MB | posed |
|---|---|---|---|---|---|---|---|---|
$rows
EOF
echo "$page"
