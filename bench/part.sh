#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs one part of bench/run.sh: a part of build/accuracy; or `single`, by build/single;
# or `bench`, which times all stages and the narrow phase; or `speed`, which times whole scenes for
# `drape plan`; or `counts` of scenes rich in contact; or `lion`, errors with contact.
# Prints how many seconds it took.
# usage: bench/part.sh BUILD OUT PART OPTIONS
set -eu
build=$1 out=$2 part=$3
# Scenes that need no data, of falling, draped, hung and stacked cloth.
if [ "$part" = speed ]; then
    start=$(date +%s) reports=
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
    case $4 in
    *--quick*) scenes=tiny frames=6 ;;
    *) scenes='statue_20k layers funnel curtain twist sphere' frames=60 ;;
    esac
    for scene in $scenes; do
        "$build/drape" run "app/scenes/$scene.json" --out "$work/$scene" --threads 1 \
            --frames $frames --every 1000000 --quiet || [ $? -eq 1 ]
        reports="$reports $work/$scene/report.json"
    done
    cpu=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)
    # shellcheck disable=SC2086
    python3 bench/speed.py "${cpu:-$(uname -m)}" "$(date -u +%Y-%m-%d)" \
        "$out/speed.csv" $reports
    echo "speed: $(($(date +%s) - start)) s"
    exit
fi
if [ "$part" = lion ]; then
    start=$(date +%s)
    python3 bench/lion.py "$build/drape" "$out" "${BACKEND-ref}"
    echo "lion: $(($(date +%s) - start)) s"
    exit
fi
if [ "$part" = single ]; then
    quick=
    case $4 in *--quick*) quick=--quick ;; esac
    exec "$build/single" $quick "$out"
fi
if [ "$part" = counts ]; then
    exec python3 bench/counts.py "$build/drape" "$out"
fi
if [ "$part" != bench ]; then
    # shellcheck disable=SC2086
    exec "$build/accuracy" $4 "$out" "$part"
fi
start=$(date +%s)
"$build/check" --bench >"$out/stages.csv"
"$build/speed" >"$out/narrow.csv"
echo "bench: $(($(date +%s) - start)) s"
