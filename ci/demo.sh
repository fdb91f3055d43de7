#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `make demo`: drapes a 20,000-triangle cloth over the Chinese lion and leaves
# frames, pictures, a film and report.json in BUILD/demo.
# usage: ci/demo.sh BUILD
set -eu
build=$1
out=$build/demo
models=$build/models
lion=$models/lion_20k.ply

# The lion of Debian's libcgal-demo, levelled on its feet, 1 m high. The
# direction that is up in the scan was fitted to its four feet.
fetch_lion() (
    mkdir -p "$models/fetch"
    cd "$models/fetch"
    apt-get download libcgal-demo >log 2>&1
    dpkg-deb -x libcgal-demo_*.deb . >>log 2>&1
    tar -xzf "$(find . -name data.tar.gz | head -n 1)" \
        data/meshes/ChineseDragon-10kv.off >>log 2>&1
)
if [ ! -s "$lion" ]; then
    if fetch_lion && "$build/drape" convert \
        "$models/fetch/data/meshes/ChineseDragon-10kv.off" "$lion" \
        --up 0.0036545361,0.9534138665,0.3016432389 --size 1 >/dev/null; then
        rm -rf "$models/fetch"
    else
        rm -rf "$models/fetch" "$lion"
    fi
fi
if [ -s "$lion" ]; then
    scene=app/scenes/lion_20k.json
    echo "demo: the Chinese lion (Debian libcgal-demo)"
else
    scene=app/scenes/statue_20k.json
    echo "demo: libcgal-demo cannot be had here: a statue made in code"
fi

start=$(date +%s)
DRAPE_MODELS=$models "$build/drape" run "$scene" --frames 120 --out "$out"
"$build/drape" audit "$out"
for frame in 20 40 120; do
    "$build/drape" render "$out" --frame $frame --samples 24
done
"$build/drape" render "$out" --every 2 --width 640 --height 480 --samples 6
echo "demo: $(($(date +%s) - start)) s, see $out"
