#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make certify`, on a machine with a device: compares ref/ and gpu/ stage by
# stage and scene by scene, and writes what it found to OUT, whatever it is.
# spec/50_gpu.md §7. Needs BUILD/check-cuda and BUILD/drape made with GPU=yes.
# The reference runs side by side with the device, whose runs take turns. What
# is long goes in segments: the device leaves a checkpoint where each ends, and
# the reference does them at once, each from the one before it; where each ends
# is compared, so that the segments are one run.
# usage: ci/certify.sh BUILD OUT [quick]
set -u
build=$1 out=$2 quick=${3-}
work=$build/certify
rows=$work/rows
rm -rf "$work"
mkdir -p "$work"
export OMP_WAIT_POLICY=passive
cores=$(nproc)
began=$(date +%s)

# A row of the certificate: kind and fields, divided by tabs.
row() { (IFS=$(printf '\t'); echo "$*") >>"$rows"; }
took() { echo "$(($(date +%s) - began)) s: $*"; }

# ---- One run ----

# scene NAME FILE FRAMES [KEYS]: what is to run; KEYS come before the file's.
# FRAMES: so many, all traced; or "A B ... Z": segments to each of these, the
# first and the last traced.
names=
scene() {
    sed "1s/{/{${4-}/" "app/scenes/$2.json" >"$work/$1.json"
    echo "$3" >"$work/$1.frames"
    names="$names $1"
}

# part TO OPTION...: brings the run in $dir to that frame.
part() {
    to=$1
    shift
    rm -rf "$dir" # a run that fails must leave no trace to compare
    after=
    [ "$backend" = gpu ] || after='nice -n 19' # the device is not to wait
    $after "$build/drape" run "$work/$name.json" --backend "$backend" --no-obj \
        --frames "$to" --out "$dir" "$@" >"$dir.log" 2>&1 ||
        tail -n 2 "$dir.log" >&2
}

# The stages' digests of what was traced.
digests() { [ ! -f "$dir/trace.csv" ] || cut -d, -f1-3 "$dir/trace.csv"; }

# How each step after FROM ended: positions, and the report but for its times.
ends() {
    sha256sum "$dir"/frames/cloth_*.ply | awk -v from="$1" '
        { sub(/.*cloth_0*/, "", $2) }
        $2 + 0 > from { print $2 - 1 ",state," $1 }'
    sed -n 's/"seconds": {[^}]*}, //; s/,/;/g; s/^ *{"step": //p' \
        "$dir/report.json" |
        awk -v from="$1" '$1 > from { print $1 - 1 ",report," $0 }'
}

# The state of a checkpoint: what follows the reports, whose times differ.
state() {
    bytes=$(od -An -j16 -N8 -t d8 "$1") reports=$(od -An -j24 -N8 -t d8 "$1")
    tail -c +$((41 + bytes * reports)) "$1" | sha256sum | cut -c1-16
}

# segment FROM TO OPTION...: steps FROM to TO, from the device's checkpoint
segment() {
    from=$1 end=$2 dir=$work/$name-$backend-$2
    shift 2
    [ "$from" = 0 ] || set -- "$@" --resume "$work/$name.$from.drape"
    part "$end" --checkpoint-every "$end" "$@"
    {
        digests
        ends "$from"
        echo "$((end - 1)),checkpoint,$(state "$dir/checkpoint.drape")"
    } >"$dir.lines"
    [ "$backend" = ref ] ||
        mv "$dir/checkpoint.drape" "$work/$name.$end.drape"
    rm -rf "$dir"
    took "$backend: $name to $end" >&2
}

# The reference waits for a checkpoint, until the device's run has ended.
await() {
    until [ "$1" = 0 ] || [ -f "$work/$name.$1.drape" ] ||
        [ -f "$work/$name.gpu" ]; do
        sleep 1
    done
}

# segments "A ... Z" OPTION...: prints what was traced, and how all steps ended
segments() {
    at=0 all=$1 last=${1##* }
    shift
    for next in $all; do
        trace=--trace
        [ "$at" = 0 ] || [ "$next" = "$last" ] || trace=
        # shellcheck disable=SC2086
        if [ "$backend" = ref ]; then
            (await "$at" && segment "$at" "$next" $trace "$@") &
        else
            segment "$at" "$next" $trace "$@"
        fi
        at=$next
    done
    [ "$backend" = gpu ] || wait
    for next in $all; do
        cat "$work/$name-$backend-$next.lines"
    done
}

# run NAME BACKEND FRAMES OPTION...: its digests in NAME.BACKEND
run() {
    name=$1 backend=$2 frames=$3 dir=$work/$1-$2
    shift 3
    case $frames in
    *' '*) segments "$frames" "$@" ;;
    *) part "$frames" --trace "$@" && digests && rm -rf "$dir/frames" ;;
    esac >"$work/lines.$name-$backend"
    mv "$work/lines.$name-$backend" "$work/$name.$backend"
}

frames_of() { cat "$work/$1.frames"; }

# ---- Comparing ----

# same NAME WHAT STEPS TRACED FILE FILE: counts the lines that differ
same() {
    different=$(diff "$5" "$6" | grep -c '^[<>]')
    each=$(sed -n 's/.*"steps_per_frame": \([0-9]*\).*/\1/p' "$work/$1.json")
    each=${each:-1}
    grep -v '^step,' "$5" | cut -d, -f1 | sort -un >"$work/steps"
    grep -v '^step,\|,state,\|,report,\|,checkpoint,' "$5" >"$work/traced"
    steps=$(wc -l <"$work/steps") stages=$(wc -l <"$work/traced")
    traced=$(cut -d, -f1 "$work/traced" | uniq | wc -l)
    # a trace that is empty, or ends early, proves nothing
    [ "$steps $traced" = "$(($3 * each)) $(($4 * each))" ] ||
        different=$((different + 1))
    echo "$1, $2: $steps steps, $traced traced, $stages stages," \
        "$different different"
    row scene "$1" "$2" "$steps" "$traced" "$stages" "$different" \
        "$(sha256sum <"$5" | cut -c1-16)" \
        "$(awk -F, '$1 == "step" || $1 < 6' "$5" | sha256sum | cut -c1-16)"
}

# both NAME: what ref/ and gpu/ gave
both() {
    before=0 last=0
    for to in $(frames_of "$1"); do
        before=$last last=$to
    done
    traced=$(frames_of "$1" | awk -v z="$last" -v y="$before" \
        '{ print (NF > 1 ? $1 + z - y : z) }')
    same "$1" 'ref and gpu' "$last" "$traced" "$work/$1.ref" "$work/$1.gpu"
}

# again NAME FRAMES: run to run, with other block sizes, after a checkpoint
again() {
    first=$work/$1.first half=$(($2 / 2))
    cp "$work/$1.gpu" "$first"
    for block in 0 64 96; do
        run "$1" gpu "$2" --block $block
        same "$1" "gpu again, block $block" "$2" "$2" "$first" "$work/$1.gpu"
    done
    run "$1" gpu $half --checkpoint-every $half
    cp "$work/$1-gpu/checkpoint.drape" "$work/checkpoint.drape"
    run "$1" gpu "$2" --resume "$work/checkpoint.drape"
    tail -n +2 "$work/$1.gpu" >"$work/after"
    awk -F, -v from=$half '$1 != "step" && $1 >= from' "$first" \
        >"$work/unbroken"
    same "$1" 'after a checkpoint' $(($2 - half)) $(($2 - half)) \
        "$work/unbroken" "$work/after"
    mv "$first" "$work/$1.gpu"
}

# references SHARE NAME...: one after another, on that many of 16 processors
references() {
    threads=$((cores * $1 / 16))
    shift
    for name; do
        run "$name" ref "$(frames_of "$name")" \
            --threads $((threads > 0 ? threads : 1))
        took "reference of $name"
    done
}

# Small cases of every stage in $work/names under a tool of compute-sanitizer,
# some side by side. A tool that could not attach ends well, without a summary.
# racecheck takes 5 s for each kernel of a team of 16 blocks: it gets smaller
# ones, of one block, and in multigrid of two. No tool knows graphs with loops:
# the same kernels are launched by the host.
sanitize() {
    ranks='' teams=''
    if [ "$1" = racecheck ]; then
        ranks='--ranks 1' teams='; teams of one block, in multigrid of two'
    fi
    xargs <"$work/names" -P 4 -I STAGE sh -c "
        ranks='$ranks'
        [ STAGE != multigrid ] || ranks=\${ranks:+--ranks 2}
        timeout 240 compute-sanitizer --tool $1 --error-exitcode 9 \
            $build/check-cuda --only STAGE --cases 1 --gpu --hosted \
            \$ranks \
            >$work/$1-STAGE.log 2>&1 &&
            grep -Eq 'SUMMARY: (.*\()?0 errors' $work/$1-STAGE.log ||
            echo STAGE" >"$work/$1"
    [ -s "$work/names" ] || echo 'no stage' >"$work/$1"
    failed=$(tr '\n' ' ' <"$work/$1")
    found=${failed:-clean, $(wc -l <"$work/names") stages}$teams
    echo "$1: $found"
    row sanitizer "$1" "$(wc -l <"$work/$1")" "$found"
}

# ---- What is compared ----

row toolkit "$(nvcc --version | sed -n 's/.*release \([0-9.]*\).*/\1/p')"
row driver "$(nvidia-smi --query-gpu=driver_version --format=csv,noheader |
    head -n 1)"
for part in spec ref gpu flags; do
    row tree $part "$(sh ci/tree.sh $part)"
done

long=120 parted='6 18 30 42 54 66 78 90 102 114 120'
[ ! "$quick" ] || long=2 parted='1 2 3 4'
scene tiny tiny 6
scene tiny64 tiny 6 '"precision": 64,'
# Thousands of stages a step: tracing them all takes the device minutes more.
for method in rk4 midpoint verlet euler; do
    scene "lion_20k_$method" lion_20k "$parted" "\"integrator\": \"$method\","
done
for method in baraff-witkin choi-ko; do
    scene "lion_20k_$method" lion_20k $long "\"integrator\": \"$method\","
done
scene lion_20k_64 lion_20k 30 '"precision": 64,'
scene lion_20k_jacobi lion_20k 30 '"precond": "jacobi", "matrix": "cdf",'
small='funnel twist curtain flag'
for name in $small; do
    scene "$name" "$name" 20
done
# thrown so hard, and so little allowed, that zones and rollback are at work
scene thrown lion_20k 8 \
    '"max_slices": 1, "max_rounds": 2, "gravity": [0, -900, 0],'
large=
[ "$quick" ] || large='buddha_500k buddha_2m'
[ "$quick" ] || scene buddha_500k buddha_500k 10
[ "$quick" ] || scene buddha_2m buddha_2m 4

# A substep of 20K is too little for threads; 2M is not.
# shellcheck disable=SC2086
{
    for method in rk4 midpoint verlet euler; do
        references 1 lion_20k_$method &
    done
    references 4 lion_20k_baraff-witkin lion_20k_choi-ko lion_20k_64 \
        lion_20k_jacobi &
    references 8 $large $small thrown tiny tiny64 &
}
"$build/check-cuda" --certify fuzz/corpus >"$work/stages" ||
    echo "check-cuda ended with $?"
tail -n 1 "$work/stages"
sed -n 's/^device /device\t/p; s/^stage \(.*\) \(.*\) \(.*\) \(.*\) \(.*\)/stage\t\1\t\2\t\3\t\4\t\5/p' \
    "$work/stages" >>"$rows"
took stages
for name in $names; do
    run "$name" gpu "$(frames_of "$name")"
done
again lion_20k_baraff-witkin $long
took 'runs of the device'

sed -n 's/^STAGE(\(.*\),.*/\1/p' spec/stages.def >"$work/names"
[ "$quick" ] || for tool in memcheck racecheck initcheck synccheck; do
    sanitize $tool &
done
wait
took 'sanitizers and references'
for name in $names; do
    both "$name"
done
python3 ci/certificate.py write "$rows" "$out"
line=$(python3 ci/certificate.py line "$out")
echo "$line"
case $line in 'NOT CERTIFIED'*) exit 1 ;; esac
