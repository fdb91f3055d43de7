#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs the demo's scene, or the paper's buddha with 20,000 triangles of cloth, for
# 120 steps. Every step must end without an intersection, and our audit and CGAL
# must both count 0 intersecting pairs in every frame. For the buddha CGAL audits
# every tenth frame only, as it is slow.
# usage: ci/scenes.sh BUILD demo|buddha
set -u
build=$1
out=$build/scene-$2
log=$out.log
if [ "$2" = demo ]; then
    scene=$(sh ci/lion.sh "$build")
    data=$build
    every=1 seen=121
else
    scene=app/scenes/buddha_20k.json
    every=10 seen=13
    data=${DRAPE_DATA:-$build/data}
    if [ ! -f "$data/models/buddha_100k.ply" ]; then
        echo 'skipped: the buddha: there is no models/buddha_100k.ply in DRAPE_DATA' \
            "($build/drape fetch-models DIR fetches it; set DRAPE_DATA=DIR)"
        echo '0 passed, 0 failed, 1 skipped'
        exit 0
    fi
fi
. ci/ok.sh

# Prints the last line of an audit of a directory, which has the count of pairs.
ours() { "$build/drape" audit "$1" 2>&1 | tail -n 1; }
cgal() { "$build/frames" "$@" 2>&1 | tail -n 1; }

rm -rf "$out"
ok 'runs' env DRAPE_DATA="$data" "$build/drape" run "$scene" \
    --frames 120 --no-obj --threads 1 --out "$out"
none='0 of them with intersecting pairs, 0 pairs'
ok 'no pair by our predicates' test "$(ours "$out")" = \
    "$out: 121 frames, $none"
if [ -x "$build/frames" ]; then
    ok 'no pair by CGAL' test "$(cgal "$out" "$every")" = \
        "$out: $seen frames, $none"
    # Two frames put into one mesh intersect: both audits find the same pairs.
    mkdir -p "$out/two/frames"
    cp "$out/frames/cloth_0060.ply" "$out/two/frames/cloth_0000.ply"
    cp "$out/frames/cloth_0061.ply" "$out/two/obstacles.ply"
    ok 'pairs where there are some' sh -c \
        'echo "$1"; echo "$1" | grep -q "1 of them" && [ "$1" = "$2" ]' \
        sh "$(ours "$out/two")" "$(cgal "$out/two")"
else
    echo 'skipped: the frames audited by CGAL: there is no libcgal-dev' \
        '(sh ci/deps.sh installs it)'
    skipped=1
fi
rm -rf "$out" "$log"
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed -eq 0 ]
