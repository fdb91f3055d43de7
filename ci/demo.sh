#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make demo`: drapes a 20,000-triangle cloth over the Chinese lion and leaves
# frames, pictures, a film and report.json in BUILD/demo.
# usage: ci/demo.sh BUILD
set -eu
build=$1
out=$build/demo
scene=$(sh ci/lion.sh "$build")
case $scene in
*lion*) echo "demo: the Chinese lion (Debian libcgal-demo)" ;;
*) echo "demo: libcgal-demo cannot be had here: a statue made in code" ;;
esac

start=$(date +%s)
DRAPE_DATA=$build "$build/drape" run "$scene" --frames 120 --out "$out" --force
"$build/drape" audit "$out"
for frame in 20 40 120; do
    "$build/drape" render "$out" --frame $frame --samples 24
done
"$build/drape" render "$out" --every 2 --width 640 --height 480 --samples 6
echo "demo: $(($(date +%s) - start)) s, see $out"
