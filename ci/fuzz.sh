#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Fuzzing with libFuzzer, and replay of its corpora.
# usage: ci/fuzz.sh BUILD                  replays every corpus
#        ci/fuzz.sh BUILD TARGET SECONDS   fuzzes one target and extends its
#                                          corpus
#        ci/fuzz.sh BUILD soak SECONDS [TARGET... | --turn]
#                                          fuzzes all or the named targets, or those
#                                          whose turn it is, for SECONDS in all:
#                                          ci/soak.py; the corpora do not change
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
    echo "fuzz: compiling with sanitizers into $out"
    make -s -j"$(nproc)" BUILD="$build" "$build/replay" "$build/words.h" corpus
    [ "${KERNELS-yes}" ] || {
        make -s -j"$(nproc)" BUILD="$build" "$build/check"
        kernels=$build
    }
    make -s -j"$(nproc)" ROOT="$build" BUILD="$out" CC=clang CXX=clang++ WARN=-w \
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

replay() {
    make -s BUILD="$build" "$build/replay" corpus
    passed=0 failed=0
    for t in $("$build/replay" --list); do
        set -- "$build/corpus/$t"/*
        [ -e "$1" ] || {
            echo "FAILED fuzz/corpus/$t.tar holds nothing"
            failed=$((failed + 1))
            continue
        }
        said=$("$build/replay" "$t" "$@") || :
        printf '%s\n' "$said" >&2 # tee /dev/stderr would empty the part's log
        line=$(printf '%s\n' "$said" | tail -n 1)
        case $line in
        *' passed, '*) ;;
        *)
            echo "FAILED fuzz/corpus/$t.tar: the replay died"
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
    shift 3
    python3 ci/soak.py "$build" "$seconds" bench/fuzz.csv "$@"
    ;;
*)
    "$build/replay" --list | grep -qx "$target" || {
        echo "no target '$target'; there are:" >&2
        "$build/replay" --list >&2
        exit 2
    }
    prepare
    status=0
    python3 ci/soak.py "$build" "$seconds" bench/fuzz.csv "$target" || status=1
    merged=$out/merged-$target
    rm -rf "$merged"
    mkdir -p "$merged"
    cp "$build/corpus/$target"/* "$merged" 2>/dev/null || : # a new target has none
    "$out/$target" -merge=1 -max_len=8192 -close_fd_mask=3 "$merged" \
        "$out/found-$target"
    python3 fuzz/corpus.py pack "$target" "$merged"
    exit $status
    ;;
esac
