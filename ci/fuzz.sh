#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: ci/fuzz.sh BUILD               replays every corpus, `api` too
#        ci/fuzz.sh BUILD STAGE SECONDS fuzzes one; finds go to its corpus
set -eu
build=$1 stage=${2-} seconds=${3-60}
targets="api $(sed -n 's/^STAGE(\([a-z0-9_]*\),.*/\1/p' spec/stages.def)"

if [ -n "$stage" ]; then
    echo "$targets" | grep -qx "$stage" || {
        echo "no target '$stage'; there are:" $targets >&2
        exit 2
    }
    out=$build/fuzz
    san='-fsanitize=address,undefined,fuzzer-no-link'
    make -s ROOT="$build" BUILD="$out" CC=clang OPT='-O1 -g' OPENMP= \
        SAN="$san" "$out/parts.a"
    clang -std=c17 -O1 -g -I. -Ispec -DTARGET="\"$stage\"" \
        -fsanitize=address,undefined,fuzzer fuzz/target.c \
        "$out/parts.a" $(make -s oracle-libs) -lm -o "$out/$stage"
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
