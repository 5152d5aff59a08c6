#!/usr/bin/env bash
# What clusters cost a ray, in units of a triangle box tested: kEnteringCost and kClusterCost of
# preprocess/boxes/cost.h. Bakes samples with few to many clusters, times single rays of no preferred place or
# direction (random_rays_bench) and tiles of eye rays (fuzzy-bvh over refit-bvh) through each bake, and fits
#
#     time = what the model costs in any case + box x W + entering x (clusters entered) + cluster x K
#
# by least squares, W being the area of the fuzzy boxes in areas of the model's box. Prints the rows and the
# coefficients, and how well the cost with the constants of cost.h ranks the bakes of each model.
#
#   docs/measure_cost.sh [-r ROUNDS] [bake | fit | MODEL…]
#
# ROUNDS: each file is timed so often (default: 3), the fastest counts. bake: only make the files, so that the
# timing can be left to a quiet machine; fit: measure nothing, fit what was measured last; MODEL: measure these
# alone, models not named keep their last times. Where MDK_TEST_DATA names the folder of outside samples, real
# sequences are measured, too. Needs a build, jq and python3, and a quiet machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=docs/bench_models.sh
source docs/bench_models.sh
die() { printf 'measure_cost: %s\n' "$*" >&2; exit 1; }
bin=build/release/bin
[[ -x $bin/random_rays_bench && -x $mdprep ]] || die "there is no $bin/random_rays_bench; run ./run build first"
command -v jq >/dev/null || die 'jq is missing; install the package jq'

rounds=3 step=all
if [[ ${1:-} == -r ]]; then
  [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || die '-r needs a number of rounds'
  rounds=$2
  shift 2
fi
all=(hand chicken cow dolphin ben)
if [[ -n ${MDK_TEST_DATA:-} ]]; then all+=(real-cow real-crane real-elephant_gallop real-horse_gallop real-jumping); fi
if [[ ${1:-} == bake || ${1:-} == fit ]]; then
  step=$1
  shift
fi
models=("${@:-${all[@]}}")
work=build/release/cost
mkdir -p "$work"
cluster_counts=(2 5 10 20 40 80 140)

bake_all() {
  local model clusters
  make_sources "${models[@]}"
  for model in "${models[@]}"; do
    for clusters in "${cluster_counts[@]}"; do
      # shellcheck disable=SC2046
      bake_model "$work" "$model-$clusters" $(source_of "$model") --clusters "$clusters" --segments 1
    done
  done
}

# measure MODEL: a row for each of its bakes: model, clusters, area, cost, clusters entered, ns a ray, tiles.
measure() {
  local model=$1 clusters file area cost tiles round count entered ray
  for clusters in "${cluster_counts[@]}"; do
    file=$work/$model-$clusters.mdk
    area=$("$mdprep" info "$file" --json --areas | jq .fuzzy_area)
    cost=$(jq .sah_cost "$work/$model-$clusters.json")
    "$mdprep" bench "$file" --techniques fuzzy-bvh,refit-bvh --size 512x512 --frames 6 --rounds $((4 * rounds)) \
      --threads 1 --judge none --json "$work/bench.json" --progress never -q >/dev/null
    tiles=$(jq '.models[0].techniques | map({key: .id, value: .trace_ms}) | from_entries
                | .["fuzzy-bvh"] / .["refit-bvh"]' "$work/bench.json")
    for ((round = 0; round < rounds; ++round)); do
      read -r _ count entered ray _ < <($bin/random_rays_bench "$file")
      echo "$model $count $area $cost $entered $ray $tiles"
    done
  done
}

if [[ $step != fit ]]; then bake_all; fi
if [[ $step == bake ]]; then exit; fi
if [[ $step == all ]]; then
  for model in "${models[@]}"; do
    measure "$model" | tee "$work/$model.new"
    mv "$work/$model.new" "$work/$model.rows"
  done
fi
measured=()
for model in "${all[@]}"; do
  if [[ -f $work/$model.rows ]]; then measured+=("$work/$model.rows"); fi
done
cat "${measured[@]}" >"$work/rows"

python3 - "$work/rows" <<'PYTHON'
import sys

MAX_AREA = 40  # past it a decomposition is none, and most boxes lie behind hits
best = {}
for line in open(sys.argv[1]):
    model, *numbers = line.split()
    clusters, area, cost, entered, ray, tile = map(float, numbers)
    if area < MAX_AREA:
        key = (model, clusters)
        old = best.get(key)
        if old is None or ray < old[2]:
            best[key] = (area, entered, ray, tile, cost)


def least_squares(rows, values):
    n = len(rows[0])
    m = [[sum(r[i] * r[j] for r in rows) for j in range(n)] + [sum(r[i] * v for r, v in zip(rows, values))]
         for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(m[r][i]))
        m[i], m[pivot] = m[pivot], m[i]
        for r in range(n):
            if r != i:
                share = m[r][i] / m[i][i]
                m[r] = [x - share * y for x, y in zip(m[r], m[i])]
    return [m[i][n] / m[i][i] for i in range(n)]


def rank_correlation(a, b):
    """Spearman's; equal values share the mean of their ranks."""
    def ranks(values):
        return [sum(w < v for w in values) + (sum(w == v for w in values) - 1) / 2 - (len(values) - 1) / 2
                for v in values]
    x, y = ranks(a), ranks(b)
    size = (sum(v * v for v in x) * sum(v * v for v in y)) ** 0.5
    return sum(v * w for v, w in zip(x, y)) / size if size else 0


models = sorted({model for model, _ in best})
rows = [[float(model == m) for m in models] + [area, entered, clusters]
        for (model, clusters), (area, entered, *_) in best.items()]
for what, column, unit in (("single rays", 2, "ns"), ("tiles", 3, "of the time through a refitted tree")):
    times = [row[column] for row in best.values()]
    fit = least_squares(rows, times)
    box, entering, cluster = fit[-3:]
    predicted = [sum(a * b for a, b in zip(row, fit)) for row in rows]
    print(f"{what}, {len(times)} bakes: a triangle box {box:.4g} {unit}; entering a cluster {entering / box:.2f} and each "
          f"cluster {cluster / box:.3f} of that; rank correlation of fit and time {rank_correlation(times, predicted):.3f}")
    # The cost alone, with the constants of cost.h: of one model's bakes the one with the lowest is taken.
    alone = []
    for m in models:
        own = [row for (model, _), row in best.items() if model == m]
        own_times, own_costs = [row[column] for row in own], [row[4] for row in own]
        alone.append(rank_correlation(own_times, own_costs))
        chosen = min(range(len(own)), key=lambda i: own_costs[i])
        print(f"  {m}: rank correlation of cost and time {alone[-1]:.2f} over {len(own)} bakes; the cheapest takes "
              f"{own_times[chosen] / min(own_times):.3f} of the quickest's time")
    print(f"  mean {sum(alone) / len(alone):.2f}")
PYTHON
