#!/usr/bin/env bash
# Regenerates the pictures of README.md from the sample hand, with many samples or at twice their size
# and shrunk, for smooth edges. Needs a build (./run build) and ImageMagick (package imagemagick).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mdprep=build/release/bin/mdprep
camera='0.30 0.14 0.62 0.012 0.055 0 0 1 0 28'

"$mdprep" bake assets/hand.glb -o "$work/hand.mdk" -q
for mode in diffuse clusters; do
  "$mdprep" render "$work/hand.mdk" -o "$work/${mode}_####.png" --frames 0:60:2 --size 640x640 \
    --shading "$mode" --camera "$camera" -q --progress never
done

# Left as it looks, right its clusters, through the clip "grasp".
for frame in "$work"/diffuse_*.png; do
  convert "$frame" "${frame/diffuse_/clusters_}" -resize 50% +append "${frame/diffuse_/pair_}"
done
convert -delay 6 -loop 0 "$work"/pair_*.png -layers optimize -colors 128 docs/images/hand.gif

# A strip through the clip "count".
for shading in lit clusters; do
  "$mdprep" render "$work/hand.mdk" -o "$work/strip_${shading}_####.png" --frames 66:166:20 \
    --size 260x300 --samples 64 --shading "$shading" --camera "$camera" -q --progress never
  convert "$work"/strip_${shading}_*.png +append "$work/row_$shading.png"
done
convert "$work/row_lit.png" "$work/row_clusters.png" -append docs/images/strip.png
