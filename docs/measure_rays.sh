#!/usr/bin/env bash
# Measures single rays beside Embree's ('mdprep bench --rays') and writes docs/results/rays.json and the tables
# of docs/results/rays.md.
#
#   docs/measure_rays.sh [-o FOLDER] [bake | write]
#
# bake: only make and bake the models. write: measure nothing, make the page from FOLDER/rays.json. Results are
# kept in build/results, by the program that was measured: started again after an interruption, it goes on
# where it was. Where MDK_TEST_DATA names the folder of outside samples, they are measured too. Needs a build
# (./run build), python3 and a quiet machine.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=docs/bench_models.sh
source docs/bench_models.sh
[[ -x $mdprep && -x build/release/bin/make_sample ]] || { echo 'there is no build; run ./run build first' >&2; exit 1; }

results=docs/results step=all
while (($#)); do
  case $1 in
    -o)
      results=${2:?-o needs a folder}
      shift
      ;;
    bake | write) step=$1 ;;
    *) echo "$1: see the head of docs/measure_rays.sh" >&2; exit 2 ;;
  esac
  shift
done
mkdir -p "$results"

work=build/results/rays-$(sha256sum "$mdprep" | cut -c1-12)
bakes=build/results/rays-bakes
models=(hand-all cow)
million=(hand-split3)
if [[ -n ${MDK_TEST_DATA:-} ]]; then models+=(cally-walking real-cow real-elephant_gallop); fi

input_of() {
  case $1 in
    hand-all) echo assets/hand.glb ;;
    real-*) echo "$MDK_TEST_DATA/sequences/${1#real-}.obj" "$MDK_TEST_DATA/sequences/${1#real-}.pc2" ;;
    *) source_of "$1" ;;
  esac
}

bake_all() {
  local name
  mkdir -p "$bakes"
  make_sources cow hand-split3
  for name in "${models[@]}" "${million[@]}"; do
    # shellcheck disable=SC2046
    [[ -f $bakes/$name.mdk ]] || "$mdprep" bake $(input_of "$name") -o "$bakes/$name.mdk" --progress never -q
  done
}

# measure NAME ISA OPTIONS…
measure() {
  local name=$1 isa=$2 result=$work/$1.$2.json
  shift 2
  [[ -f $result ]] || "$mdprep" bench --rays "$bakes/$name.mdk" --isa "$isa" --json "$result" --progress never -q "$@" >&2
  parts+=("$result")
}

parts=()
if [[ $step != write ]]; then bake_all; fi
if [[ $step == all ]]; then
  mkdir -p "$work"
  isas=()
  for isa in neon sse4 avx2 avx512; do  # what the machine lacks is refused
    if "$mdprep" info "$bakes/hand-all.mdk" --isa "$isa" >/dev/null 2>&1; then isas+=("$isa"); fi
  done
  best=${isas[-1]}
  for name in "${models[@]}" "${million[@]}"; do measure "$name" "$best"; done
  for isa in "${isas[@]}"; do
    if [[ $isa == "$best" ]]; then continue; fi
    for name in "${models[@]}"; do measure "$name" "$isa" --threads 1; done
  done
  python3 - "$results/rays.json" "${parts[@]}" <<'PYTHON'
import json, sys
merged = {"schema": "mdk-rays/1", "models": []}
for name in sys.argv[2:]:
    merged["models"] += json.load(open(name))["models"]
json.dump(merged, open(sys.argv[1], "w"), indent=1)
PYTHON
fi
if [[ $step == bake ]]; then exit; fi

python3 - "$results/rays.json" "$results/rays.md" <<'PYTHON'
import json, sys

MEANINGS = {
    "spin": "a lidar two diagonals away that turns",
    "scan": "a scan aimed at the model's box, row by row",
    "random": "lines through the model's box at random times, closest hit",
    "random-any": "the same, any hit",
    "moment": "such lines at one time, closest hit",
    "moment-any": "the same, any hit",
}
models = json.load(open(sys.argv[1]))["models"]
best = models[0]["isa"]
out = ["# Single rays beside Embree", "",
       "Made by `docs/measure_rays.sh` from [rays.json](rays.json); nothing here is edited by hand. `mdprep bench --rays`",
       "times 20,000 rays of each kind on this library and on Embree in turn, in one process: medians of 11 rounds, in",
       "nanoseconds a ray. *Robust* is Embree's watertight mode, which ours is held to; *plain* its default. Rows with a time",
       "for each ray meet Embree's motion blur with every key a time step, rows at one time its static hierarchy of medium",
       "quality, built for that time. Ratio: Embree's robust time over ours; above 1, ours is faster. Embree's memory includes the",
       "vertices of all keys, which it needs at hand; ours the poses that were decoded.", "", "| row | rays |", "|---|---|"]
out += [f"| {row} | {text} |" for row, text in MEANINGS.items()]
mib = lambda b: f"{b / 2**20:.1f}"


def table(model, threads):
    rows = [r for r in model["rows"] if r["threads"] == threads]
    if not rows:
        return []
    lines = ["", f"**{model['file'].removesuffix('.mdk')}**, {model['triangles']:,} triangles, {model['keys']} keys, "
                 f"{model['isa']}, {threads} thread{'s' if threads > 1 else ''}", "",
             "| row | hit % | ours | robust | plain | ratio | MiB, ours | Embree | build ms, ours | Embree | differ from brute force |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        lines.append(f"| {r['row']} | {100 * r['hits']:.1f} | {r['ours_ns']:.0f} | {r.get('peer_ns', 0):.0f} | {r.get('plain_ns', 0):.0f} "
                     f"| {r.get('ratio', 0):.2f} | {mib(r['ours_bytes'])} | {mib(r.get('peer_bytes', 0))} | {r['ours_build_ms']:.1f} "
                     f"| {r.get('peer_build_ms', 0):.1f} | {r['mismatches']}"
                     f"{' of ' + str(r['judged']) if r['judged'] else ''} |")
    return lines


for heading, wanted in (("One thread", lambda m: m["isa"] == best), ("Other instruction sets", lambda m: m["isa"] != best)):
    out += ["", f"## {heading}"]
    for model in models:
        if wanted(model):
            out += table(model, 1)
out += ["", "## Several threads", "", "How many times the rays of one thread are traced in a second.", "",
        "| model | threads | " + " | ".join(MEANINGS) + " |", "|---|---|" + "---|" * len(MEANINGS)]
for model in models:
    times = {(r["row"], r["threads"]): r["ours_ns"] for r in model["rows"]}
    for threads in sorted({t for _, t in times if t > 1}):
        cells = [f"{times[row, 1] / times[row, threads]:.2f}" for row in MEANINGS]
        out.append(f"| {model['file'].removesuffix('.mdk')} | {threads} | " + " | ".join(cells) + " |")
open(sys.argv[2], "w").write("\n".join(out) + "\n")
PYTHON
