#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The paper's buddha with 20,000 triangles of cloth for 120 steps: every step
# ends without an intersection, and every frame is audited.
# usage: ci/scenes.sh BUILD
set -u
build=$1
out=$build/scenes
models=${DRAPE_MODELS:-../shared/models}
if [ ! -f "$models/buddha_100k.ply" ]; then
    echo "skipped: no $models/buddha_100k.ply"
    echo '0 passed, 0 failed, 1 skipped'
    exit 0
fi
passed=0 failed=0
rm -rf "$out"
if DRAPE_MODELS=$models "$build/drape" run app/scenes/buddha_20k.json \
    --frames 120 --no-obj --out "$out" >"$build/scenes.log" 2>&1; then
    passed=$((passed + 1))
else
    tail -n 3 "$build/scenes.log"
    failed=$((failed + 1))
fi
if "$build/drape" audit "$out" >"$build/scenes.log" 2>&1; then
    passed=$((passed + 1))
else
    tail -n 3 "$build/scenes.log"
    failed=$((failed + 1))
fi
frames=$(ls "$out"/frames/*.ply 2>/dev/null | wc -l)
if [ "$frames" -eq 121 ]; then
    passed=$((passed + 1))
else
    echo "expected 121 frames, found $frames"
    failed=$((failed + 1))
fi
rm -rf "$out"
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
