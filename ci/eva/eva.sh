#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Shows that code of ref/ has no undefined behaviour for any input that its contract
# allows: Frama-C's Eva analyses the programs in ci/eva, which call it with the inputs
# that ci/eva/contracts.py makes of the contract. Each must be analysed without an alarm
# (index, uninitialised value, overflow, division), all its statements but a hundredth
# must be reached, and each contract must hold at each call, as Frama-C reads it.
# usage: ci/eva/eva.sh BUILD; ends with `N passed, N failed, N skipped`
set -eu
# Each program and how precisely Eva looks.
rows='
closest    -eva-auto-loop-unroll 12 -eva-slevel 200
filter     -eva-precision 3 -eva-slevel 3000 -eva-split-return auto
predicates -eva-auto-loop-unroll 32 -eva-slevel 50 -eva-use-spec ref_orient3_integer_64,ref_orient2_integer_64
split      -eva-auto-loop-unroll 12 -eva-interprocedural-splits -eva-min-loop-unroll 4
tritri     -eva-precision 3 -eva-slevel 300
'
cd "$(dirname "$0")/../.."
build=$1
passed=0 failed=0
command -v frama-c >/dev/null || {
    echo 'skipped: Eva: there is no frama-c (sh ci/deps.sh proofs)'
    echo '0 passed, 0 failed, 1 skipped'
    exit 0
}
mkdir -p "$build/eva"
make -s BUILD="$build" "$build/names/ref.h" "$build/names/gpu.h" "$build/names/tests.h"
while read -r name options; do
    [ -n "$name" ] || continue
    log=$build/eva/$name.log
    python3 ci/eva/contracts.py inputs "ref/narrow/$name.h" >"$build/eva/$name.h"
    # shellcheck disable=SC2086 # options are words
    frama-c -eva $options -warn-special-float none -eva-no-show-progress \
        -cpp-extra-args="-I. -Ispec -I$build -DREAL_BITS=64 -include ci/eva/eva.h" \
        "ci/eva/$name.c" >"$log" 2>&1 </dev/null || true
    reached=$(sed -n 's/.* statements reached (out of [0-9]*): \([0-9]*\)% .*/\1/p' "$log")
    held='Preconditions *[1-9][0-9]* valid *0 unknown *0 invalid'
    if grep -q ' 0 alarms generated' "$log" && grep -q "$held" "$log" &&
        [ "${reached:-0}" -ge 99 ]; then
        echo "proved $name: no alarm, $reached % of its statements reached"
        passed=$((passed + 1))
    else
        echo "FAILED $name: $(sed -n 's/^ *\([0-9]* alarms* generated\).*/\1/p' "$log")," \
            "${reached:-0} % reached: $log"
        grep -E -A 1 'eva:alarm|got status (unknown|invalid)' "$log" | head -n 8 || true
        failed=$((failed + 1))
    fi
done <<END
$rows
END
echo "$passed passed, $failed failed, 0 skipped"
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
