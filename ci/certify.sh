#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make certify`, on a machine with a device: compares ref/ and gpu/ stage by
# stage and scene by scene, and writes what it found to OUT, whatever it is.
# spec/gpu.md §7. Needs BUILD/check-cuda and BUILD/drape made with GPU=yes.
# `reference` makes on any machine what is slow there: digests of what the
# reference computes, in ci/reference.txt. What is in it, of this ref/ and scene,
# is not run again; else the reference runs side by side with the device. ONLY:
# names of the scenes whose reference is run here, if not of all.
# usage: ci/certify.sh BUILD OUT [quick | reference]
set -u
build=$1 out=$2 mode=${3-} known=ci/reference.txt
quick=
[ "$mode" != quick ] || quick=yes
# what runs in the background does not hear Ctrl-C
trap 'trap - TERM; kill 0' INT TERM
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
# FRAMES: so many, all traced; or "A B C": C, to A and from B on traced.
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
    polite=
    [ "$backend" = gpu ] || polite='nice -n 19' # the device goes first
    $polite "$build/drape" run "$work/$name.json" --backend "$backend" --no-obj \
        --frames "$to" --out "$dir" "$@" >"$dir.log" 2>&1 ||
        tail -n 2 "$dir.log" >&2
}

# The stages' digests of what was traced last.
digests() { [ ! -f "$dir/trace.csv" ] || cut -d, -f1-3 "$dir/trace.csv"; }

# How each step ended: positions, and the report but for its times.
ends() {
    sha256sum "$dir"/frames/cloth_*.ply |
        awk 'NR > 1 { print NR - 2 ",state," $1 }'
    sed -n 's/"seconds": {[^}]*}, //; s/,/;/g; s/^ *{"step": //p' \
        "$dir/report.json" | awk '{ print $1 - 1 ",report," $0 }'
}

# parts A B C OPTION...: traced to A and from B on, and all ends of steps.
parts() {
    a=$1 b=$2 c=$3
    shift 3
    part "$a" --checkpoint-every "$a" --trace "$@"
    digests
    rm -f "$dir/trace.csv"
    part "$b" --checkpoint-every "$b" --resume "$dir/checkpoint.drape" "$@"
    part "$c" --resume "$dir/checkpoint.drape" --trace "$@"
    digests
    ends
}

# run NAME BACKEND FRAMES OPTION...: its digests in NAME.BACKEND
run() {
    name=$1 backend=$2 frames=$3 dir=$work/$1-$2
    shift 3
    rm -rf "$dir" # a run that fails must leave no trace to compare
    # shellcheck disable=SC2086
    case $frames in
    *' '*) parts $frames "$@" ;;
    *) part "$frames" --trace "$@" && digests ;;
    esac >"$work/$name.$backend"
    rm -rf "$dir/frames"
}

frames_of() { cat "$work/$1.frames"; }

# What a scene's reference depends on, and its digest if that is known.
key() {
    { echo "$tree" && cat "$work/$1.frames" "$work/$1.json"; } |
        sha256sum | cut -c1-16
}
known() { sed -n "s/^$1 $(key "$1") //p" $known 2>/dev/null; }
digest() { sha256sum <"$1" | cut -c1-16; }

# ---- Comparing ----

# wanted NAME: how many frames are run, and how many of them traced
wanted() {
    frames_of "$1" | awk '{ print $NF, (NF > 1 ? $1 + $3 - $2 : $1) }'
}

# count NAME FILE FRAMES TRACED: steps, stages and traced of these lines; false:
# they are not of so many. A trace that is empty, or ends early, proves nothing.
count() {
    each=$(sed -n 's/.*"steps_per_frame": \([0-9]*\).*/\1/p' "$work/$1.json")
    each=${each:-1}
    steps=$(grep -v '^step,' "$2" | cut -d, -f1 | sort -un | wc -l)
    grep -v '^step,\|,state,\|,report,' "$2" >"$work/$1.traced"
    stages=$(wc -l <"$work/$1.traced")
    traced=$(cut -d, -f1 "$work/$1.traced" | uniq | wc -l)
    [ "$steps $traced" = "$(($3 * each)) $(($4 * each))" ]
}

# same NAME WHAT FRAMES TRACED FILE FILE: counts the lines that differ
same() {
    different=$(diff "$5" "$6" | grep -c '^[<>]')
    count "$1" "$5" "$3" "$4" || different=$((different + 1))
    echo "$1, $2: $steps steps, $traced traced, $stages stages," \
        "$different different"
    row scene "$1" "$2" "$steps" "$traced" "$stages" "$different" \
        "$(digest "$5")" \
        "$(awk -F, '$1 == "step" || $1 < 6' "$5" | sha256sum | cut -c1-16)"
}

# both NAME: what ref/ and gpu/ gave. Where only the reference's digest is known,
# all is equal or something is not: ref/ has to run to say what.
both() {
    told=$(known "$1")
    if [ "$told" ]; then
        cp "$work/$1.gpu" "$work/$1.ref"
        [ "$told" = "$(digest "$work/$1.gpu")" ] || echo differs >>"$work/$1.ref"
    fi
    # shellcheck disable=SC2046
    same "$1" 'ref and gpu' $(wanted "$1") "$work/$1.ref" "$work/$1.gpu"
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

# as_graphs NAME FRAMES: steps as graphs, which a trace does without: how each
# ends. That there are any, and what becomes of one cut short, is a test's.
as_graphs() {
    name=$1 backend=gpu dir=$work/$1-gpu
    for how in --trace ''; do
        rm -rf "$dir"
        # shellcheck disable=SC2086
        part "$2" $how
        ends >"$work/ends$how"
    done
    rm -rf "$dir/frames"
    sed -n "s/.*most_iterations.*\"graphs\": \([0-9]*\).*/$1: \1 graphs/p" \
        "$dir/report.json"
    [ -f "$work/tape.log" ] || "$build/check-cuda" --tests --only tape \
        >"$work/tape.log" || echo 'tests/world/tape.c failed' >>"$work/ends"
    same "$1" 'as graphs' "$2" 0 "$work/ends--trace" "$work/ends"
}

# references SHARE NAME...: those that are not known, one after another, on that
# many of 16 processors
references() {
    threads=$((cores * $1 / 16))
    shift
    for name; do
        case " ${ONLY-$name} " in *" $name "*) ;; *) continue ;; esac
        [ ! "$(known "$name")" ] || continue
        run "$name" ref "$(frames_of "$name")" \
            --threads $((threads > 0 ? threads : 1))
        took "reference of $name"
        [ "$mode" != reference ] || remember "$name"
    done
}

# A reference that ended early is not remembered.
remember() {
    # shellcheck disable=SC2046
    count "$1" "$work/$1.ref" $(wanted "$1") &&
        echo "$1 $(key "$1") $(digest "$work/$1.ref")" >>$known
}

# Small cases of every stage in $work/names, and the kernels that explicit
# substeps fuse, under a tool of compute-sanitizer, some side by side. A tool
# that could not attach ends well, without a summary. racecheck takes 5 s for
# each kernel of a team of 16 blocks: it gets smaller ones, of one block, and in
# multigrid of two; `compute-sanitizer --tool racecheck build/check-cuda --only
# multigrid --cases 1 --gpu --hosted`, of 16, takes 90 s by itself. No tool knows
# graphs with loops: the same kernels are launched by the host.
sanitize() {
    ranks='' teams=''
    if [ "$1" = racecheck ]; then
        ranks='--ranks 1' teams='; teams of one block, in multigrid of two'
    fi
    { cat "$work/names" && echo fused; } | xargs -P 4 -I STAGE sh -c "
        ranks='$ranks' mode=--gpu
        [ STAGE != fused ] || mode=--tests
        [ STAGE != multigrid ] || ranks=\${ranks:+--ranks 2}
        timeout 240 compute-sanitizer --tool $1 --error-exitcode 9 \
            $build/check-cuda --only STAGE --cases 1 \$mode --hosted \
            \$ranks \
            >$work/$1-STAGE.log 2>&1 &&
            grep -Eq 'SUMMARY: (.*\()?0 errors' $work/$1-STAGE.log ||
            echo STAGE" >"$work/$1"
    [ -s "$work/names" ] || echo 'no stage' >"$work/$1"
    failed=$(tr '\n' ' ' <"$work/$1")
    found=${failed:-clean, $(wc -l <"$work/names") stages, substeps}$teams
    echo "$1: $found"
    row sanitizer "$1" "$(wc -l <"$work/$1")" "$found"
}

# ---- What is compared ----

tree=$(python3 ci/tree.py ref)
long=120 parted='6 18 24'
[ ! "$quick" ] || long=2 parted='1 2 3'
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
[ "$quick" ] || large='buddha_500k buddha_500k_jacobi buddha_2m'
[ "$quick" ] || scene buddha_500k buddha_500k 10
[ "$quick" ] || scene buddha_500k_jacobi buddha_500k 4 '"precond": "jacobi",'
[ "$quick" ] || scene buddha_2m buddha_2m 4

if [ "$mode" = reference ]; then
    for name in $names; do
        told=$(known "$name")
        [ ! "$told" ] || echo "$name $(key "$name") $told"
    done >"$work/known"
    cp "$work/known" $known
fi

# An explicit method's substeps are most of all there is to do.
# shellcheck disable=SC2086
{
    for method in rk4 midpoint verlet euler; do
        references 4 lion_20k_$method &
    done
    references 4 lion_20k_baraff-witkin lion_20k_choi-ko lion_20k_64 \
        lion_20k_jacobi &
    references 8 $large $small thrown tiny tiny64 &
}
if [ "$mode" = reference ]; then
    wait
    exit
fi

row toolkit "$(nvcc --version | sed -n 's/.*release \([0-9.]*\).*/\1/p')"
row driver "$(nvidia-smi --query-gpu=driver_version --format=csv,noheader |
    head -n 1)"
for part in spec ref gpu flags; do
    row tree $part "$(python3 ci/tree.py $part)"
done
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
for method in baraff-witkin choi-ko; do
    as_graphs lion_20k_$method $long
done
for name in funnel twist; do # what moves there comes and goes
    as_graphs $name $long
done
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
