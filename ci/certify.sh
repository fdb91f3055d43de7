#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make certify`, on a machine with a device: compares ref/ and gpu/ stage by
# stage and scene by scene, and writes what it found to OUT, whatever it is.
# spec/50_gpu.md §7. Needs BUILD/check-cuda and BUILD/drape made with GPU=yes.
# usage: ci/certify.sh BUILD OUT [quick]
set -u
build=$1 out=$2 quick=${3-}
long=${quick:+2}
long=${long:-120}
work=$build/certify
rows=$work/rows
rm -rf "$work"
mkdir -p "$work"
export OMP_WAIT_POLICY=passive
threads=$(nproc)

# A row of the certificate: kind and fields, divided by tabs.
row() { (IFS=$(printf '\t'); echo "$*") >>"$rows"; }

# The stages' digests of a run, from its trace.
digests() { [ ! -f "$1/trace.csv" ] || cut -d, -f1-3 "$1/trace.csv"; }

# run NAME BACKEND OPTION...: one run, its digests in NAME.BACKEND
run() {
    name=$1 backend=$2
    shift 2
    rm -rf "$work/run" # a run that fails must leave no trace to compare
    "$build/drape" run "$work/$name.json" --backend "$backend" --trace \
        --no-obj --out "$work/run" "$@" >"$work/log" 2>&1 ||
        tail -n 2 "$work/log"
    digests "$work/run" >"$work/$name.$backend"
}

# same NAME WHAT FRAMES FILE FILE: counts the lines that differ
same() {
    different=$(diff "$4" "$5" | grep -c '^[<>]')
    stages=$(grep -vc '^step,' "$4")
    steps=$(grep -v '^step,' "$4" | cut -d, -f1 | uniq | wc -l)
    each=$(sed -n 's/.*"steps_per_frame": \([0-9]*\).*/\1/p' "$work/$1.json")
    # a trace that is empty, or ends early, proves nothing
    [ "$steps" -eq $(($3 * ${each:-1})) ] || different=$((different + 1))
    echo "$1, $2: $steps steps, $stages stages, $different different"
    row scene "$1" "$2" "$steps" "$stages" "$different" \
        "$(sha256sum <"$4" | cut -c1-16)" \
        "$(awk -F, '$1 == "step" || $1 < 6' "$4" | sha256sum | cut -c1-16)"
}

# scene NAME FILE FRAMES EDIT: on both backends; EDIT is sed's, of the scene.
scene() {
    name=$1 file=$2 frames=$3
    sed "$4" "app/scenes/$file.json" >"$work/$name.json"
    run "$name" ref --frames "$frames" --threads "$threads"
    run "$name" gpu --frames "$frames"
    same "$name" "ref and gpu" "$frames" "$work/$name.ref" "$work/$name.gpu"
}

# Run to run, with another block size, and after a checkpoint.
again() {
    mv "$work/$1.gpu" "$work/$1.first"
    for block in 0 64 96; do
        run "$1" gpu --frames "$2" --block $block
        same "$1" "gpu again, block $block" "$2" "$work/$1.first" "$work/$1.gpu"
    done
    half=$(($2 / 2))
    run "$1" gpu --frames $half --checkpoint-every $half
    cp "$work/run/checkpoint.drape" "$work/checkpoint.drape"
    run "$1" gpu --frames "$2" --resume "$work/checkpoint.drape"
    tail -n +2 "$work/$1.gpu" >"$work/after"
    awk -F, -v from=$half '$1 != "step" && $1 >= from' "$work/$1.first" \
        >"$work/unbroken"
    same "$1" "after a checkpoint" $(($2 - half)) "$work/unbroken" "$work/after"
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

row toolkit "$(nvcc --version | sed -n 's/.*release \([0-9.]*\).*/\1/p')"
row driver "$(nvidia-smi --query-gpu=driver_version --format=csv,noheader |
    head -n 1)"
for part in spec ref gpu flags; do
    row tree $part "$(sh ci/tree.sh $part)"
done
"$build/check-cuda" --certify fuzz/corpus >"$work/stages" ||
    echo "check-cuda ended with $?"
tail -n 1 "$work/stages"
sed -n 's/^device /device\t/p; s/^stage \(.*\) \(.*\) \(.*\) \(.*\) \(.*\)/stage\t\1\t\2\t\3\t\4\t\5/p' \
    "$work/stages" >>"$rows"

scene tiny tiny 6 ''
scene tiny64 tiny 6 '1s/{/{"precision": 64,/'
for integrator in baraff-witkin choi-ko; do
    scene "lion_20k_$integrator" lion_20k $long \
        "1s/{/{\"integrator\": \"$integrator\",/"
done
again lion_20k_baraff-witkin $long
for integrator in euler midpoint verlet rk4; do # hundreds of substeps each
    scene "lion_20k_$integrator" lion_20k 2 \
        "1s/{/{\"integrator\": \"$integrator\",/"
done
scene lion_20k_64 lion_20k 30 '1s/{/{"precision": 64,/'
scene lion_20k_jacobi lion_20k 30 \
    '1s/{/{"precond": "jacobi", "matrix": "cdf",/'
for name in funnel twist curtain flag; do
    scene $name $name 20 ''
done
# thrown so hard, and so little allowed, that zones and rollback are at work
scene thrown lion_20k 8 \
    '1s/{/{"max_slices": 1, "max_rounds": 2, "gravity": [0, -900, 0],/'
[ "$quick" ] || scene buddha_500k buddha_500k 10 ''
[ "$quick" ] || scene buddha_2m buddha_2m 4 ''
sed -n 's/^STAGE(\(.*\),.*/\1/p' spec/stages.def >"$work/names"
[ "$quick" ] || for tool in memcheck racecheck initcheck synccheck; do
    sanitize $tool &
done
wait
python3 ci/certificate.py write "$rows" "$out"
line=$(python3 ci/certificate.py line "$out")
echo "$line"
case $line in 'NOT CERTIFIED'*) exit 1 ;; esac
