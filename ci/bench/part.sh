#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs one part of ci/bench/run.sh: a part of build/accuracy, or `bench`, which
# times all stages and the narrow phase. Prints how many seconds it took.
# usage: ci/bench/part.sh BUILD OUT PART OPTIONS
set -eu
build=$1 out=$2 part=$3
if [ "$part" != bench ]; then
    # shellcheck disable=SC2086
    exec "$build/accuracy" $4 "$out" "$part"
fi
start=$(date +%s)
"$build/check" --bench >"$out/stages.csv"
"$build/speed" >"$out/narrow.csv"
echo "bench: $(($(date +%s) - start)) s"
