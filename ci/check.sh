#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make check`: runs every check, shows what failed, adds up the counts.
# usage: ci/check.sh BUILD
set -u
build=$1
passed=0 failed=0 skipped=0
log=$build/check.log

# Runs a command that ends with `N passed, N failed[, N skipped]`.
count() {
    name=$1
    shift
    start=$(date +%s)
    "$@" >"$log" 2>&1
    status=$?
    line=$(tail -n 1 "$log")
    case $line in
    *' passed, '*' failed'*) ;;
    *) line='0 passed, 1 failed' ;;
    esac
    [ $status -eq 0 ] || case $line in
    *' 0 failed'*) line='0 passed, 1 failed' ;;
    esac
    set -- $(echo "$line" | tr -dc '0-9 ')
    passed=$((passed + $1)) failed=$((failed + $2))
    skipped=$((skipped + ${3:-0}))
    printf '%-28s %s (%d s)\n' "$name" "$line" $(($(date +%s) - start))
    grep '^skipped' "$log"
    [ "$2" -eq 0 ] || grep -v '^ok' "$log" | tail -n 40
}

# Runs a command that succeeds or fails as one check.
one() {
    name=$1
    shift
    # shellcheck disable=SC2016
    count "$name" sh -c \
        '"$@" && echo "1 passed, 0 failed" || echo "0 passed, 1 failed"' \
        sh "$@"
}

export DRAPE_FAILURES="$build"
export OMP_WAIT_POLICY=passive # three threads on two cores must not spin
golden='--golden tests/golden/stages.txt'
one 'build' make -j2 BUILD="$build" all
count 'stages' "$build/check" --stages --self-test
# one thread: the tests that want more ask for them
count 'tests' env OMP_NUM_THREADS=1 "$build/check" --tests
# shellcheck disable=SC2086
for threads in 1 3; do
    export OMP_NUM_THREADS=$threads
    count "golden, $threads threads" "$build/check" $golden
done
unset OMP_NUM_THREADS
one 'build gcc -O0, -O3, clang' make -j2 BUILD="$build" flavours
for flavour in gcc-O0 gcc-O3 clang-O2; do
    # shellcheck disable=SC2086
    count "golden, $flavour" "$build/$flavour/check" $golden
done
one 'sanitizers' make -j2 BUILD="$build" asan
one 'format' sh -c 'clang-format --dry-run -Werror app/*.[ch] fuzz/*.[ch] \
    oracle/*.[ch]* ref/*.[ch] spec/*.h tests/*.[ch]'
[ -z "${CI-}" ] || one 'tidy' make BUILD="$build" tidy # in CI: it is slow
[ ! -x "$build/drape" ] || count 'tool' sh tests/app.sh "$build/drape"
[ ! -x "$build/drape" ] || count 'buddha, 120 steps' sh ci/scenes.sh "$build"
count 'fuzz corpus' sh ci/fuzz.sh "$build"
[ ! -f ci/prove.sh ] || count 'proofs' sh ci/prove.sh
[ -f ci/certificate.json ] || echo 'NOT CERTIFIED: no GPU has been compared'

rm -f "$log"
[ "$skipped" -eq 0 ] && tail= || tail=", $skipped skipped"
echo "$passed passed, $failed failed$tail"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
