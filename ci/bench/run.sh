#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Everything that ci/bench/MACHINE holds: time of each stage, of the narrow
# phase, time against error and what else spec/accuracy.md shows, on two
# processors at most, and the pictures where there is matplotlib. QUICK=1: a
# small form, to BUILD/quick instead.
# usage: ci/bench/run.sh BUILD MACHINE
set -eu
build=$1
out=ci/bench/$2 quick=
if [ -n "${QUICK-}" ]; then
    quick=--quick out=$build/quick
fi
mkdir -p "$out"
export OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive

# The longest first. Times within a part are compared, so a part is one run.
parts='lion work drift,orders,contact stability,stress skip,stages'
# shellcheck disable=SC2086
printf '%s\n' $parts | xargs -P 2 -I {} sh -c \
    '"$0" $1 "$2" $(echo {} | tr , " ") || exit 255' \
    "$build/accuracy" "$quick" "$out"
if [ -z "$quick" ]; then
    "$build/check" --bench >"$out/stages.csv"
    "$build/speed" >"$out/narrow.csv"
fi
for python in python3 /usr/bin/python3; do
    "$python" -c 'import matplotlib' 2>/dev/null || continue
    exec "$python" ci/bench/accuracy.py "$out"
done
echo 'skipped: no pictures without python3-matplotlib'
