#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs whole scenes for 120 frames, audits every frame, and prints the table
# of bench/outcomes.md: the outcomes of the steps, and the energy.
# usage: [BACKEND=gpu] bench/outcomes.sh BUILD [SCENE...]
set -eu
build=$1
shift
[ $# -gt 0 ] || set -- lion_20k buddha_20k dragon_20k statue_20k sphere \
    funnel twist curtain flag
out=$build/outcomes failed=0

row() {
    python3 - "$1" "$2" <<'END'
import json, statistics, sys
name, pairs = sys.argv[1].split("/")[-1], sys.argv[2]
run = json.load(open(sys.argv[1] + "/report.json"))
steps = run["steps"]
ends = {}
for s in steps:
    ends[s["outcome"]] = ends.get(s["outcome"], 0) + 1
energy = [s["kinetic"] + s["elastic"] + s["potential"] for s in steps]
rise = max(b - a for a, b in zip(energy, energy[1:]))
at = max(steps, key=lambda s: s["elastic"])
solves = [s["iterations"] for s in steps]
print("| %s | %s | %s | %s | %d | %.2f | %.2f (%d) | %.2f | %.2f | %d, %d |" % (
    name, run["triangles"], ", ".join("%d %s" % (n, k) for k, n in
                                      ends.items()),
    pairs, sum(s["rolled_back"] > 0 for s in steps),
    steps[0]["potential"] - steps[-1]["potential"], at["elastic"],
    at["step"], steps[-1]["elastic"], rise,
    statistics.median(solves), max(solves)))
END
}

echo '| scene | triangles | steps, by outcome | pairs in all frames | steps' \
    'rolled back | J dropped | J elastic, most (at step) | at the end |' \
    'largest rise of all energy in a step, J | iterations a step: median,' \
    'most |'
echo '| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |'
for scene in "$@"; do
    rm -rf "${out:?}/$scene"
    mkdir -p "$out"
    "$build/drape" run "app/scenes/$scene.json" \
        --frames 120 --no-obj --backend "${BACKEND:-ref}" \
        --out "$out/$scene" >"$out/$scene.log" 2>&1 ||
        tail -n 1 "$out/$scene.log"
    if ! grep -qs '"end": "[^u]' "$out/$scene/report.json"; then
        failed=1 # the others are still run
        continue
    fi
    pairs=$("$build/drape" audit "$out/$scene" 2>&1 | tail -n 1) || :
    pairs=${pairs##*, }
    row "$out/$scene" "${pairs% pairs}"
done
exit $failed
