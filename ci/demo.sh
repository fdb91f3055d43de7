#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make demo`: drapes a 20,000-triangle cloth over the Chinese lion and leaves
# frames, a picture, a film and report.json in BUILD/demo.
# usage: ci/demo.sh BUILD
set -eu
build=$1
out=$build/demo
start=$(date +%s)
say() { echo "demo, $(($(date +%s) - start)) s: $1"; }

scene=$(sh ci/lion.sh "$build")
case $scene in
*lion*) say 'the Chinese lion (Debian libcgal-demo)' ;;
*) say 'libcgal-demo cannot be had here: a statue made in code' ;;
esac
say '120 frames of 1/60 s'
DRAPE_DATA=$build "$build/drape" run "$scene" --frames 120 --out "$out" --force
say 'counting the intersecting triangles of all frames, exactly'
"$build/drape" audit "$out"
say 'a picture of the last frame'
"$build/drape" render "$out" --frame 120 --width 640 --height 480 --samples 16
say 'a film, of every fourth frame'
"$build/drape" render "$out" --every 4 --width 480 --height 360 --samples 4
say "done, see $out"
