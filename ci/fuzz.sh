#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: ci/fuzz.sh BUILD               replays every corpus
#        ci/fuzz.sh BUILD STAGE SECONDS fuzzes one; finds go to its corpus
# Beside the stages: api (whole steps), vf and ee (queries against the oracles)
# and, where the tool is built, its readers of scenes and meshes. KERNELS=
# leaves the emulated kernels without sanitizers, for the time they take to
# compile.
set -eu
build=$1 stage=${2-} seconds=${3-60}
readers=
[ ! -x "$build/drape" ] || readers='scene mesh'
targets="api vf ee $readers $(sed -n 's/^STAGE(\([a-z0-9_]*\),.*/\1/p' spec/stages.def)"

if [ -n "$stage" ]; then
    # shellcheck disable=SC2086
    printf '%s\n' $targets | grep -qx "$stage" || {
        echo "no target '$stage'; there are:" $targets >&2
        exit 2
    }
    out=$build/fuzz kernels=$build/fuzz
    [ "${KERNELS-yes}" ] || {
        make -s BUILD="$build" "$build/check"
        kernels=$build
    }
    san='-fsanitize=address,undefined,fuzzer-no-link'
    make -s ROOT="$build" BUILD="$out" CC=clang CXX=clang++ WARN=-w \
        EMU_IN="$kernels" OPT='-O1 -g1' OPENMP= SAN="$san" "$out/parts.a"
    clang -std=c17 -O1 -g -I. -DTARGET="\"$stage\"" \
        -fsanitize=address,undefined,fuzzer-no-link -c fuzz/target.c \
        -o "$out/$stage.o"
    # by clang++, as the emulated device's C++ has checks of its own
    # shellcheck disable=SC2046
    clang++ -fsanitize=address,undefined,fuzzer "$out/$stage.o" \
        "$out/parts.a" $(make -s fuzz-libs) -o "$out/$stage"
    mkdir -p "fuzz/corpus/$stage" "$out/found-$stage"
    "$out/$stage" -max_total_time="$seconds" -max_len=4096 -timeout=60 \
        -artifact_prefix="$out/$stage-" "$out/found-$stage" \
        "fuzz/corpus/$stage"
    "$out/$stage" -merge=1 -max_len=4096 "fuzz/corpus/$stage" \
        "$out/found-$stage"
    exit
fi

make -s BUILD="$build" "$build/replay"
passed=0 failed=0
for s in $targets; do
    set -- fuzz/corpus/"$s"/*
    [ -e "$1" ] || {
        echo "FAILED fuzz/corpus/$s holds nothing"
        failed=$((failed + 1))
        continue
    }
    line=$("$build/replay" "$s" "$@" | tee /dev/stderr | tail -n 1) || :
    set -- $(echo "$line" | tr -dc '0-9 ')
    passed=$((passed + $1)) failed=$((failed + $2))
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
