#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Fuzzing with libFuzzer, and replay of its corpora.
# usage: ci/fuzz.sh BUILD                  replays every corpus
#        ci/fuzz.sh BUILD TARGET SECONDS   fuzzes one target and extends its
#                                          corpus
#        ci/fuzz.sh BUILD soak SECONDS [TARGET...]
#                                          fuzzes all or the named targets for
#                                          SECONDS each and prints a table; the
#                                          corpora do not change
# `BUILD/replay --list` prints the targets. Input that crashes is stored in
# BUILD/fuzz as TARGET-crash-…; `BUILD/replay TARGET FILE` runs it again. With
# KERNELS= the emulated kernels are compiled without sanitizers, which is faster.
set -eu
build=$1 target=${2-} seconds=${3-60}
out=$build/fuzz
san='-fsanitize=address,undefined,fuzzer-no-link -fno-sanitize-recover=all'
# Worlds start few threads here, and waiting threads must not spin.
export OMP_WAIT_POLICY=passive OMP_NUM_THREADS=1

# All targets are one program, with a link to it for each target.
prepare() {
    kernels=$out
    make -s BUILD="$build" "$build/replay" "$build/words.h"
    [ "${KERNELS-yes}" ] || {
        make -s BUILD="$build" "$build/check"
        kernels=$build
    }
    make -s ROOT="$build" BUILD="$out" CC=clang CXX=clang++ WARN=-w \
        EMU_IN="$kernels" OPT='-O1 -g1' OPENMP= \
        SAN="$san" UNTRACED=-fno-sanitize-coverage=trace-cmp "$out/parts.a"
    # shellcheck disable=SC2086
    clang -std=c17 -D_POSIX_C_SOURCE=200809L -O1 -g -I. $san \
        -c fuzz/libfuzzer.c -o "$out/libfuzzer.o"
    # linked by clang++, for the C++ runtime of the emulated device's sanitizers
    # shellcheck disable=SC2046
    clang++ -fsanitize=address,undefined,fuzzer "$out/libfuzzer.o" \
        "$out/parts.a" $(make -s fuzz-libs) -o "$out/program"
    for t in $("$build/replay" --list); do
        ln -sf program "$out/$t"
    done
}

# fuzz TARGET SECONDS: fuzzes until the time is over, whatever is found, and
# writes the row of the table to TARGET.row. A crash is counted by the program's
# exit status, not by files: when assimp's child process dies, libFuzzer writes a
# mesh-crash-… file although the program has not crashed.
fuzz() {
    t=$1 begun=$(date +%s) runs=0 crashes=0 left=$2
    mkdir -p "fuzz/corpus/$t" "$out/found-$t"
    rm -f "$out/$t.log"
    while [ "$left" -gt 0 ] && [ $crashes -lt 20 ]; do
        "$out/$t" -max_total_time="$left" -max_len=8192 -timeout=300 \
            -rss_limit_mb=4096 -close_fd_mask=3 -print_final_stats=1 \
            -artifact_prefix="$out/$t-" "$out/found-$t" "fuzz/corpus/$t" \
            >"$out/$t.run" 2>&1 || crashes=$((crashes + 1))
        new=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/$t.run")
        runs=$((runs + ${new:-0}))
        cat "$out/$t.run" >>"$out/$t.log"
        left=$((begun + $2 - $(date +%s)))
    done
    rm -f "$out/$t.run"
    printf '| %s | %d | %d | %d |\n' "$t" "$runs" \
        $(($(date +%s) - begun)) "$crashes" >"$out/$t.row"
    [ $crashes -eq 0 ]
}

soak() {
    status=0
    # shellcheck disable=SC2046
    [ $# -gt 0 ] || set -- $("$build/replay" --list)
    for t; do
        fuzz "$t" "$seconds" || status=1
    done
    echo '| target | executions | seconds | crashes |'
    echo '| --- | --- | --- | --- |'
    for t; do
        cat "$out/$t.row"
    done
    return $status
}

replay() {
    make -s BUILD="$build" "$build/replay"
    passed=0 failed=0
    for t in $("$build/replay" --list); do
        set -- fuzz/corpus/"$t"/*
        [ -e "$1" ] || {
            echo "FAILED fuzz/corpus/$t holds nothing"
            failed=$((failed + 1))
            continue
        }
        line=$("$build/replay" "$t" "$@" | tee /dev/stderr | tail -n 1) || :
        case $line in
        *' passed, '*) ;;
        *)
            echo "FAILED fuzz/corpus/$t: the replay died"
            line='0 passed, 1 failed'
            ;;
        esac
        # shellcheck disable=SC2046
        set -- $(echo "$line" | tr -dc '0-9 ')
        passed=$((passed + $1)) failed=$((failed + $2))
    done
    echo "$passed passed, $failed failed"
    [ $failed -eq 0 ]
}

case $target in
'') replay ;;
soak)
    prepare
    [ $# -lt 3 ] || shift 3
    soak "$@"
    ;;
*)
    prepare
    "$build/replay" --list | grep -qx "$target" || {
        echo "no target '$target'; there are:" >&2
        "$build/replay" --list >&2
        exit 2
    }
    status=0
    fuzz "$target" "$seconds" || status=1
    tail -n 20 "$out/$target.log"
    "$out/$target" -merge=1 -max_len=8192 -close_fd_mask=3 \
        "fuzz/corpus/$target" "$out/found-$target"
    exit $status
    ;;
esac
