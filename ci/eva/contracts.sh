#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Asserts the contracts of ref/ in tests: what Eva takes as given of its callers
# (ci/eva/contracts.py). Linked anew, all calls pass through assertions: those between
# files and those within a file. Each contract must catch a call outside of it, from
# another file and, where there is one, from its own.
# usage: ci/eva/contracts.sh BUILD; ends with `N passed, N failed`
set -eu
cd "$(dirname "$0")/../.."
build=$1
passed=0 failed=0

tell() {
    if [ "$1" -eq 0 ]; then
        echo "ok $2"
        passed=$((passed + 1))
    else
        echo "FAILED $2"
        failed=$((failed + 1))
    fi
}

# Runs a part of the tests; without a case run it fails.
run() {
    log=$build/contracts/log status=0
    "$build/contracts/check" "$@" >"$log" 2>&1 || status=1
    grep -q '^[1-9][0-9]* passed, 0 failed' "$log" || status=1
    tell $status "check $*: $(tail -n 1 "$log")"
    [ $status -eq 0 ] || tail -n 8 "$log"
}

# A call of FUNCTION by PROGRAM goes outside of the contract of NAME, and is caught.
# usage: catches PROGRAM FUNCTION NAME WHERE
catches() {
    said=$("$build/contracts/$1" "$2" outside 2>&1) || true
    status=0
    case $said in
    "inside
outside the contract of $3: "*) ;;
    *) status=1 ;;
    esac
    tell $status "a call outside the contract of $3 is caught$4"
    [ $status -eq 0 ] || echo "$said"
}

make -s BUILD="$build" "$build/contracts/check" "$build/contracts/outside" \
    "$build/contracts/inner"
for name in $(python3 ci/eva/contracts.py names); do
    catches outside "$name" "$name" ''
done
# A function that calls another one of its file outside of that one's contract, if it is
# called so itself; its own contract is not asserted here.
from() {
    case $1 in
    ref_plane) echo ref_tritri ;;
    esac
}
python3 ci/eva/contracts.py calls >"$build/contracts/calls"
while read -r name count file; do
    if [ "$count" -eq 0 ]; then
        echo "$file does not call $name itself"
        continue
    fi
    caller=$(from "$name")
    catches inner "${caller:-none}" "$name" " within $file"
done <"$build/contracts/calls"
for stage in narrow proximity impulses audit; do
    run --stages --only $stage
done
for test in audit_signs audit_invariance hardest_signs sliver_pairs audit_known closest_points \
    proximity_free impulses_led; do
    run --tests --only $test
done
echo "$passed passed, $failed failed"
[ "$passed" -gt 0 ] && [ "$failed" -eq 0 ]
