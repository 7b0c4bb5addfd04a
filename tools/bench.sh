#!/usr/bin/env bash
# Error against run time on the scenes that Pagoda is measured on: makes what is missing of them
# under out/bench/, runs `pagoda bench` and writes JSON, HTML and a table under docs/results/bench/.
#
#   tools/bench.sh            the centre, and variations of it along one axis each: hours on 2 cores
#   tools/bench.sh --full     these, and every scene, path, size, speed and latency with all
#                             strategies at tau 1, 2, 4: days
#   tools/bench.sh --quick    small scenes and pictures, five minutes; results in out/bench/quick/
#   tools/bench.sh --list     names the runs, those that are done marked, and runs nothing
#
#   --only PATTERN            of all these, runs whose name matches, e.g. --only 'plant-*'
#   --results FOLDER          writes there
#
# centre      plant 12M, interior 5M, lego-show-a; inside; 640x480; latency 0; all strategies;
#             200 frames, 3 timed passes (lego-show-a: one; its bytes in 60 frames of coh alone).
#             frustum, whose frames cost ten of any other's, is set against bool and coh in a run
#             of its own, with one timed pass of 60 frames (lego-show-a: 6, no bytes); auto against what it
#             chooses between likewise, over all frames
# variations  coh, bool, frustum over 60 frames, one timed pass: outside; 1024x768; paths at 4 times
#             the speed; query latency 1, 2; the same cut in a sixteenth of the pixels (bool, simp,
#             coh: what their times are beside shading); and the scenes city 10M, torus 10M (with auto), hospital,
#             clinic. coh over 200 frames: prefetch; a disk of 500 MB/s, live
# Scenes are built with 2048 triangles a node, as in the paper of coherent HLOD culling; walks turn by
# 1 degree a frame. Prefetch is off but where a run is about it: it would read what culling spares.
# A run whose JSON is there is not repeated: delete it to measure again. Camera paths lie with the
# results and are made once. Nothing else should run meanwhile.
#
# PAGODA            the program (default: built here, build-release/tools/pagoda)
# PAGODA_TEST_DATA  folder of real models (default ../shared/data); scenes from it are left out
#                   without it
# Exit code 1 when a run failed; the others have run all the same.
set -euo pipefail
cd "$(dirname "$0")/.."

mode=centre only='*' results='' lists=false
usage() { sed -n '2,/^set -/{/^set -/d;s/^# \{0,1\}//;p}' "$0"; }
while [ $# -gt 0 ]; do
    case $1 in
    --quick | --full) mode=${1#--} ;;
    --list) lists=true ;;
    --only | --results)
        [ $# -ge 2 ] || { echo "bench.sh: $1 needs a value; see --help" >&2; exit 2; }
        if [ "$1" = --only ]; then only=$2; else results=$2; fi
        shift ;;
    -h | --help) usage; exit 0 ;;
    *) echo "bench.sh: no option '$1'; see tools/bench.sh --help" >&2; exit 2 ;;
    esac
    shift
done

data=$(realpath -m "${PAGODA_TEST_DATA:-../shared/data}")
scenes=out/bench
frames=200
nodeTriangles=2048
if [ "$mode" = quick ]; then
    scenes=out/bench/quick
    frames=20
    results=${results:-$scenes/results}
fi
results=${results:-docs/results/bench}
paths=$results/paths
pagoda=${PAGODA:-build-release/tools/pagoda}
say() { printf '\n[%d s] %s\n' $SECONDS "$1" >&2; }

# ---- Scenes and paths

# scene_source NAME: kind and triangles of a generated scene, or a real model's file.
scene_source() {
    local size=$mode
    case $1:$size in
    plant:quick) echo powerplant 300000 ;;
    interior:quick) echo interior 200000 ;;
    torus:quick) echo torus 300000 ;;
    plant:*) echo powerplant 12000000 ;;
    interior:*) echo interior 5000000 ;;
    city:*) echo city 10000000 ;;
    torus:*) echo torus 10000000 ;;
    lego-show-a:*) echo "$data/cad/lego-show-a.glb" ;;
    hospital:* | clinic:*) echo "$data/bim/$1.glb" ;;
    *) echo "bench.sh: no scene '$1'" >&2; return 1 ;;
    esac
}

is_here() { # SCENE: it can be made
    local source
    source=$(scene_source "$1")
    case $source in
    /*) [ -f "$source" ] ;;
    esac
}

make_scene() {
    local name=$1 database=$scenes/$1.pagoda source
    [ ! -f "$database" ] || return 0
    source=$(scene_source "$name")
    say "scene $name"
    mkdir -p "$scenes"
    case $source in
    /*) "$pagoda" build "$source" -o "$database" --node-triangles $nodeTriangles >&2 ;;
    *)
        "$pagoda" generate "${source% *}" --triangles "${source#* }" -o "$scenes/$name.glb" \
            --force >&2 &&
            "$pagoda" build "$scenes/$name.glb" -o "$database" --up z \
                --node-triangles $nodeTriangles >&2 &&
            rm "$scenes/$name.glb" ;;
    esac
}

make_path() { # SCENE KIND
    local path=$paths/$1-$2.json speed=1
    [ "$2" != walk ] || speed=0.25
    [ ! -f "$path" ] || return 0
    say "path $1-$2"
    mkdir -p "$paths"
    "$pagoda" path "$scenes/$1.pagoda" --kind "$2" --frames "$frames" --speed $speed \
        -o "$path" >&2
}

# ---- Runs

failed=0
# run NAME SCENE KIND OPTION...: NAME is that of its files.
run() {
    local name=$1 scene=$2 kind=$3 json=$results/$1.json state=''
    shift 3
    # shellcheck disable=SC2053 # a pattern is meant
    [[ $name == $only ]] || return 0
    if ! is_here "$scene"; then
        state='  (no model: PAGODA_TEST_DATA)'
    elif [ -f "$json" ]; then
        state='  (done)'
    fi
    if $lists; then
        echo "$name$state"
        return 0
    fi
    [ -z "$state" ] || { echo "$name$state" >&2; return 0; }
    if measure "$name" "$scene" "$kind" "$@"; then
        mv "$scenes/$name.json.part" "$json" # only a run that came to its end counts as done
    else
        echo "bench.sh: $name failed" >&2
        failed=1
    fi
}

measure() { # as run, in steps that stop at the first failure
    local name=$1 scene=$2 kind=$3
    shift 3
    make_scene "$scene" && make_path "$scene" "$kind" || return 1
    say "$name"
    [[ " $* " == *" --prefetch "* ]] || set -- "$@" --prefetch off
    "$pagoda" bench "$scenes/$scene.pagoda" --path "$paths/$scene-$kind.json" "$@" \
        --json "$scenes/$name.json.part" --html "$results/$name.html"
}

few=frustum,bool,coh
all=$few
outside_of() { # the torus has no inside: its other path flies along the surface
    case $1 in
    city) echo fly ;;
    *) echo orbit ;;
    esac
}
inside_of() {
    case $1 in
    torus) echo fly ;;
    *) echo walk ;;
    esac
}

quick() {
    local scene
    for scene in plant interior torus; do
        run "$scene-$(inside_of $scene)" $scene "$(inside_of $scene)" --strategy "$few" \
            --size 320x240 --repeats 2 --truth-every 2
    done
    run interior-walk-latency2 interior walk --strategy coh,bool --size 320x240 --query-latency 2 \
        --repeats 1 --truth-every 4
}

centre() {
    local scene
    for scene in plant interior; do
        run $scene-walk $scene walk --strategy "${all#frustum,}" --repeats 3 --truth-every 4
        run $scene-walk-frustum $scene walk --strategy $few --frames 60 --repeats 1 --truth-every 0
        run $scene-walk-auto $scene walk --strategy coh,hzb,auto --repeats 1 --truth-every 20 \
            --no-settled
    done
    # A frame of it costs ten of the others', a settled one more than a hundred.
    scene=lego-show-a
    run $scene-walk $scene walk --strategy "${all#frustum,}" --repeats 1 --truth-every 20 --no-settled
    run $scene-walk-bytes $scene walk --strategy coh --frames 60 --repeats 0 --truth-every 0
    run $scene-walk-frustum $scene walk --strategy $few --frames 6 --repeats 1 --truth-every 0 \
        --no-settled
}

variations() {
    local scene inside outside strategies
    local brief=(--frames 60 --repeats 1 --truth-every 10 --no-settled)
    for scene in plant interior lego-show-a; do
        outside=$(outside_of $scene)
        run "$scene-$outside" $scene "$outside" --strategy $few "${brief[@]}"
        run $scene-walk-1024x768 $scene walk --strategy $few "${brief[@]}" --size 1024x768
        run $scene-walk-speed4 $scene walk --strategy $few "${brief[@]}" --speed 4
        run $scene-walk-latency1 $scene walk --strategy $few "${brief[@]}" --query-latency 1
        run $scene-walk-latency2 $scene walk --strategy $few "${brief[@]}" --query-latency 2
        run $scene-walk-pixels $scene walk --strategy bool,simp,coh --size 160x120 --tau 0.25 \
            --repeats 3 --truth-every 0 --no-settled
        run $scene-walk-prefetch $scene walk --strategy coh --prefetch on --repeats 0 --truth-every 0
        run $scene-walk-disk500 $scene walk --strategy coh --prefetch on --repeats 0 \
            --truth-every 0 --no-settled --disk 500MB/s
        run $scene-walk-disk500-off $scene walk --strategy coh --repeats 0 --truth-every 0 \
            --no-settled --disk 500MB/s
    done
    brief=(--frames 60 --repeats 1 --truth-every 10)
    for scene in city torus hospital clinic; do
        inside=$(inside_of $scene)
        outside=$(outside_of $scene)
        strategies=$few
        [ $scene != torus ] || [[ ,$all, != *,auto,* ]] || strategies=$few,auto
        run "$scene-$inside" $scene "$inside" --strategy "$strategies" "${brief[@]}"
        run "$scene-$outside" $scene "$outside" --strategy "$strategies" "${brief[@]}" --no-settled
    done
}

everything() {
    local scene kind speed
    for scene in plant interior lego-show-a city torus hospital clinic; do
        for kind in "$(inside_of $scene)" "$(outside_of $scene)"; do
            for speed in 1 4; do
                run "full-$scene-$kind-speed$speed" $scene "$kind" --strategy "$all" --tau 1,2,4 \
                    --size 640x480,1024x768 --query-latency 0,1,2 --speed $speed --repeats 3
            done
        done
    done
}

# ---- Go

if ! $lists; then
    if [ -z "${PAGODA:-}" ]; then
        say "Building Pagoda"
        tools/install-packages.sh build report
        cmake --preset release -DPAGODA_TESTS=OFF >/dev/null
        cmake --build build-release --target pagoda >&2
    fi
    [ -x "$pagoda" ] || { echo "bench.sh: no program $pagoda; set PAGODA" >&2; exit 1; }
    mkdir -p "$results"
    all=$("$pagoda" bench --help | sed -n 's/.*--strategy TEXT:{\([^}]*\)}.*/\1/p')
fi
case $mode in
quick) quick ;;
centre) centre; variations ;;
full) centre; variations; everything ;;
esac
if ! $lists; then
    python3 tools/bench/summary.py "$results" >"$results/summary.md.part"
    mv "$results/summary.md.part" "$results/summary.md"
    echo "$results/summary.md"
fi
exit $failed
