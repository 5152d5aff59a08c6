#!/usr/bin/env bash
# Did a change make tracing faster or slower? Times two builds of mdprep in turn, A B A B, so that a
# machine that grows busy or warm slows both, and compares what they came to.
#
#   docs/compare_builds.sh OLD_MDPREP NEW_MDPREP FILE.mdk… [-- OPTIONS OF mdprep bench…]
#
# 1024x1024, eight keys; the options can be --threads, --isa, --techniques, --shading and --camera.
# For instance, in a branch: cp build/release/bin/mdprep /tmp/old; change; ./run build; then
#   docs/compare_builds.sh /tmp/old build/release/bin/mdprep out/hand.mdk -- --threads 1
set -euo pipefail

usage() { sed -n '2,10s/^# \{0,1\}//p' "$0" >&2; exit 2; }
(($# >= 3)) || usage
declare -A program=([old]=$1 [new]=$2)
shift 2
files=()
while (($#)) && [[ $1 != -- ]]; do
  files+=("$1")
  shift
done
(($# == 0)) || shift
((${#files[@]})) || usage

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
turns=5
for ((turn = 1; turn <= turns; ++turn)); do
  for which in old new; do
    printf 'turn %d of %d: %s\n' "$turn" "$turns" "$which" >&2
    "${program[$which]}" bench "${files[@]}" --rounds 1 --frames 8 --judge none --size 1024x1024 "$@" \
      --json "$work/$which.$turn.json" -q >/dev/null
  done
done
for which in old new; do
  "${program[new]}" bench --from "$work/$which".*.json --json "$work/$which.json" >/dev/null
done
"${program[new]}" bench --compare "$work/old.json" "$work/new.json"
