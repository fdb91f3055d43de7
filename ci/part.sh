#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs one part of `make check` and prints its counts and its time, what it has
# skipped, and each check that failed with its last lines. The log of a part that
# failed stays: BUILD/check-PART.log. Parts may run in parallel.
# usage: ci/part.sh BUILD PART [JOBS]; its exit status is 1 if a check failed.
set -u
build=$1 part=$2 jobs=${3-1}
log=$build/check-$part.log
tool=$build/drape
mkdir -p "$build"

# Prints what the log has of `skipped: CHECK: REASON`, one line for each reason.
skips() {
    sed -n 's/^skipped:* //p' "$log" | awk -F ': ' '
        { why = substr($0, length($1) + 3); if (!(why in what)) order[++n] = why
          what[why] = what[why] (what[why] ? "; " : "") $1 }
        END { for (k = 1; k <= n; k++)
                  print "skipped: " what[order[k]] ": " order[k] }'
}

# Prints the failures of the log: lines FAILED NAME or not ok NAME, each with up to
# 44 lines that follow it. A log with fewer than $1 of them ends in another way, so
# its last lines are printed, too.
failures() {
    awk -v most=44 '
        /^(FAILED|not ok)/ { left = most }
        /^(ok|skipped|proved|agreed)|passed, .* failed/ { left = 0 }
        left-- > 0' "$log"
    [ "$(grep -cE '^(FAILED|not ok)' "$log")" -ge "$1" ] || {
        echo "FAILED $part: the last lines of $log:"
        tail -n 24 "$log" | sed 's/^/    /'
    }
}

# Runs a command that ends with `N passed, N failed[, N skipped]`.
count() {
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
    times >"$log.cpu" # the second line: user and system time of children
    cpu=$(sed -n '2s/[ms]/ /gp' "$log.cpu" |
        awk '{ printf "%d", 60 * $1 + $2 + 60 * $3 + $4 + 0.5 }')
    printf '%-12s %s (%d s, CPU %d s)\n' "$part" "$line" \
        $(($(date +%s) - start)) "$cpu"
    skips
    # shellcheck disable=SC2046 # its numbers
    set -- $(echo "$line" | tr -dc '0-9 ')
    rm -f "$log.cpu"
    [ "$2" -ne 0 ] || {
        rm -f "$log"
        exit 0
    }
    failures "$2"
    exit 1
}

# Runs a command that succeeds or fails as one check.
one() {
    # shellcheck disable=SC2016
    count sh -c \
        '"$@" && echo "1 passed, 0 failed" || echo "0 passed, 1 failed"' \
        sh "$@"
}

# Skips the part, and says why.
skip() { count printf '%s\n' "skipped: $part: $1" '0 passed, 0 failed, 1 skipped'; }

# Builds and tests with other flags; in CI the emulated kernels are built with
# them too.
flavour() { count sh ci/flavour.sh "$build" "$part" "${CI:+yes}"; }

# Runs a part that needs the tool; skips it if the tool was not built, as its
# libraries are not installed.
with_tool() {
    if [ -x "$tool" ]; then
        count "$@"
    else
        skip "there is no $tool (sh ci/deps.sh installs its libraries)"
    fi
}

# Runs a part that needs the Python package; skips it if that was not built.
with_package() {
    if [ -x "$1" ]; then
        count "$@"
    else
        skip "there is no $1: the Python package was not built (sh ci/deps.sh \
installs what it needs)"
    fi
}

# needs PROGRAM [VERSION]: skips the part where the program is not installed, or is of
# another version: each version of clang-tidy and clang-format judges otherwise, and
# the tree is held to those of Debian 12.
needs() {
    command -v "$1" >"$log" 2>&1 ||
        skip "$1 is not installed (sh ci/deps.sh installs it)"
    found=$("$1" --version | sed -n 's/.*version \([0-9]*\).*/\1/p')
    [ "${2-$found}" = "$found" ] ||
        skip "$1 is of version $found, not $2 (Debian 12 has it)"
}

# Checks that the certificate is of this tree and that the reference still gives
# its bits.
certificate() {
    if [ -f ci/certificate.json ] && [ -x "$tool" ]; then
        count python3 ci/certificate.py check \
            ci/certificate.json "$build"
    else
        skip "there is no ci/certificate.json, or no $tool"
    fi
}

export DRAPE_FAILURES="$build"
export OMP_WAIT_POLICY=passive # more threads than processors must not spin
export OMP_NUM_THREADS=1       # what wants more asks for them
case $part in
build) one make -j"$jobs" BUILD="$build" check-parts ;;
self) count "$build/check" --self-test ;;
device) count "$build/check" --gpu ;;
single) count "$build/single" --quick "$build" ;;
accuracy) with_package "$build/accuracy" --quick "$build" ;;
validate)
    mkdir -p "$build/validation"
    with_package "$build/validate" --quick "$build/validation"
    ;;
tests-32 | tests-64) count "$build/check" --bits "${part#tests-}" --tests ;;
golden-1) count "$build/check" --golden tests/golden/stages.txt ;;
golden-3)
    count env OMP_NUM_THREADS=3 \
        "$build/check" --plain --golden tests/golden/stages.txt
    ;;
root) count sh ci/flavour.sh "$build" root ;;
clang-* | [tm]san)
    needs clang
    flavour
    ;;
gcc-* | asan) flavour ;;
format)
    needs clang-format 14
    one sh -c 'ls app/*/*.[ch] app/examples/*.c[pu]* bench/*.[ch] \
        fuzz/*.[ch] gpu/*/* oracle/*.[ch]* \
        python/core/*.[ch] ref/*/*.[ch] spec/*.h tests/*/*.[ch] |
        xargs clang-format --dry-run -Werror'
    ;;
tidy)
    needs clang-tidy 14
    one make BUILD="$build" tidy
    ;;
tool) with_tool sh tests/app.sh "$tool" ;;
embed) count sh ci/embed.sh "$build" ;;
python) with_tool sh python/check.sh "$build" ;;
demo) with_tool sh ci/scenes.sh "$build" demo ;;
counts)
    mkdir -p "$build/quick"
    with_tool python3 bench/counts.py "$tool" "$build/quick"
    ;;
buddha) with_tool sh ci/scenes.sh "$build" buddha ;;
fuzz) count sh ci/fuzz.sh "$build" ;;
ptx)
    command -v nvcc >/dev/null 2>&1 || skip 'there is no nvcc'
    # shellcheck disable=SC2016
    count sh -c 'make -s -j"$1" BUILD="$0" ptx &&
        python3 ci/equal/lint.py "$0"/ptx/gpu/*/*.ptx' "$build" "$jobs"
    ;;
equal) count sh ci/equal/prove.sh "$build" --quick ;;
contracts) count sh ci/eva/contracts.sh "$build" ;;
models) count python3 ci/models/models.py "$build" --quick ;;
faults)
    command -v nvcc >/dev/null 2>&1 || skip 'there is no nvcc'
    needs clang 14
    count python3 ci/equal/faults.py
    ;;
prove)
    needs gappa
    count sh ci/prove.sh
    ;;
certificate) certificate ;;
rows) count python3 tests/certificate.py "$build" ;;
maps) count python3 tests/maps.py ;;
harness) count python3 tests/harness.py ;;
tokens) count python3 tests/tree.py ;;
*)
    echo "$0: no part $part; ci/check.py has them" >&2
    exit 2
    ;;
esac
