# What benches measure, and how: bakes models and times them. Sourced by ./run and
# docs/make_results.sh in the project's root; needs mdprep and make_sample, built.
# shellcheck shell=bash

mdprep=build/release/bin/mdprep
samples=build/release/samples

# make_source NAME: makes a sample that is not committed. NAME-splitN: its triangles split N times.
make_source() {
  local name=$1 made=()
  case $name in
    hand | ball | cally-* | skeleton-* | paladin-*) return ;;
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
    frames=2 techniques=all,-static-kdtree,-tsah-refit,-hybrid-bvh,-decomp-refit,-auto
  fi
  if [[ $techniques != all && $("$mdprep" bench --help) == *embree-medium* ]]; then
    techniques+=,-embree-medium
  fi
  camera=$(camera_of "$(basename "$file" .mdk)")
  if [[ $camera ]]; then set -- "$@" --camera "$camera"; fi
  [[ $given == *' --frames '* ]] || set -- "$@" --frames "$frames"
  [[ $given == *' --judge '* ]] || set -- "$@" --judge "$judge"
  [[ $given == *' --techniques '* ]] || set -- "$@" --techniques "$techniques"
  "$mdprep" bench "$file" "$@" --json "$result" --progress never -q >/dev/null
}
