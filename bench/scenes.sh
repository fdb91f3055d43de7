#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs the paper's scenes, and scenes rich in contact, for bench/tables.py. Results that are in WORK are
# not made again, so a call that reached its limit can be repeated to go on.
# usage: [NAME=VALUE...] bench/scenes.sh BUILD WORK
#   SCENES         the paper's nine by default, e.g. "buddha_20k lion_2m"
#   CONTACT        scenes for the table of contact, in mode ours alone; default,
#                  where SCENES is not given: layers, funnel and balls
#   FRAMES   120   of each scene, 1/60 s each
#   MODES    "ours jacobi cdf paper": how the linear systems are solved
#   SHORT    30    frames of the modes other than ours
#   EVERY    10    every EVERY-th frame is kept and audited
#   STEPS    2     steps of the reference from the state of frame 2/3 FRAMES
#   THREADS        of the reference; default: 1, and the number of processors
#   LIMIT          s after which nothing new starts and a run stops in order
#   BACKEND  gpu   ref: try this script where there is no device
# Writes reports, audits, memory and machine to WORK/results, which is small,
# and frames and checkpoints to WORK/runs. The exit status is 3 at the limit.
set -u
build=$1 work=$2
nine='buddha_20k lion_20k dragon_20k buddha_500k lion_500k dragon_500k buddha_2m
lion_2m dragon_2m'
rich='layers_2 layers_4 layers_8 funnel_540k ball_past ball_stops leaves'
if [ -z "${SCENES+given}${CONTACT+given}" ]; then
    scenes=$nine contact=$rich
else
    scenes=${SCENES-} contact=${CONTACT-}
fi
frames=${FRAMES:-120} short=${SHORT:-30} every=${EVERY:-10} steps=${STEPS:-2}
cores=$(nproc)
threads=${THREADS:-1 $cores}
backend=${BACKEND:-gpu}
modes=${MODES:-ours jacobi cdf paper}
draped=$((frames * 2 / 3 / every * every))
end=$(($(date +%s) + ${LIMIT:-1000000}))
runs=$work/runs results=$work/results
failed=0
mkdir -p "$runs" "$results"

row() { printf '%s\t%s\n' "$1" "$2"; }
ask() { nvidia-smi --query-gpu="$1" --format=csv,noheader,nounits | head -n 1; }
trees() {
    for part in spec ref gpu; do
        row "tree $part" "$(python3 ci/tree.py $part)"
    done
}
describe() {
    row backend "$backend"
    row cpu "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)"
    row cores "$cores"
    if command -v nvidia-smi >/dev/null; then
        row gpu "$(ask name)"
        row driver "$(ask driver_version)"
    fi
    row date "$(date -u +%Y-%m-%d)"
    trees
}
if [ ! -f "$results/machine" ]; then
    describe >"$results/machine"
elif [ "$(trees)" != "$(grep '^tree' "$results/machine")" ]; then
    echo "$work holds runs of another tree: remove it, or name another" >&2
    exit 2
fi

# keys MODE: prints the keys that a mode adds to the first line of a scene.
keys() {
    case $1 in
    ours | start) ;;
    jacobi) echo '"precond": "jacobi",' ;;
    cdf) echo '"precond": "jacobi", "matrix": "cdf",' ;;
    paper) echo '"precond": "jacobi", "matrix": "cdf", "solver": "cublas",' ;;
    explicit) echo '"integrator": "rk4", "dt": 0.0010416666666666667,' ;;
    *) echo "no mode $1" >&2 ;;
    esac
}

say() { printf '%s %s\n' "$(date +%H:%M:%S)" "$*"; }
stop() {
    say "stopped at the limit of ${LIMIT:-} s: call it again to go on"
    exit 3
}
left() { echo $((end - $(date +%s))); }

# tool ARGUMENTS...: runs drape within the time limit. Ends this script if drape
# was interrupted; counts a failure if it failed.
tool() {
    [ "$(left)" -gt 0 ] || stop
    # In the foreground drape gets one signal; a second one would kill it.
    timeout --foreground -s INT -k 60 "$(left)" "$build/drape" "$@" \
        >"$work/log" 2>&1
    status=$?
    case $status in
    124 | 130 | 137) stop ;;
    0 | 1) return 0 ;; # 1: a step was not clean, as the report says
    esac
    say "failed: drape $*"
    tail -n 1 "$work/log"
    failed=$((failed + 1))
    return 1
}

# number NAME REPORT: prints the first number of that name.
number() { sed -n "s/.*\"$1\": \([0-9][0-9]*\).*/\1/p" "$2" | head -n 1; }
# has REPORT FRAMES: whether the run has so many frames, or has diverged.
has() {
    [ -f "$1" ] || return 1
    ! grep -q '"end": "diverged"' "$1" || return 0
    [ "$(number steps "$1")" -ge $(($2 * $(number steps_per_frame "$1"))) ]
}

# watch FILE: appends the device's memory in use, MiB, once before a run and
# then every second.
watch() {
    ! command -v nvidia-smi >/dev/null || while :; do
        ask memory.used >>"$1"
        sleep 1 # seldom, since each query holds up the device
    done
}

# Runs however this script ends: collects the reports so far and ends the
# watcher.
collect() {
    kill "$watcher" 2>/dev/null
    for report in "$runs"/*/report.json; do
        run=${report%/*}
        ! grep -qs '"end": "[^u]' "$report" ||
            cp "$report" "$results/${run##*/}.json"
    done
}
watcher=
trap collect EXIT
trap 'exit 3' INT TERM

# go SCENE MODE FRAMES: continues this run until it has so many frames.
go() {
    run=$runs/$1.$2
    ! has "$run/report.json" "$3" || return 0
    sed "1s/{/{$(keys "$2")/" "app/scenes/$1.json" >"$run.json"
    set -- "$run.json" --backend "$backend" --frames "$3" --out "$run" \
        --every "$every" --checkpoint-every "$every" --no-obj
    if [ -f "$run/checkpoint.drape" ]; then
        set -- "$@" --resume "$run/checkpoint.drape"
    else
        set -- "$@" --force # a killed run may have left files
    fi
    watch "$results/${run##*/}.memory" &
    watcher=$!
    sleep 0.5
    tool run "$@"
    kill "$watcher" 2>/dev/null
}

# ours SCENE: runs the mode `ours`, and keeps a checkpoint of the draped state,
# from which the reference goes on.
ours() {
    if [ $draped -gt 0 ] && [ ! -f "$runs/$1.draped" ]; then
        go "$1" ours $draped
        cp "$runs/$1.ours/checkpoint.drape" "$runs/$1.draped" || return
        number steps "$runs/$1.ours/report.json" >"$runs/$1.from"
    fi
    go "$1" ours "$frames"
}

# explicit SCENE: runs three explicit steps, for their time and memory. They are
# of 1/960 s, as a step of 1/60 s at 2M takes a minute and more substeps
# (172665) than are allowed. Also runs `ours` for 0 frames: what collisions fill
# after the start they would fill in an explicit run too.
explicit() {
    few=3
    [ "$backend" = gpu ] || few=0 # the reference takes hours at 2M
    go "$1" explicit $few
    go "$1" start 0
    rm -rf "$runs/$1.explicit/frames" "$runs/$1.start/frames"
}

# reference SCENE THREADS: runs STEPS steps on the reference from the draped
# state.
reference() {
    twin=$runs/$1.ref$2
    [ -f "$runs/$1.draped" ] || return 0
    to=$(($(cat "$runs/$1.from") + steps))
    ! has "$twin/report.json" $to || return 0
    sed '/steps_per_frame/d' "$runs/$1.ours.json" >"$twin.json"
    tool run "$twin.json" --backend ref --threads "$2" --frames $to --no-obj \
        --resume "$runs/$1.draped" --every 1000000 --out "$twin" --force
}

# Audits every frame of `ours` that was kept and not audited yet, in parallel.
audits() {
    for name in $scenes $contact; do
        for frame in "$runs/$name.ours"/frames/cloth_*.ply; do
            [ -f "${frame%.ply}.audit" ] || echo "$frame"
        done
    done >"$work/frames"
    # shellcheck disable=SC2016
    xargs <"$work/frames" -P "$cores" -I FRAME timeout "$(left)" sh -c '
        led=${1%/frames/*}/obstacles.ply
        [ -f "$led" ] || led=$(echo "$1" | sed "s/cloth_\([0-9]*.ply\)$/obstacles_\1/")
        "$0" audit "$1" --obstacle "$led" >"$1.part"
        [ $? -gt 1 ] || mv "$1.part" "${1%.ply}.audit"' "$build/drape" FRAME
}

for name in $scenes; do
    for mode in $modes; do
        case $mode$backend in
        paperref) say "$name: mode paper needs a device" && continue ;;
        ours*) say "$name, ours" && ours "$name" ;;
        *) say "$name, $mode" && go "$name" "$mode" "$short" ;;
        esac
    done
    say "$name, explicit and reference"
    explicit "$name"
    for n in $threads; do
        reference "$name" "$n"
    done
done
echo "$contact" >"$results/contact"
for name in $contact; do
    say "$name, of contact"
    ours "$name"
done
[ "$(left)" -gt 0 ] || stop
say 'audits, side by side'
audits
[ "$(left)" -gt 0 ] || stop
for name in $scenes $contact; do
    cat "$runs/$name.ours"/frames/*.audit >"$results/$name.audit"
    grep ' [1-9][0-9]* intersecting' "$results/$name.audit" &&
        failed=$((failed + 1))
    for frame in "$runs/$name.ours"/frames/cloth_*.ply; do
        if [ -f "$frame" ] && [ ! -f "${frame%.ply}.audit" ]; then
            say "not audited: $frame"
            failed=$((failed + 1))
        fi
    done
done
say "$failed failed"
[ $failed -eq 0 ]
