# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# Starts that intersect: panels that begin in a body are moved out of it.
# Read by tests/app.sh, whose functions it calls.

# panels PYTHON: square panels, 20 x 30 cm, of which `at` places one by its z, in cm,
# and a body, as starts.json; what is told changes them.
panels() {
    python3 - "$1" >start.pattern.json <<'EOT'
import json
import sys
edges = [{"endpoints": [k, (k + 1) % 4]} for k in range(4)]
panels, stitches = {}, []
body = {"name": "body", "shape": "sphere", "radius": 0.1, "at": [0.1, 0.15, 0]}
def at(name, z, width=20):
    ring = [[0, 0], [width, 0], [width, 30], [0, 30]]
    panels[name] = {"vertices": ring, "edges": edges, "translation": [0, 0, z]}
def sew(a, i, b, j):
    stitches.append([{"panel": a, "edge": i}, {"panel": b, "edge": j}])
exec(sys.argv[1])
json.dump({"pattern": {"panels": panels, "stitches": stitches},
           "properties": {"units_in_meter": 100}}, sys.stdout)
scene = {"frames": 0, "gravity": [0, 0, 0], "obstacles": [body],
         "garments": [{"pattern": "start.pattern.json", "cell": 0.01}]}
json.dump(scene, open("starts.json", "w"))
EOT
}
# moved PYTHON: the condition holds of the ways of what starts.json moves, by panel, in
# cm, and of by, the panels that moved them; and the start has no pair.
moved() {
    rm -rf starts
    "$drape" sew starts.json --out starts --no-picture >out 2>err
    python3 - "$1" <<'EOT'
import json
import sys
sew = json.load(open("starts/sew.json"))
way = {m["panel"]: [round(100 * x, 4) for x in m["way_m"]] for m in sew["moved"]}
by = {m["panel"]: m["by"] for m in sew["moved"]}
assert eval("(" + sys.argv[1] + ")"), (way, by)
assert [f["pairs"] for f in sew["frames"]] == [0]
EOT
}
panels 'at("front", 14); at("back", -8); sew("front", 1, "back", 1)'
is 'a panel that begins in a body goes the least way out' moved 'way == {"back": [0, 0, -3]}'
is 'and is named' grep -q 'panel back is moved by 3 cm, (.*) m, as it begins in a body' err
panels 'at("front", 14); at("back", -8); at("outer", -10.5); at("far", -30)
sew("front", 1, "back", 1)'
is 'what lies in front of it keeps its place there' moved '
by == {"back": "back", "outer": "back"} and way["back"][2] == -3 and way["outer"][2] < 0
and -10.5 + way["outer"][2] < -8 + way["back"][2] - 0.4'
panels 'at("front", 14); at("back", -8); at("side", 0)
panels["side"].update(rotation=[0, 90, 0], translation=[10, 0, -8.5])
sew("front", 1, "back", 1)'
is 'and what stands across its way is pushed' moved '
set(by) == {"back", "side"} and way["side"][2] < 0'
panels 'at("front", 14); at("back", -8); sew("front", 1, "back", 1)
for p in panels.values(): p.update(rotation=[30, 40, 50])
body["at"] = [0, 0, 0]
panels["front"]["translation"] = [0, 0, 0]; panels["back"]["translation"] = [30, 30, 30]'
is 'along its normal, wherever that is' moved '
list(way) == ["front"] and abs(sum(x * x for x in way["front"]) ** 0.5 - 10.5) < 1e-3'
panels 'at("sleeve", 0, 40); sew("sleeve", 1, "sleeve", 3)
body.update(shape="capsule", radius=0.05, length=1, at=[0.24, 0.15, -0.07])'
is 'a sleeve goes to its arm' moved 'way == {"sleeve": [2.5, 0, 0]}'
panels 'at("front", 14); at("back", -8); sew("front", 1, "back", 1)
body.update(shape="box", extent=[0.1, 0.1, 1]); del body["radius"]'
refused 'a panel that finds no way is named, and where' \
    'panel front begins in body, around (0.1, 0.15, 0.14) m over 12 cm' \
    sew starts.json --out refused
sed 's/"frames": 0/"allow_intersecting": true, &/' starts.json >allowed.json
exits 'or stays, where a start may intersect' 1 sew allowed.json --out starts --force \
    --no-picture
is 'as the audit says' sh -c '"$0" audit starts; test $? -eq 1' "$drape"
