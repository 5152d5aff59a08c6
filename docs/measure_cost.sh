#!/usr/bin/env bash
# What clusters cost a ray, in units of a triangle box tested: kEnteringCost and kClusterCost of
# preprocess/boxes/cost.h. Bakes samples with few to many clusters, times single rays of no preferred place or
# direction (random_rays_bench) and tiles of eye rays (fuzzy-bvh over refit-bvh) through each bake, and fits
#
#     time = what the model costs in any case + box x W + entering x (clusters entered) + cluster x K
#
# by least squares, W being the area of the fuzzy boxes in areas of the model's box. Prints the rows and the
# coefficients. usage: docs/measure_cost.sh [ROUNDS]   Each file is timed so often (default: 3), the fastest
# counts. Where MDK_TEST_DATA names the folder of outside samples, real sequences are measured, too.
# Needs a build, jq and python3, and a quiet machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
rounds=${1:-3}
bin=build/release/bin
[[ -x $bin/random_rays_bench ]] || { echo "there is no $bin/random_rays_bench; run ./run build first" >&2; exit 1; }
# shellcheck source=docs/bench_models.sh
source docs/bench_models.sh
work=build/release/cost
mkdir -p "$work"
models=(hand chicken cow dolphin ben)
make_sources "${models[@]}"
if [[ -n ${MDK_TEST_DATA:-} ]]; then models+=(real-cow real-crane real-elephant_gallop real-horse_gallop real-jumping); fi

# input_of MODEL: what 'mdprep bake' takes for it.
input_of() {
  if [[ $1 == real-* ]]; then
    echo "$MDK_TEST_DATA/sequences/${1#real-}.obj" "$MDK_TEST_DATA/sequences/${1#real-}.pc2"
  else
    source_of "$1"
  fi
}

: >"$work/rows"
for model in "${models[@]}"; do
  for clusters in 2 5 10 20 40 80 140; do
    file=$work/$model-$clusters.mdk
    # shellcheck disable=SC2046
    [[ -f $file ]] || $bin/mdprep bake $(input_of "$model") -o "$file" --clusters "$clusters" --segments 1 -q
    area=$($bin/mdprep info "$file" --json --areas | jq .fuzzy_area)
    $bin/mdprep bench "$file" --techniques fuzzy-bvh,refit-bvh --size 512x512 --frames 6 --rounds $((4 * rounds)) \
      --threads 1 --judge none --json "$work/bench.json" --progress never -q >/dev/null
    tiles=$(jq '.models[0].techniques | map({key: .id, value: .trace_ms}) | from_entries
                | .["fuzzy-bvh"] / .["refit-bvh"]' "$work/bench.json")
    for ((round = 0; round < rounds; ++round)); do
      read -r _ count entered ray _ < <($bin/random_rays_bench "$file")
      echo "$model $count $area $entered $ray $tiles" | tee -a "$work/rows"
    done
  done
done

python3 - "$work/rows" <<'PYTHON'
import sys

MAX_AREA = 40  # past it a decomposition is none, and most boxes lie behind hits
best = {}
for line in open(sys.argv[1]):
    model, *numbers = line.split()
    clusters, area, entered, ray, tile = map(float, numbers)
    if area < MAX_AREA:
        key = (model, clusters)
        old = best.get(key)
        if old is None or ray < old[2]:
            best[key] = (area, entered, ray, tile)


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


def rank(values):
    order = sorted(range(len(values)), key=lambda i: values[i])
    ranks = [0] * len(values)
    for place, i in enumerate(order):
        ranks[i] = place
    return ranks


models = sorted({model for model, _ in best})
rows = [[float(model == m) for m in models] + [area, entered, clusters]
        for (model, clusters), (area, entered, _, _) in best.items()]
for what, column, unit in (("single rays", 2, "ns"), ("tiles", 3, "of the time through a refitted tree")):
    times = [row[column] for row in best.values()]
    fit = least_squares(rows, times)
    box, entering, cluster = fit[-3:]
    predicted = [sum(a * b for a, b in zip(row, fit)) for row in rows]
    n = len(times)
    distance = sum((a - b) ** 2 for a, b in zip(rank(times), rank(predicted)))
    print(f"{what}, {n} bakes: a triangle box {box:.4g} {unit}; entering a cluster {entering / box:.2f} and each "
          f"cluster {cluster / box:.3f} of that; rank correlation {1 - 6 * distance / (n * (n * n - 1)):.3f}")
PYTHON
