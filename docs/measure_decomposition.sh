#!/usr/bin/env bash
# How good decompositions are: bakes every sample by the paper's method and by ours, traces both beside
# static kd-trees, and writes docs/results/decomposition.md with its plot and pictures.
#
#   docs/measure_decomposition.sh [-o FOLDER] [-p | MODEL…]
#
# -p: measure nothing, write page and pictures again from what was measured last.
# MODEL: some of hand ben chicken cow dolphin cloth ball, and, where MDK_TEST_DATA names a folder with
# sequences/NAME.obj and NAME.pc2: real-cow real-crane real-elephant real-horse real-jumping (default: all
# there are).
# What was measured stays in build/release/decomposition: models not named keep their last figures.
# Needs a build (./run build) and jq.
# shellcheck disable=SC2016  # the $ in jq programs are jq's
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

die() { printf 'measure_decomposition: %s\n' "$*" >&2; exit 1; }
command -v jq >/dev/null || die 'jq is missing; install the package jq'
build=build/release
mdprep=$build/bin/mdprep
[[ -x $mdprep ]] || die "there is no $mdprep; run ./run build first"

results=docs/results
if [[ ${1:-} == -o ]]; then
  [[ $# -ge 2 ]] || die '-o needs a folder'
  results=$2
  shift 2
fi
page_only=
if [[ ${1:-} == -p ]]; then page_only=1; fi
work=$build/decomposition
mkdir -p "$work" "$results/images"

# The files of a model, and its own options; nothing where it is not at hand.
source_of() {
  local made=$build/samples real=${MDK_TEST_DATA:-}/sequences
  case $1 in
    hand) echo assets/hand.glb --clips beckon ;;
    ball) echo assets/ball.glb --clips throw ;;
    ben) echo "$made/ben.glb" ;;
    chicken | cow | dolphin | cloth) echo "$made/$1.obj $made/$1.pc2" ;;
    real-cow | real-crane | real-jumping) real_source "$real/${1#real-}" ;;
    real-elephant | real-horse) real_source "$real/${1#real-}_gallop" ;;
    *) die "there is no model $1" ;;
  esac
}
real_source() { if [[ -f $1.obj && -f $1.pc2 ]]; then echo "$1.obj $1.pc2"; fi; }

one_segment=(--segments 1)
paper=(--decompose motion --stop 1 --refine off --between-keys off "${one_segment[@]}")

# bake_and_trace MODEL KIND OPTIONS…: figures to $work/MODEL.KIND.*
bake_and_trace() {
  local name=$1 kind=$2 file=$work/$1.$2
  shift 2
  printf '%s, %s\n' "$name" "$kind" >&2
  # shellcheck disable=SC2046
  "$mdprep" bake $(source_of "$name") "$@" -o "$file.mdk" --report "$file.bake.json" -v --progress never \
    2>"$file.log" || { cat "$file.log" >&2; return 1; }
  "$mdprep" info "$file.mdk" --json --areas >"$file.info.json"
  "$mdprep" bench "$file.mdk" --techniques static-kdtree,fuzzy-kdtree --size 1024x1024 --frames 6 \
    --rounds 1 --json "$file.bench.json" --progress never >/dev/null
  jq -s --arg kind "$kind" '
    .[0] as $bake | .[1] as $info | .[2].models[0].techniques as $t
    | ($t[] | select(.id == "static-kdtree")) as $static
    | ($t[] | select(.id == "fuzzy-kdtree")) as $fuzzy
    | {kind: $kind, bake: $bake, fuzzy_area: $info.fuzzy_area, tight_area: $info.tight_area,
       mismatches: ($static.hit_mismatches + $fuzzy.hit_mismatches),
       segments: ($info.segments | if type == "array" then length else 1 end),
       steps: ($fuzzy.node_visits_per_ray / $static.node_visits_per_ray),
       candidates: ($fuzzy.leaf_triangles_per_ray / $static.leaf_triangles_per_ray),
       tests: ($fuzzy.triangle_tests_per_ray / $static.triangle_tests_per_ray)}' \
    "$file.bake.json" "$file.info.json" "$file.bench.json" >"$file.json"
}

# Clusters at the rest pose and at two other keys, and the residual where this mdprep shows it.
take_pictures() {
  local file=$work/$1.ours keys rest
  keys=$(jq .bake.keys "$file.json")
  rest=$(jq .bake.rest_key "$file.json")
  render() {
    "$mdprep" render "$file.mdk" -o "$results/images/$1.png" --frames "$2" --size 240x240 \
      --shading "$3" -q --progress never
  }
  render "$1-rest" "$rest" clusters
  render "$1-third" $((keys / 3)) clusters
  render "$1-late" $((keys * 5 / 8)) clusters
  render "$1-last" $((keys * 5 / 8)) residual
}

# GFW06 Figures 5 and 6 with the sample hand by the paper's method: 1, 2, 4, 8 and 12 clusters; and with 12 the
# clusters' maps alone, whole and from near, beside the mesh itself.
take_papers_pictures() {
  local clusters near=(--camera '0 0.08 0.30 -0.008 0.06 0.04 0 1 0 16')
  picture() {
    local name=$1 clusters=$2
    shift 2
    "$mdprep" render "$work/hand-$clusters.mdk" -o "$results/images/$name.png" --frames 20 --size 240x240 -q \
      --progress never "$@"
  }
  for clusters in 1 2 4 8 12; do
    # shellcheck disable=SC2046
    "$mdprep" bake $(source_of hand) "${paper[@]}" --clusters "$clusters" -o "$work/hand-$clusters.mdk" -q
    picture "figure6-$clusters" "$clusters" --shading clusters
  done
  picture figure5-mesh 12
  picture figure5-affine 12 --shading affine
  picture figure5-near 12 "${near[@]}"
  picture figure5-affine-near 12 --shading affine "${near[@]}"
}

all=(hand ben chicken cow dolphin cloth ball real-cow real-crane real-elephant real-horse real-jumping)
if (($# == 0)); then set -- "${all[@]}"; fi
if [[ $page_only ]]; then set --; fi
for name in "$@"; do
  files=$(source_of "$name")
  [[ -n $files ]] || continue
  if [[ $files == "$build/samples"* && ! -f ${files%% *} ]]; then
    cmake --build "$build" --target samples >/dev/null || die 'the samples could not be made'
  fi
  bake_and_trace "$name" paper "${paper[@]}"
  bake_and_trace "$name" equal "${one_segment[@]}" --between-keys off --clusters "$(jq .bake.clusters "$work/$name.paper.json")"
  bake_and_trace "$name" ours "${one_segment[@]}"
  bake_and_trace "$name" auto
  take_pictures "$name"
  if [[ $name == hand ]]; then take_papers_pictures; fi
done
measured=()
for name in "${all[@]}"; do
  if [[ -f $work/$name.auto.json ]]; then measured+=("$name"); fi
done
if [[ $page_only ]]; then
  for name in "${measured[@]}"; do take_pictures "$name"; done
  take_papers_pictures
fi

# row MODEL FILTER: the filter sees {paper, equal, ours, auto} and gives the cells.
row() {
  jq -rs --arg name "$1" "
    def f(d): . as \$v | pow(10; d) as \$s | (\$v * \$s | round) / \$s | tostring;
    def pc: . * 100 | f(3) + \" %\";
    (map({(.kind): .}) | add) as {paper: \$p, equal: \$e, ours: \$o, auto: \$a}
    | [\$name] + ($2) | \"| \" + join(\" | \") + \" |\"" \
    "$work/$1.paper.json" "$work/$1.equal.json" "$work/$1.ours.json" "$work/$1.auto.json"
}
rows() { for name in "${measured[@]}"; do row "$name" "$1"; done; }

# GFW06 Table 1, steps and candidates, beside the sample of the same kind; real-cow is its COW.
gfw06='{"ben":["1.54","1.9"],"chicken":["1.8","6.2"],"cow":["1.49","4"],"dolphin":["1.91","1.59"],"hand":["1.76","1.15"]}'

# One panel per model: the residual, the area of the fuzzy boxes and the cost while the paper's method adds
# clusters, in shares of those of one cluster, on a logarithmic scale from 1 down to 0.001 (after GFW06 Figure 7).
growth_plot() {
  local name
  for name in "${measured[@]}"; do
    printf 'model %s\n' "$name"
    jq -r '.growth[] | "\(.clusters) \(.residual_rms) \(.fuzzy_area) \(.sah_cost)"' "$work/$name.paper.bake.json"
  done | awk '
    function y_of(share) { return share <= 0.001 ? high : -log(share) / log(10) / 3 * high }
    function curve(value, class,   i, path) {
      for (i = 1; i <= n; i++)
        path = path (i > 1 ? "L" : "M") sprintf("%.1f %.1f ", (x[i] - 1) / (x[n] > 1 ? x[n] - 1 : 1) * wide,
                                                y_of(value[1] > 0 ? value[i] / value[1] : 1))
      printf "<path class=\"%s\" d=\"%s\"/>\n", class, path
    }
    function panel(   left, top, d) {
      if (name == "" || n == 0) return
      left = 46 + panels % 4 * (wide + 46); top = 40 + int(panels / 4) * (high + 54)
      printf "<g transform=\"translate(%d %d)\">\n", left, top
      printf "<text y=\"-8\" class=\"name\">%s</text>\n", name
      for (d = 0; d <= 3; d++)
        printf "<path class=\"grid\" d=\"M0 %.1f H%d\"/><text x=\"-5\" y=\"%.1f\" class=\"tick\" text-anchor=\"end\">%s</text>\n",
               d / 3 * high, wide, d / 3 * high + 3, d == 0 ? "1" : sprintf("%g", 10 ^ -d)
      printf "<text y=\"%d\" class=\"tick\">1</text><text x=\"%d\" y=\"%d\" class=\"tick\" text-anchor=\"end\">%d clusters</text>\n",
             high + 14, wide, high + 14, x[n]
      curve(residual, "residual"); curve(area, "area"); curve(cost, "cost")
      print "</g>"
      panels++
    }
    BEGIN { wide = 170; high = 120 }
    $1 == "model" { panel(); name = $2; n = 0; next }
    { n++; x[n] = $1; residual[n] = $2; area[n] = $3; cost[n] = $4 }
    END { panel(); printf "<!-- %d -->\n", panels }' >"$work/panels.svg"
  local panels rows
  panels=$(sed -n 's/<!-- \([0-9]*\) -->/\1/p' "$work/panels.svg")
  rows=$(((panels + 3) / 4))
  {
    printf '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 880 %d" font-family="sans-serif">\n' \
      $((rows * 174 + 40))
    cat <<'SVG'
<style>
.ground { fill: #fff } text { fill: #222; font-size: 10px } .name { font-size: 12px; font-weight: bold }
.grid { stroke: #ccc; stroke-width: 1 } .residual, .area, .cost { fill: none; stroke-width: 2 }
.residual { stroke: #c0392b } .area { stroke: #2a8a4a } .cost { stroke: #1f6fb2 }
@media (prefers-color-scheme: dark) {
  .ground { fill: #16181c } text { fill: #ddd } .grid { stroke: #444 }
  .residual { stroke: #ff7b6b } .area { stroke: #63d18a } .cost { stroke: #6cb6ff }
}
</style>
<rect class="ground" width="100%" height="100%"/>
SVG
    grep -v '^<!--' "$work/panels.svg"
    printf '<g transform="translate(46 %d)"><path class="residual" d="M0 0h24"/><text x="30" y="3">rms residual</text>' \
      $((rows * 174 + 22))
    printf '<path class="area" d="M130 0h24"/><text x="160" y="3">area of fuzzy boxes</text>'
    printf '<path class="cost" d="M290 0h24"/><text x="320" y="3">cost</text></g>\n</svg>\n'
  } >"$results/decomposition_growth.svg"
}

write_page() {
  local cpu
  cpu=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -1)
  cat <<PAGE
# Decomposition, measured

Written by \`docs/measure_decomposition.sh\`; do not edit. Commit $(git rev-parse --short HEAD), release build,
$(nproc) cores, ${cpu:-unknown processor}.

- *paper*: \`${paper[*]}\`, the method of GFW06.
- *ours*: the defaults, with one time segment (\`${one_segment[*]}\`); *auto*: the defaults as they are.
- *equal*: the defaults with as many clusters as *paper* has, one time segment and, as it, boxes of keys only
  (\`--clusters N ${one_segment[*]} --between-keys off\`).
- *cost*: expected work of a ray that meets the model ([method.md](../method.md)); that of *paper* and *equal* counts boxes of keys,
  that of *ours* and *auto* boxes of all times, which are larger. 0.12 of it for each cluster are the same on both sides.
- *W*: area in the world of all fuzzy boxes, in areas of the mesh's box, median over keys; *tight*: the same for
  the boxes of the current triangles, the floor.
- *steps*, *candidates*, *tests*: kd-tree steps, triangles of the leaves entered (which GFW06 counts) and triangle tests after
  culling of \`fuzzy-kdtree\` over those of \`static-kdtree\` at the same six keys, 1024x1024, default camera, trees built with
  the same constants. They are counts, and the same on every run.
- hand is its clip \`beckon\`, ball its clip \`throw\`; models whose names start with *real* are captured or simulated
  by others and not part of the project.

## Traced, beside static kd-trees

| model | steps paper | steps ours | steps auto | GFW06 | candidates paper | candidates ours | candidates auto | GFW06 | tests paper | tests ours | tests auto | wrong hits |
|---|---|---|---|---|---|---|---|---|---|---|---|---|
$(rows "$gfw06"' as $g | [(($p, $o, $a) | .steps | f(2)), ($g[$name | ltrimstr("real-")][0] // "–"),
   (($p, $o, $a) | .candidates | f(2)), ($g[$name | ltrimstr("real-")][1] // "–"), (($p, $o, $a) | .tests | f(2)), ($p.mismatches + $o.mismatches + $a.mismatches | tostring)]')

## Cost and looseness

| model | clusters paper | cost paper | cost equal | equal / paper | cost ours | cost auto | segments auto | W paper | W equal | W ours | W auto | tight |
|---|---|---|---|---|---|---|---|---|---|---|---|---|
$(rows '[($p.bake.clusters | tostring), ($p, $e | .bake.sah_cost | f(1)), ($e.bake.sah_cost / $p.bake.sah_cost | f(3)),
   ($o, $a | .bake.sah_cost | f(1)), ($a.segments | tostring), (($p, $e, $o, $a) | .fuzzy_area | f(1)), ($o.tight_area | f(1))]')

## Clusters and residuals

Residuals are relative to the diagonal of the rest pose's box.

| model | triangles | keys | clusters paper | clusters ours | stop ours | rms paper | rms ours | max paper | max ours |
|---|---|---|---|---|---|---|---|---|---|
$(rows '[($p.bake.triangles, $p.bake.keys, $p.bake.clusters, $o.bake.clusters | tostring), $o.bake.stop_reason,
   ($p.bake.residual_rms | pc), ($o.bake.residual_rms | pc), ($p.bake.residual_max | pc), ($o.bake.residual_max | pc)]')

## Time and memory of a bake

Of *auto*, in seconds, and the totals of *ours* and *paper*; timings of one run, which other work on the machine lengthens.

| model | read | decompose | build | write | total | total ours | total paper | peak memory | file |
|---|---|---|---|---|---|---|---|---|---|
$(rows '[($a.bake.seconds | .read, .decompose, .build, .write, .total | f(2)), ($o, $p | .bake.seconds.total | f(2)),
   (($a.bake.peak_memory_bytes, $a.bake.file_bytes) / 1048576 | f(1) + " MiB")]')

## While clusters are added

By the paper's method: residual motion, summed area of the fuzzy boxes and cost, each in shares of those of one cluster; after
GFW06 Figure 7.

![Residual, area and cost over the number of clusters](decomposition_growth.svg)

## Affine motion alone

The hand as it is, and as the maps of 12 clusters alone would have it (\`--shading affine\`), whole and from near, by the paper's method; after
GFW06 Figure 5. What the maps do not explain opens cracks at the joints; the fuzzy boxes hold it.

| the mesh | affine motion alone | the mesh | affine motion alone |
|---|---|---|---|
| ![](images/figure5-mesh.png) | ![](images/figure5-affine.png) | ![](images/figure5-near.png) | ![](images/figure5-affine-near.png) |

## One cluster after the other

The hand with 1, 2, 4, 8 and 12 clusters by the paper's method; after GFW06 Figure 6.

| 1 | 2 | 4 | 8 | 12 |
|---|---|---|---|---|
| ![](images/figure6-1.png) | ![](images/figure6-2.png) | ![](images/figure6-4.png) | ![](images/figure6-8.png) | ![](images/figure6-12.png) |

## Clusters

At the rest pose, at a third and at five eighths of the keys, and the same moment by residual; after GFW06
Figures 5 and 6.

| model | rest | a third | five eighths | by residual |
|---|---|---|---|---|
$(for name in "${measured[@]}"; do
    printf '| %s | ![](images/%s-rest.png) | ![](images/%s-third.png) | ![](images/%s-late.png) | ![](images/%s-last.png) |\n' \
      "$name" "$name" "$name" "$name" "$name"
  done)
PAGE
}

growth_plot
write_page >"$results/decomposition.md"
printf 'wrote %s\n' "$results/decomposition.md" >&2
