#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs one part of `make check`, prints its counts, its time and the output of
# failures, and adds the counts to BUILD/check.counts. Parts may run in parallel.
# usage: ci/part.sh BUILD PART [JOBS]
set -u
build=$1 part=$2 jobs=${3-1}
log=$build/check-$part.log
tool=$build/drape

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
    echo "$1 $2 ${3:-0}" >>"$build/check.counts"
    times >"$log.cpu" # the second line: user and system time of children
    cpu=$(sed -n '2s/[ms]/ /gp' "$log.cpu" |
        awk '{ printf "%d", 60 * $1 + $2 + 60 * $3 + $4 + 0.5 }')
    # one write, so that the lines of parallel parts do not mix
    shown=$(printf '%-28s %s (%d s, CPU %d s)\n' "$name" "$line" \
        $(($(date +%s) - start)) "$cpu"
        grep '^skipped' "$log"
        [ "$2" -eq 0 ] || grep -v '^ok' "$log" | tail -n 40)
    printf '%s\n' "$shown"
    rm -f "$log" "$log.cpu"
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

# Builds and tests with other flags; in CI the emulated kernels are built with
# them too.
flavour() { count "$part" sh ci/flavour.sh "$build" "$part" "${CI:+yes}"; }

# Runs a part that needs the tool; skips it if the tool was not built, as its
# libraries are not installed.
with_tool() {
    if [ -x "$tool" ]; then
        count "$@"
    else
        count "$1" echo '0 passed, 0 failed, 1 skipped'
    fi
}

# clang-tidy; the part is skipped if clang-tidy is not installed.
tidy() {
    if command -v clang-tidy >/dev/null; then
        one tidy make BUILD="$build" tidy
    else
        count tidy printf '%s\n' 'skipped: clang-tidy is not installed' \
            '0 passed, 0 failed, 1 skipped'
    fi
}

# Checks that the certificate is of this tree and that the reference still gives
# its bits.
certificate() {
    if [ -f ci/certificate.json ] && [ -x "$tool" ]; then
        count certificate python3 ci/certificate.py check \
            ci/certificate.json "$build"
    else
        count certificate echo '0 passed, 0 failed, 1 skipped'
    fi
}

export DRAPE_FAILURES="$build"
export OMP_WAIT_POLICY=passive # more threads than processors must not spin
export OMP_NUM_THREADS=1       # what wants more asks for them
case $part in
build) one build make -j"$jobs" BUILD="$build" check-parts ;;
self) count 'planted faults' "$build/check" --self-test ;;
device) count 'kernels, emulated' "$build/check" --gpu ;;
accuracy) count accuracy "$build/accuracy" --quick "$build" ;;
validate)
    mkdir -p "$build/validation"
    count validation "$build/validate" --quick "$build/validation"
    ;;
tests) count tests "$build/check" --tests ;;
golden-1) count golden "$build/check" --golden tests/golden/stages.txt ;;
golden-3)
    count 'golden, 3 threads' env OMP_NUM_THREADS=3 \
        "$build/check" --plain --golden tests/golden/stages.txt
    ;;
root) count 'whole scenes' sh ci/flavour.sh "$build" root ;;
gcc-* | clang-* | ?san) flavour ;;
format)
    one format sh -c 'ls app/*.[ch] app/examples/*.c* ci/bench/*.[ch] \
        ci/validate/*.[ch] fuzz/*.[ch] gpu/*/* oracle/*.[ch]* \
        python/core/*.[ch] ref/*/*.[ch] spec/*.h tests/*/*.[ch] |
        xargs clang-format --dry-run -Werror'
    ;;
tidy) tidy ;;
tool) with_tool tool sh tests/app.sh "$tool" ;;
embed) count 'embedding examples' sh ci/embed.sh "$build" ;;
python) with_tool 'Python package' sh python/check.sh "$build" ;;
demo) with_tool "the demo's frames" sh ci/scenes.sh "$build" demo ;;
counts)
    mkdir -p "$build/quick"
    with_tool 'counts of contact' python3 ci/bench/counts.py "$tool" "$build/quick"
    ;;
buddha) with_tool 'buddha, 120 steps' sh ci/scenes.sh "$build" buddha ;;
fuzz) count 'fuzz corpus' sh ci/fuzz.sh "$build" ;;
prove) count proofs sh ci/prove.sh ;;
certificate) certificate ;;
rows) count "the certificate's faults" python3 tests/certificate.py "$build" ;;
maps) count 'maps of the tree' python3 tests/maps.py ;;
tokens) count 'what code is' python3 tests/tree.py ;;
*) one "unknown part $part" false ;;
esac
