#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds one flavour of ci/flavours.mk (another compiler or other flags) and
# compares it with the normal build: the same digests of every stage of every
# step of the scenes of tests/whole, the same files from the tool, and the
# recorded hashes of all stages.
# NAME root tests the normal build itself: its scenes must have every outcome.
# usage: ci/flavour.sh BUILD NAME [KERNELS]; ends with `N passed, N failed`
set -u
root=$1 flavour=$2 kernels=${3-}
[ "$flavour" = root ] && build=$root || build=$root/$flavour
work=$root/flavour-$flavour
log=$work.log
lines=$root/whole.txt
. ci/ok.sh
rm -rf "$work"
mkdir -p "$work"
export OMP_WAIT_POLICY=passive

# A sanitizer's error ends the program with a status that no program here uses.
export ASAN_OPTIONS=exitcode=66
export UBSAN_OPTIONS=print_stacktrace=1:exitcode=66
export TSAN_OPTIONS=exitcode=66
export MSAN_OPTIONS=exitcode=66
case $flavour in
tsan) # what libomp orders, archer tells TSan
    archer=$(clang -print-file-name=libarcher.so)
    export OMP_TOOL_LIBRARIES="$archer"
    export TSAN_OPTIONS="$TSAN_OPTIONS ignore_noninstrumented_modules=1"
    ;;
esac

# whole ARGUMENTS: runs the small scenes and prints the first lines that differ.
whole() {
    "$build/whole" "$@" >"$work/whole.txt" || return 1
    [ -s "$lines" ] || return 1
    cmp "$work/whole.txt" "$lines" && return 0
    diff "$lines" "$work/whole.txt" | head -n 8
    return 1
}

# The scenes must have every outcome of a step, or zones, rollback or sleep would
# not be tested; the large one that is there for zones must have them, and the one
# that is there for slices must be cut.
outcomes() {
    awk '$3 == "step" && $5 == 0 { seen[$6] }
        $1 == "larger" && $3 == "step" && int($6 / 2) % 2 { zones = 1 }
        $1 == "sliced" && $3 == "step" && $7 > 2 { slices = 1 }
        END {
            if (!zones || !slices) {
                print "larger has no zones, or sliced no slices"
                bad = 1
            }
            for (o in seen)
                for (bit = 1; bit <= 32; bit *= 2)
                    if (int(o / bit) % 2) found[bit]
            for (bit = 1; bit <= 32; bit *= 2)
                if (!(bit in found)) {
                    print "no step has outcome " bit
                    bad = 1
                }
            exit bad || !(0 in seen)
        }' "$lines"
}

# runs TOOL DIR: runs a scene that uses most files of the tool, and keeps its
# output without the times, which the checkpoint has too.
runs() {
    "$1" run tests/whole/tool.json --trace --threads 2 --checkpoint-every 2 \
        --out "$2" >/dev/null 2>&1 || return 1
    cut -d, -f1-3 "$2/trace.csv" >"$2/trace"
    grep -v '"integration"\|seconds' "$2/report.json" >"$2/report"
    rm "$2/trace.csv" "$2/report.json" "$2/checkpoint.drape"
    "$1" plan tests/whole/tool.json >"$2/plan" &&
        "$1" audit "$2/frames/cloth_0002.ply" \
            --obstacle "$2/frames/obstacles_0002.ply" |
        tail -n 1 | sed "s:$2::g" >"$2/audit" &&
        "$1" render "$2" --frame 2 --width 64 --height 48 --samples 1 \
            --no-film >/dev/null
}
tool() {
    rm -rf "$work/wanted" "$work/got"
    runs "$root/drape" "$work/wanted" && runs "$build/drape" "$work/got" &&
        [ -s "$work/got/frames/cloth_0002.ply" ] &&
        [ -s "$work/got/pictures/frame_0002.png" ] &&
        [ -s "$work/got/audit" ] && diff -r "$work/wanted" "$work/got"
}

golden() {
    # shellcheck disable=SC2086
    "$build/check" --plain --golden tests/golden/stages.txt "$@"
}

case $flavour in
root)
    ok 'every outcome is there' outcomes
    ok 'whole scenes, 3 threads' whole --threads 3
    ok 'whole scenes, two at a time' whole --jobs 2
    ;;
*)
    ok "make $flavour" make ROOT="$root" BUILD="$root" KERNELS="$kernels" \
        "$flavour"
    ;;
esac
case $flavour in
gcc-O0)
    ok 'whole scenes' whole
    ok 'recorded hashes' golden
    ;;
clang-O0) # with its kernels; those of explicit steps by a test
    ok 'whole scenes' whole
    ok 'explicit steps of kernels' "$build/check" --cases 1 --tests --only fused
    ok 'recorded hashes' golden --gpu
    ;;
gcc-O3 | clang-O2 | clang-O3)
    ok 'whole scenes, 2 threads' whole --threads 2
    ok 'recorded hashes' golden
    ;;
asan)
    ok 'whole scenes, 2 threads' whole --threads 2
    ok 'stages' "$build/check" --cases 1 --stages --self-test \
        ${kernels:+--gpu}
    [ ! -x "$build/drape" ] || ok tool sh tests/app.sh "$build/drape" brief
    ;;
tsan)
    ok 'two threads of the caller, with worlds of four threads' \
        whole --jobs 2 --threads 4
    ;;
msan) ok 'whole scenes' whole ;;
esac
case $flavour in
gcc-O3 | clang-O0) [ ! -x "$build/drape" ] || ok 'the tool' tool ;;
esac
rm -rf "$work" "$log"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
