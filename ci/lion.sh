#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes BUILD/models/lion_20k.ply from the lion in Debian's libcgal-demo, and
# prints the name of the demo's scene: with the lion or, if that package is not
# available, with a statue made in code.
# usage: ci/lion.sh BUILD [MODELS]; MODELS: where the lion goes to instead.
set -eu
build=$1
models=${2-$build/models}
lion=$models/lion_20k.ply

# The lion is levelled on its feet, 1 m high. The direction that is up in the
# scan was fitted to its four feet.
fetch() (
    mkdir -p "$models/fetch"
    cd "$models/fetch"
    apt-get download libcgal-demo >log 2>&1
    dpkg-deb -x libcgal-demo_*.deb . >>log 2>&1
    tar -xzf "$(find . -name data.tar.gz | head -n 1)" \
        data/meshes/ChineseDragon-10kv.off >>log 2>&1
)

if [ ! -s "$lion" ]; then
    if fetch && "$build/drape" convert \
        "$models/fetch/data/meshes/ChineseDragon-10kv.off" "$lion" \
        --up 0.0036545361,0.9534138665,0.3016432389 --size 1 >/dev/null; then
        rm -rf "$models/fetch"
    else
        rm -rf "$models/fetch" "$lion"
    fi
fi
[ -s "$lion" ] && echo app/scenes/lion_20k.json ||
    echo app/scenes/statue_20k.json
