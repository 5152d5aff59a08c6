#!/usr/bin/env bash
# What entering a cluster costs a ray, in units of a triangle box met: transform_cost of preprocess/cost.h.
# Bakes the samples with few to many clusters, times random rays through each (random_rays_bench), and fits
#
#     time of a ray = what the model costs in any case + box x (triangle boxes met) + entering x (clusters met)
#
# by least squares: also with a fourth term, the number of clusters, each of which the top level looks at.
# usage: docs/measure_entering.sh [ROUNDS]   Each file is timed so often (default: 3), the fastest counts.
# Needs a build, jq and python3, and a quiet machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
rounds=${1:-3}
bin=build/release/bin
[[ -x $bin/random_rays_bench ]] || { echo "there is no $bin/random_rays_bench; run ./run build first" >&2; exit 1; }
source docs/bench_models.sh
work=build/release/entering
mkdir -p "$work"
models=(hand ben chicken cow dolphin)
make_sources "${models[@]}"

files=()
for model in "${models[@]}"; do
  for clusters in 6 10 16 24 32 48 64 80 120; do
    file=$work/$model-$clusters.mdk
    # shellcheck disable=SC2046
    [[ -f $file ]] || $bin/mdprep bake $(source_of "$model") -o "$file" --clusters "$clusters" --segments 1 -q
    files+=("$file")
  done
done
for file in "${files[@]}"; do
  echo "$(basename "$file" .mdk) $($bin/mdprep info "$file" --json --areas | jq .fuzzy_area)"
done >"$work/areas"
for ((round = 0; round < rounds; ++round)); do $bin/random_rays_bench "${files[@]}"; done >"$work/times"

python3 - "$work/areas" "$work/times" <<'PYTHON'
import sys

WIDEST = 20  # triangle boxes met; past it a decomposition is none, and most boxes lie behind hits
area = {name: float(value) for name, value in map(str.split, open(sys.argv[1]))}
best = {}
for name, clusters, met, time, _ in map(str.split, open(sys.argv[2])):
    row = (float(time), int(clusters), float(met))
    best[name] = min(best.get(name, row), row)


def least_squares(columns, values):
    n = len(columns)
    rows = [[sum(a * b for a, b in zip(columns[i], columns[j])) for j in range(n)]
            + [sum(a * b for a, b in zip(columns[i], values))] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda r: abs(rows[r][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for r in range(n):
            if r != i:
                share = rows[r][i] / rows[i][i]
                rows[r] = [x - share * y for x, y in zip(rows[r], rows[i])]
    return [rows[i][n] / rows[i][i] for i in range(n)]


names = [name for name in best if area[name] < WIDEST]
models = sorted({name.split("-")[0] for name in names})
columns = [[float(name.split("-")[0] == model) for name in names] for model in models]
columns += [[area[name] for name in names], [best[name][2] for name in names]]
times = [best[name][0] for name in names]
box, entering = least_squares(columns, times)[-2:]
print(f"{len(names)} files: {box:.1f} ns a triangle box met, {entering:.1f} ns a cluster met: {entering / box:.1f}")
columns.append([float(best[name][1]) for name in names])
box, entering, cluster = least_squares(columns, times)[-3:]
print(f"with {cluster:.2f} ns for each cluster there is: {box:.1f} and {entering:.1f}: {entering / box:.1f}")
PYTHON
