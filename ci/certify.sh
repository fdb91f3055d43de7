#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make certify`, on a machine with a device: compares ref/ and gpu/ stage by
# stage and scene by scene, and writes the findings to OUT, good or bad. Rows of
# OUT whose code has not changed are kept, all others run (ci/certificate.py).
# What is found is written part by part, so that a run that is cut short can be
# gone on with.
# See spec/gpu.md §7. Needs BUILD/check-cuda and BUILD/drape made with GPU=yes.
# `reference` computes on any machine the digests of the reference's scenes that
# ci/reference.txt does not have yet. A scene that is missing there runs beside
# the device. The environment may give COMMIT, where there is no git, and ONLY,
# the names of the scenes whose reference runs.
# usage: ci/certify.sh BUILD OUT [reference]
set -u
build=$1 out=$2 mode=${3-} known=ci/reference.txt scenes=ci/scenes.certified
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

# All scenes: $work/NAME.json, and its frames in $work/NAME.frames.
grep -v '^#' $scenes >"$work/table"
while read -r name file frames _ _ keys; do
    sed "1s/{/{$keys/" "app/scenes/$file.json" >"$work/$name.json"
    echo "$frames" | tr - ' ' >"$work/$name.frames"
done <"$work/table"

# A scene names its patterns from its own folder: app/scenes, or app/patterns.
mkdir -p "$build/patterns"
cp app/patterns/*.json "$build/patterns"
cp app/patterns/*.json "$work"

# also NAME WHAT: whether ci/scenes.certified asks for that of a scene.
also() {
    awk -v name="$1" -v what="$2" '$1 == name && $5 == what { found = 1 }
        END { exit !found }' "$work/table"
}

# part TO OPTION...: brings the run in $dir to that frame.
part() {
    to=$1
    shift
    polite=
    [ "$backend" = gpu ] || polite='nice -n 19' # the device goes first
    verb='run --no-obj'
    ! also "$name" sew || verb='sew --no-picture'
    # shellcheck disable=SC2086
    $polite "$build/drape" $verb "$work/$name.json" --backend "$backend" \
        --frames "$to" --out "$dir" "$@" >"$dir.log" 2>&1 ||
        tail -n 2 "$dir.log" >&2
}

# The stages' digests of what was traced last.
digests() { [ ! -f "$dir/trace.csv" ] || cut -d, -f1-3 "$dir/trace.csv"; }

# How each step ended: positions, and the report but for its times.
ends() {
    sha256sum "$dir"/frames/cloth_*.ply |
        awk 'NR > 1 { print NR - 2 ",state," $1 }'
    sed -n 's/"graphs": [0-9]*, //; s/"seconds": {[^}]*}, //; s/,/;/g
        s/^ *{"step": //p' "$dir/report.json" |
        awk '{ print $1 - 1 ",report," $0 }'
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

# The patterns that a scene names.
patterns_of() {
    sed -n 's/.*"pattern": "\([^"]*\)".*/\1/p' "$work/$1.json" | sort -u |
        while read -r file; do cat "$work/$file"; done
}

# What a scene's reference depends on, and its digest if that is known.
key() {
    { echo "$tree" && cat "$work/$1.frames" "$work/$1.json" && patterns_of "$1"
        ! also "$1" sew || cat app/scene/sewing.c; } | sha256sum | cut -c1-16
}
known() { sed -n "s/^$1 $(key "$1") //p" $known 2>/dev/null; }
digest() { sha256sum <"$1" | cut -c1-16; }

# expected NAME: how many frames are run, and how many of them traced
expected() {
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

# both NAME: the results of ref/ and gpu/. Where only the reference's digest is
# known, all is equal or something is not: ref/ has to run to say which line.
both() {
    told=$(known "$1")
    if [ "$told" ]; then
        cp "$work/$1.gpu" "$work/$1.ref"
        [ "$told" = "$(digest "$work/$1.gpu")" ] || echo differs >>"$work/$1.ref"
    fi
    # shellcheck disable=SC2046
    same "$1" 'ref and gpu' $(expected "$1") "$work/$1.ref" "$work/$1.gpu"
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

# A reference that ended early is not remembered.
remember() {
    # shellcheck disable=SC2046
    count "$1" "$work/$1.ref" $(expected "$1") &&
        echo "$1 $(key "$1") $(digest "$work/$1.ref")" >>$known
}

# references LANE: its scenes whose digest is not known, one after another
references() {
    threads=$((cores * ${1#?} / 16))
    awk -v lane="$1" 'NR == FNR { runs[$1]; next }
        $4 == lane && $1 in runs { print $1 }' \
        "$work/scenes" "$work/table" >"$work/lane-$1"
    while read -r scene; do
        case " ${ONLY-$scene} " in *" $scene "*) ;; *) continue ;; esac
        [ ! "$(known "$scene")" ] || continue
        run "$scene" ref "$(frames_of "$scene")" \
            --threads $((threads > 0 ? threads : 1)) </dev/null
        took "reference of $scene"
        [ "$mode" != reference ] || remember "$scene"
    done <"$work/lane-$1"
}
all_references() {
    lanes=$(awk '{ print $4 }' "$work/table" | sort -u)
    for lane in $lanes; do
        references "$lane" &
    done
}

# sanitize TOOL: small cases of each stage in $work/TOOL, and the kernels that
# explicit substeps fuse, under a tool of compute-sanitizer, four side by side.
# A tool that could not attach ends well, without a summary. racecheck takes 5 s
# for each kernel of a team of 16 blocks, so its teams are of one block, and in
# multigrid of two; `compute-sanitizer --tool racecheck build/check-cuda --only
# multigrid --cases 1 --gpu --hosted`, of 16, takes 90 s by itself. No tool knows
# graphs with loops: the same kernels are launched by the host.
sanitize() {
    ranks=
    [ "$1" != racecheck ] || ranks='--ranks 1'
    xargs -P 4 -I STAGE sh -c "
        ranks='$ranks' mode=--gpu status=1
        [ STAGE != fused ] || mode=--tests
        [ STAGE != multigrid ] || ranks=\${ranks:+--ranks 2}
        timeout 240 compute-sanitizer --tool $1 --error-exitcode 9 \
            $build/check-cuda --only STAGE --cases 1 \$mode --hosted \$ranks \
            >$work/$1-STAGE.log 2>&1 &&
            grep -Eq 'SUMMARY: (.*\()?0 errors' $work/$1-STAGE.log && status=0
        printf 'sanitizer\t$1\tSTAGE\t%s\n' \$status" <"$work/$1" \
        >"$work/$1.rows"
    cat "$work/$1.rows" >>"$rows"
    echo "$1: $(wc -l <"$work/$1") run, not clean:" \
        "$(awk '$4 { printf " %s", $3 }' "$work/$1.rows")"
}

save() { python3 ci/certificate.py write "$work" "$out"; }

tree=$(python3 ci/tree.py ref)
if [ "$mode" = reference ]; then
    cut -d' ' -f1 "$work/table" >"$work/scenes"
    while read -r name; do
        told=$(known "$name")
        [ ! "$told" ] || echo "$name $(key "$name") $told"
    done <"$work/scenes" >"$work/known"
    cp "$work/known" $known
    all_references
    wait
    exit
fi

row date "$(date -u +%Y-%m-%d)"
row commit "${COMMIT:-$(git describe --always --dirty 2>/dev/null)}"
row device "$(nvidia-smi --query-gpu=name --format=csv,noheader | head -n 1)"
row toolkit "$(nvcc --version | sed -n 's/.*release \([0-9.]*\).*/\1/p')"
row driver "$(nvidia-smi --query-gpu=driver_version --format=csv,noheader |
    head -n 1)"
# A row names the recorded hash of its stage, so that must be this tree's.
"$build/check-cuda" --golden tests/golden/stages.txt >"$work/golden" || {
    grep FAILED "$work/golden"
    exit 1
}
python3 ci/certificate.py plan "$work" "$out" "$build" || exit 1

all_references
make -s BUILD="$build" corpus
while read -r stage; do
    "$build/check-cuda" --certify "$build/corpus" --only "$stage" \
        >>"$work/certify.log" </dev/null || echo "$stage differs"
done <"$work/stages"
sed -n 's/^\(stage\) \(.*\) \(.*\) \(.*\) \(.*\) \(.*\)/\1\t\2\t\3\t\4\t\5\t\6/p' \
    "$work/certify.log" >>"$rows" 2>/dev/null
took stages
save
while read -r scene; do
    run "$scene" gpu "$(frames_of "$scene")" </dev/null
    ! also "$scene" again ||
        again "$scene" "$(frames_of "$scene")" </dev/null
done <"$work/scenes"
took 'runs of the device'
while read -r scene; do
    [ ! "$(known "$scene")" ] || both "$scene"
done <"$work/scenes"
save
for tool in memcheck racecheck initcheck synccheck; do
    sanitize $tool &
done
wait
took 'sanitizers and references'
while read -r scene; do
    [ "$(known "$scene")" ] || both "$scene"
done <"$work/scenes"
save
line=$(python3 ci/certificate.py line "$out")
echo "$line"
case $line in 'NOT CERTIFIED'*) exit 1 ;; esac
