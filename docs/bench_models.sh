# What benches measure, and how: bakes models and times them. Sourced by ./run and
# docs/make_results.sh in the project's root; needs mdprep and make_sample, built.
# shellcheck shell=bash

mdprep=build/release/bin/mdprep
samples=build/release/samples

# Models baked in another way than by default, by the end of their names: by the method of GFW06 with its
# numbers of clusters, with a cluster for each bone, for a pose space, with the first key as rest pose, and one
# pose alone, cut into clusters.
base_of() { if [[ $1 =~ ^(.*)-(paper|bones|space|first|level)$ ]]; then echo "${BASH_REMATCH[1]}"; else echo "$1"; fi; }

# How many clusters GFW06 has for the scenes that samples are like.
paper_clusters() {
  case $1 in
    hand | chicken) echo 21 ;;
    dolphin) echo 16 ;;
    *) echo 20 ;;
  esac
}

# options_of NAME: of its bake.
options_of() {
  local name
  name=$(base_of "$1")
  case $1 in
    *-paper) echo --stop 1 --refine off --segments 1 --between-keys off --clusters "$(paper_clusters "${name#real-}")" ;;
    *-bones) echo --decompose bones ;;
    *-space) echo --decompose bones --sampling pose-space ;;
    *-first) echo --rest-pose 0 ;;
    *-level) echo --clusters "$(paper_clusters "$name")" ;;
  esac
}

# make_source NAME: makes a sample that is not committed. NAME-splitN: its triangles split N times.
make_source() {
  local name made=()
  name=$(base_of "$1")
  case $name in
    hand | ball | cally-* | skeleton-* | paladin-* | real-*) return ;;
    palm)
      make_source hand-split2
      return
      ;;
    *-split[1-6]) made=("$samples/$name.glb") ;;
    ben) made=("$samples/$name.glb") ;;
    *) made=("$samples/$name.obj" "$samples/$name.pc2") ;;
  esac
  [[ -f ${made[0]} && -f ${made[-1]} && ! build/release/bin/make_sample -nt ${made[-1]} ]] && return
  mkdir -p "$samples"
  if [[ $name == *-split* ]]; then
    mkdir -p "$samples/$name"
    build/release/bin/make_sample "${name%-split*}" "$samples/$name" "${name##*-split}" >/dev/null
    mv "$samples/$name/${name%-split*}.glb" "${made[0]}"
    rmdir "$samples/$name"
  else
    build/release/bin/make_sample "$name" "$samples" >/dev/null
  fi
}

# camera_of NAME: where models are not seen whole. "palm" is hand-split2 from near: half of it is outside
# the picture.
camera_of() { if [[ $1 == palm ]]; then echo "0.02 0.06 0.30 0.005 0.045 0 0 1 0 12"; fi; }

# make_sources NAME…: all of them at one time, since each keeps one core busy.
make_sources() {
  local name maker makers=()
  for name; do
    make_source "$name" &
    makers+=($!)
  done
  for maker in "${makers[@]}"; do wait "$maker"; done
}

# source_of NAME: what 'mdprep bake' takes for it. Three clips of a character by others stand for the
# thesis's animations where MDK_TEST_DATA has them.
source_of() {
  case $1 in
    *-level) echo "$samples/$(base_of "$1").obj" ;;
    *-paper | *-bones | *-space | *-first) source_of "$(base_of "$1")" ;;
    real-*) echo "${MDK_TEST_DATA:-}/sequences/${1#real-}.obj" "${MDK_TEST_DATA:-}/sequences/${1#real-}.pc2" ;;
    hand) echo assets/hand.glb --clips beckon ;;
    ball) echo assets/ball.glb --clips throw ;;
    hand-split*) echo "$samples/$1.glb" --clips beckon ;;
    palm) source_of hand-split2 ;;
    ben | *-split*) echo "$samples/$1.glb" ;;
    cally-walking) echo "${MDK_TEST_DATA:-}/cal3d/cally.glb" --clips walk ;;
    cally-freestyle) echo "${MDK_TEST_DATA:-}/cal3d/cally.glb" --clips tornado_kick ;;
    skeleton-freestyle) echo "${MDK_TEST_DATA:-}/cal3d/skeleton.glb" --clips hiphop ;;
    paladin-jogging) echo "${MDK_TEST_DATA:-}/cal3d/paladin.glb" --clips jog ;;
    *) echo "$samples/$1.obj" "$samples/$1.pc2" ;;
  esac
}

# bake_model FOLDER NAME INPUT AND OPTIONS…: FOLDER/NAME.mdk and its report, unless they are newer
# than the first input and mdprep.
bake_model() {
  local out=$1/$2.mdk
  shift 2
  [[ -f $out && ! $1 -nt $out && ! $mdprep -nt $out ]] && return
  "$mdprep" bake "$@" -o "$out" --report "${out%.mdk}.json" --progress never -q
}

triangles_of() { "$mdprep" info "$1" --json | grep -o '"triangles": *[0-9]*' | head -1 | grep -o '[0-9]*$'; }

# measure_model FILE.mdk RESULT.json OPTIONS…: what the options leave open is chosen by the number of
# triangles: fewer frames for larger models, and not what would take minutes to build.
measure_model() {
  local file=$1 result=$2 triangles frames judge=1 techniques=all given camera
  shift 2
  given=" $* "
  triangles=$(triangles_of "$file")
  if ((triangles <= 30000)); then
    frames=12 judge=3
  elif ((triangles <= 150000)); then
    frames=6
  elif ((triangles <= 500000)); then
    frames=3 techniques=all,-static-kdtree
  else
    frames=2 techniques=all,-static-kdtree,-tsah-refit,-hybrid-bvh,-rotate-bvh,-decomp-refit,-auto
  fi
  if [[ $techniques != all && $("$mdprep" bench --help) == *embree-medium* ]]; then
    techniques+=,-embree-medium
  fi
  case $(basename "$file" .mdk) in  # variants are measured for the tables that compare them
    *-paper | *-level) techniques=static-kdtree,fuzzy-kdtree ;;
    *-bones | *-space) techniques=rebuild-bvh,refit-bvh,fuzzy-bvh,decomp-refit ;;
    *-first) techniques=refit-bvh ;;
  esac
  camera=$(camera_of "$(basename "$file" .mdk)")
  if [[ $camera ]]; then set -- "$@" --camera "$camera"; fi
  [[ $given == *' --frames '* ]] || set -- "$@" --frames "$frames"
  [[ $given == *' --judge '* ]] || set -- "$@" --judge "$judge"
  [[ $given == *' --techniques '* ]] || set -- "$@" --techniques "$techniques"
  "$mdprep" bench "$file" "$@" --json "$result" --progress never -q >/dev/null
}
