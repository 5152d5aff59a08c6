#!/usr/bin/env bash
# Measures every technique and writes docs/results/benchmark.json, the document and pictures made from
# it, and the figures that README.md and docs/ quote from it.
#
#   docs/make_results.sh [--quick] [--models NAME,…] [-o FOLDER] [bake | write]
#
# bake: only make and bake the models. write: measure nothing, make the documents from
# FOLDER/benchmark.json. --quick: small pictures of small models, to try the whole way in a minute.
# --models: those instead, every one on every instruction set; NAME-splitN is a sample with its triangles
# split into four N times (hand-split3: 1,054,336; ben-split2: 1,252,096). With -o, no document outside
# FOLDER is touched.
#
# Every result is kept in build/results, by the program that was measured: started again after an
# interruption, it goes on where it was. Bakes are kept there too, so that the measuring itself can be
# left to a quiet machine. NAME-paper, -bones, -space, -first and -level are baked in other ways, for the papers'
# tables (docs/bench_models.sh). Needs a build (./run build). Where MDK_TEST_DATA names the folder of outside
# samples, the thesis's characters are measured too.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=docs/bench_models.sh
source docs/bench_models.sh

die() { printf 'make_results: %s\n' "$*" >&2; exit 1; }
say() { printf '%(%H:%M:%S)T %s\n' -1 "$*" >&2; }
[[ -x $mdprep && -x build/release/bin/make_sample ]] || die 'there is no build; run ./run build first'

quick='' only='' results=docs/results step=all
while (($#)); do
  case $1 in
    --quick) quick=-quick ;;
    -o)
      results=${2:?-o needs a folder}
      shift
      ;;
    --models)
      only=${2:?--models needs names}
      shift
      ;;
    bake | write) step=$1 ;;
    *) die "$1: see the head of docs/make_results.sh" ;;
  esac
  shift
done

models=(hand ball chicken cow dolphin cloth ben hand-split1 hand-split2 palm hand-split3 ben-split2)
models+=(hand-paper ben-paper chicken-paper cow-paper dolphin-paper chicken-level cow-level dolphin-level)
setting=(--size 1024x1024)
if [[ -n ${MDK_TEST_DATA:-} ]]; then
  models+=(real-cow real-cow-paper)
  for name in cally-walking cally-freestyle skeleton-freestyle paladin-jogging; do
    models+=("$name" "$name-bones" "$name-space" "$name-first")
  done
fi
if [[ $quick ]]; then
  models=(hand ball hand-split1 hand-paper hand-bones hand-space hand-first)
  setting=(--size 256x256 --frames 3 --rounds 2 --judge 1)
fi

# What is compared between instruction sets and threads, and where; hits were judged before.
few=fuzzy-bvh,fuzzy-kdtree,refit-bvh,rebuild-bvh
if [[ $("$mdprep" bench --help) == *embree-low* ]]; then few+=,embree,embree-refit,embree-low; fi
further=(cow ball hand hand-split1 ben hand-split2 hand-split3)
further_options=(--techniques "$few" --judge none)
lit=(ball hand chicken cow dolphin ben hand-split2)
lit_options=(--techniques "${few/fuzzy-kdtree,/}" --judge none --shading lit --ao 16 --frames 3)
if [[ -n ${MDK_TEST_DATA:-} ]]; then further=(cally-walking "${further[@]}"); fi
if [[ $quick ]]; then
  further=(hand hand-split1)
  lit=(hand)
  further_options=(--techniques "$few")
  lit_options=(--techniques "${few/fuzzy-kdtree,/}" --shading lit --ao 16)
fi

if [[ $only ]]; then
  IFS=, read -ra models <<<"$only"
  further=("${models[@]}")
  lit=("${models[@]}")
fi

work=build/results/$(sha256sum "$mdprep" | cut -c1-12)$quick
mkdir -p "$work" "$results"

bake_all() {
  local name
  for name in "${models[@]}"; do
    make_source "$name"
    [[ -f $work/$name.mdk ]] || say "bake $name"
    # shellcheck disable=SC2046
    bake_model "$work" "$name" $(source_of "$name") $(options_of "$name")
  done
}

# measure ISA THREADS MODEL OPTIONS…: one result, unless it is there. A run that was interrupted left
# none, since results appear whole or not at all.
measure() {
  local isa=$1 threads=$2 name=$3 result=$work/$3.$1.$2.json
  if [[ " $* " == *' --shading lit '* ]]; then result=$work/$3.$1.$2.lit.json; fi
  shift 3
  if [[ ! -f $result ]]; then
    say "measure $name, $isa, $threads thread(s)"
    measure_model "$work/$name.mdk" "$result" "${setting[@]}" --isa "$isa" --threads "$threads" \
      --commit "$(git describe --always --dirty)" --command docs/make_results.sh "$@"
  fi
  parts+=("$result")
}

measure_all() {
  local isas=() best isa name
  for isa in neon sse4 avx2 avx512; do  # what the machine lacks is refused
    if "$mdprep" info "$work/${models[0]}.mdk" --isa "$isa" >/dev/null 2>&1; then isas+=("$isa"); fi
  done
  best=${isas[-1]}
  for name in "${models[@]}"; do measure "$best" 1 "$name"; done
  for isa in "${isas[@]}"; do
    if [[ $isa == "$best" ]]; then continue; fi
    for name in "${further[@]}"; do measure "$isa" 1 "$name" "${further_options[@]}"; done
  done
  for name in "${lit[@]}"; do measure "$best" 1 "$name" "${lit_options[@]}"; done
  if (($(nproc) > 1)); then
    for name in "${further[@]}"; do measure "$best" 2 "$name" "${further_options[@]}"; done
  fi
}

# The document, and what others quote from it.
write_all() {
  local quoting=()
  if [[ $results == docs/results ]]; then
    mapfile -t quoting < <(grep -l '<!-- bench: ' README.md docs/*.md || true)
  fi
  "$mdprep" bench --from "$results/benchmark.json" --markdown "$results/benchmark.md" \
    --html "build/results/benchmark.html" ${quoting[0]:+--quote "${quoting[@]}"} >/dev/null
  say "wrote $results/benchmark.md and build/results/benchmark.html"
}

parts=()
if [[ $step != write ]]; then bake_all; fi
if [[ $step == all ]]; then
  measure_all
  "$mdprep" bench --from "${parts[@]}" --json "$results/benchmark.json" >/dev/null
fi
if [[ $step != bake ]]; then write_all; fi
