#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes everything in bench/MACHINE: the times of all stages and of the
# narrow phase, the experiments of spec/accuracy.md, and, where matplotlib is
# installed, the pictures. Uses two processors at most. QUICK=1 runs a small
# form and writes to BUILD/quick instead. BACKEND=gpu runs the experiments on a
# device.
# usage: bench/run.sh BUILD MACHINE
set -eu
build=$1 status=0
export OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive

# The longest part comes first. Times within a part are compared with each
# other, so a part is one process.
parts='stress work counts speed newton drift contact orders single skip stability'
options="--backend ${BACKEND-ref}"
if [ -n "${QUICK-}" ]; then
    out=$build/quick options="$options --quick"
else
    out=bench/$2 parts="lion bench $parts"
fi
mkdir -p "$out"
# shellcheck disable=SC2086
printf '%s\n' $parts | xargs -P 2 -I {} sh bench/part.sh \
    "$build" "$out" {} "$options" || status=1
for python in python3 /usr/bin/python3 ''; do
    [ -z "$python" ] || "$python" -c 'import matplotlib' 2>/dev/null && break
done
if [ -n "$python" ]; then
    "$python" -m bench.accuracy.plots "$out"
else
    echo 'skipped: no pictures without python3-matplotlib'
fi
exit $status
