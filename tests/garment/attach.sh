# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# Edges that are held by their labels: to the world, to a body, for a time.
# Read by tests/app.sh, whose functions it calls, behind sew.sh, whose it calls too.

# held PYTHON: the condition holds of sew, the report of what is in `shirt`; of top(k),
# where the upper edges of both halves are in frame k, and rod(k), where the body is.
held() {
    python3 - "$1" <<'EOT'
import json
import math
import sys
from geometry import load

sew = json.load(open("shirt/sew.json"))
rows = sew["attachments"]
begun = rows[0]["from"] if rows else sew["stages"]["worn"]
last = sew["steps"]
M, N = 11, 16  # of each half: 20 cm by 30 cm


def frame(name, k):
    return load("shirt/frames/%s_%04d.ply" % (name, k))[0]


def top(k):
    x = frame("cloth", k)
    return [x[half * M * N + (N - 1) * M + i] for half in (0, 1) for i in range(M)]


def ways(x, y):
    return max(math.dist(p, q) for p, q in zip(x, y))


def seen(k):  # the edges' distances from three corners of the body
    x = frame("obstacles", k)
    return [[math.dist(p, x[c]) for c in (0, 1, -1)] for p in top(k)]


assert eval("(" + sys.argv[1] + ")"), rows
EOT
}
sewn='
pattern["stitches"] = [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]]
for p in (left, right):
    p["edges"] = [dict(e) for e in p["edges"]]
    p["edges"][2]["label"] = "lower_interface"
    p["translation"] = [0, 100, 0]'
halves "$sewn"
hang() {
    name=$1 code=$2
    shift 2
    exits "$name" "$code" sew "$@" --no-picture --out shirt --force
}
hang 'a garment in the air' 0 halves.json --cell 0.02 --frames 60 --attach none
is 'falls where nothing holds it' held '
not rows and min(p[1] for p in top(begun)) - max(p[1] for p in top(last)) > 0.3'
hang 'its waist is held' 0 halves.json --cell 0.02 --frames 60
is 'of itself, where nothing is sewn to it' held '
[(r["name"], r["body"], r["hold"], r["until"]) for r in rows] ==
    [(p + " lower_interface", None, "soft", None) for p in ("left", "right")]
and [r["points"] for r in rows] == [10, 11] and ways(top(begun), top(last)) < 1e-5
and all(0.5 < r["pull_N_per_m"] < 30 for r in rows)'
is 'and said' grep -q 'right lower_interface: 11 particles were held to the world from step' err
is 'the rest hangs from it' closed '
all(s["closed"] for s in sew["seams"]) and not any(f["pairs"] for f in sew["frames"])'
is 'no file shows the anchors' python3 -c '
import json
from geometry import load
bodies = json.load(open("shirt/report.json"))["bodies"]
assert [b["name"] for b in bodies] == ["left", "right"], bodies
assert len(load("shirt/frames/cloth_0000.ply")[0]) == 2 * 11 * 16'
exits 'an audit of its frames' 0 audit shirt
exits 'its scene goes on' 0 run shirt/sewn.json --frames 2 --out on --force
hang 'held for a time' 0 halves.json --cell 0.02 --frames 80 \
    --attach lower_interface:hard:world:0.5
is 'and let go then' held '
all(r["until"] - r["from"] == 30 and r["hold"] == "hard" for r in rows)
and ways(top(begun), top(begun + 30)) < 1e-5
and min(p[1] for p in top(begun)) - max(p[1] for p in top(last)) > 0.2'
echo '{"frames": 60, "garments": [{"pattern": "halves.json", "cell": 0.02,
    "attach": [{"label": "lower_interface", "strength": 0.2}]}]}' >weak.json
hang 'held by less than it weighs' 0 weak.json
is 'it slips, and the pull is what was asked for' held '
all(r["slip_m"] > 0.05 and abs(r["pull_N_per_m"] - 0.2) < 1e-3 for r in rows)'
# a plate without friction behind it, which goes up and turns once it is worn
python3 - <<'EOT'
import json
scene = json.load(open("weak.json"))
scene["garments"][0]["attach"] = [{"label": "lower_interface", "hold": "hard"}]
scene["obstacles"] = [{"name": "plate", "shape": "plane", "extent": [0.6, 0.02, 0.8],
                       "axis": [1, 0, 0], "angle": 90, "at": [0, 1.2, -0.02],
                       "friction": 0, "motion": "up"}]
scene["motions"] = [{"name": "up", "pivot": [0, 1.2, 0],
                     "keys": [{"time": 0},
                              {"time": 0.5, "move": [0.1, 0.2, 0.1],
                               "axis": [0.2, 0.3, 1], "angle": 40}]}]
json.dump(scene, open("plate.json", "w"))
scene["garments"][0]["attach"][0]["until"] = 1.2
json.dump(scene, open("later.json", "w"))
scene["garments"][0]["attach"] = []
json.dump(scene, open("loose.json", "w"))
EOT
hang 'held to a body that moves' 0 plate.json
is 'it goes with the body' held '
all(r["body"] == "plate" for r in rows) and sew["stages"]["moving"] == 60
and sew["steps"] == 90 and ways(top(60), top(90)) > 0.15
and ways(sum([seen(begun)], []), seen(75)) < 2e-4 and ways(seen(begun), seen(90)) < 2e-4'
is 'and nothing crosses' closed 'not any(f["pairs"] for f in sew["frames"])'
hang 'let go as the body moves' 0 later.json
is 'it falls as the body goes on' held '
all(60 < r["until"] < 90 for r in rows) and ways(seen(begun), seen(rows[0]["until"])) < 2e-4
and ways(seen(begun), seen(90)) > 0.005'
hang 'a garment that is not held' 0 loose.json
cp shirt/frames/obstacles_0090.ply loose.ply
hang 'the body is where it is without' 0 plate.json
is 'to a millionth' python3 -c '
import math
from geometry import load
a, b = load("loose.ply")[0], load("shirt/frames/obstacles_0090.ply")[0]
assert max(math.dist(p, q) for p, q in zip(a, b)) < 1e-6'
# a waist to which something is sewn
halves "$sewn"'
pattern["stitches"].append([{"panel": "left", "edge": 2}, {"panel": "right", "edge": 2}])
pattern["stitches"][0] = pattern["stitches"].pop()
right["rotation"] = [0, 180, 0]; right["translation"] = [0, 100, -4]; left["translation"] = [20, 100, 0]'
hang 'a waist that is sewn' 0 halves.json --cell 0.02 --frames 40
is 'is not held of itself' held 'not rows'
hang 'but if it is told' 0 halves.json --cell 0.02 --frames 60 --attach lower_interface
is 'one side of the seam is' held '
sum(r["points"] for r in rows) == 11 and ways(top(begun)[:11], top(last)[:11]) < 1e-3'
# a skirt on a body: as wide as its waist, and wider by three tenths
wide() {
    python3 - "$root/app/patterns/skirt.json" "$1" >wide.json <<'EOT'
import json
import sys
pattern, by = json.load(open(sys.argv[1])), float(sys.argv[2])
for panel in pattern["pattern"]["panels"].values():
    panel["translation"][1] += 52 * (1 - by)
    panel["vertices"] = [[by * x, by * y] for x, y in panel["vertices"]]
    for edge in panel["edges"]:
        if "curvature" in edge:
            edge["curvature"]["params"][0] *= by
        if "label" in edge:
            edge["label"] = "lower_interface"
json.dump(pattern, sys.stdout)
EOT
}
# low PYTHON: the condition holds of low(k), the mean height of the upper edges, m, in
# frame k, and of worn and last, the frames in which gravity is whole and the last.
low() {
    python3 - "$1" <<'EOT'
import json
import sys
from geometry import load

sew = json.load(open("shirt/sew.json"))
worn, last = sew["stages"]["worn"] + 30, sew["steps"]
x, tri = load("shirt/frames/cloth_0000.ply")[:2]
used = sorted({v for t in tri for v in t}, key=lambda v: x[v][1])[-20:]


def low(k):
    x = load("shirt/frames/cloth_%04d.ply" % k)[0]
    return sum(x[v][1] for v in used) / len(used)


assert eval("(" + sys.argv[1] + ")"), (low(0), low(worn), low(last))
EOT
}
if [ -z "$brief" ]; then
    wide 1
    hang 'a skirt that fits, unheld' 0 wide.json --body walk/body.ply --cell 0.06 \
        --frames 130 --attach none
    is 'holds by friction' low 'abs(low(last) - low(worn)) < 0.001 and low(last) > 1.05'
    wide 1.3
    hang 'one that is too wide' 0 wide.json --body walk/body.ply --cell 0.06 \
        --frames 130 --attach none
    is 'falls off' low 'low(last) < 0.5'
    hang 'and held of itself' 0 wide.json --body walk/body.ply --cell 0.06 --frames 130
    is 'it stays' low 'abs(low(last) - low(worn)) < 1e-4 and low(last) > 1.05'
fi
refused 'a label that no edge has' 'halves.json has the label "lower_interfase"; did you mean "lower_interface"?' \
    sew halves.json --cell 0.02 --attach lower_interfase --out refused
refused 'one that is like none' 'one has "lower_interface"' \
    sew halves.json --cell 0.02 --attach collar --out refused
refused 'a word of no attachment' 'expected LABEL[:soft|hard][:body|world][:SECONDS]' \
    sew halves.json --cell 0.02 --attach lower_interface:firm --out refused
refused 'no word at all' 'more of these behind commas, or none' \
    sew halves.json --cell 0.02 --attach , --out refused
refused 'attachments of a scene' '--fabric and --attach are keys of a scene' \
    sew weak.json --attach none --out refused
sed 's/"strength": 0.2/"strength": 0/' weak.json >none.json
refused 'no strength' 'attach[0].strength' sew none.json --out refused
sed 's/"label": "lower_interface", //' weak.json >none.json
refused 'an attachment of no label' 'expected label, of edges of the pattern' \
    sew none.json --out refused
halves 'pattern["stitches"] = [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]]'
refused 'a pattern without labels' 'has the label "waist", nor any other' \
    sew halves.json --cell 0.02 --attach waist --out refused
