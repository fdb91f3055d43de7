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
gravity = [0, 0, 0]
body = {"name": "body", "shape": "sphere", "radius": 0.1, "at": [0.1, 0.15, 0]}
def at(name, z, width=20):
    ring = [[0, 0], [width, 0], [width, 30], [0, 30]]
    panels[name] = {"vertices": ring, "edges": edges, "translation": [0, 0, z]}
def sew(a, i, b, j):
    stitches.append([{"panel": a, "edge": i}, {"panel": b, "edge": j}])
exec(sys.argv[1])
json.dump({"pattern": {"panels": panels, "stitches": stitches},
           "properties": {"units_in_meter": 100}}, sys.stdout)
scene = {"frames": 0, "gravity": gravity, "obstacles": [body],
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
panels 'at("front", 14); at("back", -8); sew("front", 1, "back", 1)
panels["patch"] = {"vertices": [[9, 14], [11, 14], [11, 16], [9, 16]], "edges": edges,
                   "translation": [0, 0, -9.96]}; body["detail"] = 60'
is 'and not into the body, if that is nearer' moved 'way["patch"][2] < 0'
# A shoulder, whose top at 31.8 cm is higher than the edges that are sewn over it.
over='at("front", 14); at("back", -14); at("far", 40); sew("front", 2, "back", 2)
panels["back"].update(rotation=[0, 180, 0], translation=[20, 0, -14])
body.update(shape="box", extent=[0.1, 0.1, 0.1], at=[0.1, 0.268, 0]); del body["radius"]
gravity[1] = -9.81'
# lifted PYTHON: the condition holds of the lifts of what starts.json lifts, in cm.
lifted() {
    moved 'not way' && python3 - "$1" <<'EOT'
import json
import sys
lift = {name: round(100 * x, 4) for name, x in
        json.load(open("starts/sew.json"))["lifted_m"].items()}
assert eval("(" + sys.argv[1] + ")"), lift
EOT
}
panels "$over"
is 'panels that a body stands between are lifted until their seam is free' lifted '
lift == {"front": 2, "back": 2}'
is 'which is said' grep -q 'panel front is lifted by 2 cm, as a body' err
is 'and so they stand' python3 -c '
from geometry import load
x = load("starts/frames/cloth_0000.ply")[0]
low = {round(p[2], 6): min(q[1] for q in x if q[2] == p[2]) for p in x}
assert {z: round(y, 6) for z, y in low.items()} == {0.14: .02, -0.14: .02, 0.4: 0}'
panels "$over"'; sew("back", 0, "far", 0)'
is 'not what is sewn to them elsewhere' lifted 'set(lift) == {"front", "back"}'
panels "$over"'; body["at"][1] += 0.05'
is 'nor beside what is higher, as a head is' lifted 'not lift'
panels "$over"'; gravity[1] = 0'
is 'nor where nothing is up' lifted 'not lift'
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

# Meshes that go through each other: a ball and sheets as PLY, of cells of 2 cm.
python3 - <<'EOT'
import math
import struct
def save(name, x, triangles):
    with open(name, "wb") as out:
        out.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
                  b"property double x\nproperty double y\nproperty double z\n"
                  b"element face %d\nproperty list uchar int vertex_indices\n"
                  b"end_header\n" % (len(x), len(triangles)))
        out.writelines(struct.pack("<3d", *p) for p in x)
        out.writelines(struct.pack("<B3i", 3, *t) for t in triangles)
def sheet(name, place, n=21):
    x = [place(i / (n - 1), j / (n - 1)) for j in range(n) for i in range(n)]
    corner = [j * n + i for j in range(n - 1) for i in range(n - 1)]
    save(name, x, [t for a in corner for t in
                   ((a, a + 1, a + n), (a + 1, a + n + 1, a + n))])
def ball(name, middle, radius, n=16):
    at = lambda j, i: [middle[d] + radius * (
        math.sin(math.pi * j / n) * math.cos(math.pi * i / n), math.cos(math.pi * j / n),
        math.sin(math.pi * j / n) * math.sin(math.pi * i / n))[d] for d in range(3)]
    k = 2 * n
    x = [at(j, i) for j in range(1, n) for i in range(k)] + [at(0, 0), at(n, 0)]
    ring = [(j * k + i, j * k + (i + 1) % k) for j in range(n - 2) for i in range(k)]
    save(name, x, [t for a, b in ring for t in ((a, b, a + k), (b, b + k, a + k))]
         + [(len(x) - 2, (i + 1) % k, i) for i in range(k)]
         + [(len(x) - 1, (n - 2) * k + i, (n - 2) * k + (i + 1) % k) for i in range(k)])
sheet("flat.ply", lambda u, v: (.4 * u - .2, 0, .4 * v - .2))
sheet("waves.ply", lambda u, v: (.4 * u - .2, .005 + .013 * math.cos(15 * u)
                                 * math.cos(15 * v), .4 * v - .2))
sheet("corner.ply", lambda u, v: (.0513 + .4 * u, .0307 - .1 * u, .0523 + .4 * v))
sheet("through.ply", lambda u, v: (.3 * u - .1463, .3 * u - .15, .4 * v - .2))
ball("ball.ply", (0.01, -0.08, 0.02), 0.1)
def tube(name, middle, radius, turned, n=48, m=13):
    x = [(middle[0] + r * math.cos(a), middle[1] + .3 * j / (m - 1), middle[2] + r * math.sin(a))
         for j in range(m) for a in (2 * math.pi * i / n for i in range(n))
         for r in [radius + .01 * math.cos(6 * a + turned)]]
    ring = [(j * n + i, j * n + (i + 1) % n) for j in range(m - 1) for i in range(n)]
    save(name, x, [t for a, b in ring for t in ((a, a + n, b), (b, a + n, b + n))])
tube("inner.ply", (0, 0, 0), .15, 0)
tube("outer.ply", (.003, .003, .002), .152, .5)
EOT
# parted PYTHON: the condition holds of untangle.json.
parted() {
    python3 -c "import json
told = json.load(open('parted/untangle.json'))
found, left = told['found'], told['left']
way = {b['name']: b['way_m'] for b in told['bodies']}
assert ($1), told"
}
rm -rf parted
exits 'a sheet that a ball goes through' 0 untangle flat.ply --obstacle ball.ply \
    --out parted --no-picture
is 'is listed with the place' parted '
[f["bodies"] for f in found] == [["flat", "ball"]] and found[0]["parted"] and not left
and all(abs((a + b) / 2 - c) < 5e-3 for a, b, c in
        zip(found[0]["from_m"], found[0]["to_m"], (0.01, 0, 0.02)))
and abs(found[0]["line_m"] - 0.377) < 0.02'
is 'goes out by about as far as it was in' parted '
way["ball"] == 0 and 0.02 < way["flat"] < 0.03'
exits 'by the exact audit' 0 audit parted/flat.ply --obstacle ball.ply
is 'and no farther than its surroundings' python3 -c '
from geometry import load
was, now = load("flat.ply")[0], load("parted/flat.ply")[0]
assert all(a == b for a, b in zip(was, now) if abs(a[0]) > 0.17)'
exits 'sheets of which one waves through the other' 0 untangle flat.ply waves.ply \
    --out parted
is 'are parted in all regions' parted 'len(found) > 10 and not left and max(way.values()) < .03'
exits 'so says the audit' 0 audit parted/flat.ply parted/waves.ply
is 'pictures show where it was' python3 -c '
import png
for name in ("front", "back"):
    rows = png.read("parted/%s.png" % name)
    assert sum(row[k:k + 3] == bytes((220, 0, 0)) for row in rows
               for k in range(0, len(row), 3)) > 200'
exits 'a corner that goes through a sheet' 0 untangle flat.ply corner.ply --out parted \
    --no-picture
exits 'tubes that weave through each other ten times' 0 untangle inner.ply outer.ply \
    --out parted --no-picture
is 'and of which one comes to lie in the other' parted 'len(found) == 10 and not left'
exits 'sheets of which one goes right through the other' 1 untangle flat.ply through.ply \
    --out parted --no-picture
is 'are named, and left as they were' parted '
not found[0]["parted"] and left[0]["pairs"] == found[0]["pairs"] and set(way.values()) == {0}'
is 'to the last bit' python3 -c '
from geometry import load
assert load("flat.ply")[0] == load("parted/flat.ply")[0]'
rm -rf parted
exits 'a list alone' 1 untangle flat.ply waves.ply --rounds 0 --out parted --no-picture
is 'changes nothing' test ! -e parted/flat.ply
exits 'what does not intersect' 0 untangle flat.ply --out parted
refused 'nothing to untangle' 'untangle: expected MESH' untangle
mkdir -p twice && cp flat.ply twice
cp flat.ply kept.ply
for input in flat.ply starts.json; do
    refused "the folder of $input" "$input: is in ./, where it could be overwritten" \
        untangle "$input" --out ./
done
is 'and its mesh stays' cmp flat.ply kept.ply
refused 'two meshes of one name' 'another mesh is called flat' untangle flat.ply twice/flat.ply
refused 'an obstacle beside a scene' 'untangle: expected MESH' untangle tiny.json \
    --obstacle ball.ply
panels 'at("front", 14); at("back", -8); sew("front", 1, "back", 1)'
rm -rf parted
exits 'a scene of a garment' 0 untangle starts.json --out parted --no-picture
is 'is listed by the names of its bodies' parted '[f["bodies"] for f in found] == [["back", "body"]]'
exits 'and begins parted' 0 run parted/start.json --frames 0 --out parted_run --force
exits 'without a pair' 0 audit parted_run
sed 's/0.36/0.34/' tiny.json >low.json
rm -rf parted
exits 'a scene of a cloth' 0 untangle low.json --out parted --no-picture
is 'gets its mesh, and no scene' sh -c 'test -e parted/cloth_0000.ply -a ! -e parted/start.json'
sed 's/"sphere", "radius": 0.15, "at": \[0, 0.2, 0\],/"plane", "at": [0, 0.3599, 0], "angle": 3, "axis": [0, 0, 1]}/; /detail/d' \
    tiny.json >plane.json
exits 'a cloth that a plane goes through' 0 untangle plane.json --out parted --no-picture

panels 'body["at"][2] = -9; at("front", 14); at("back", -30); at("pocket", 14, 6)
panels["pocket"]["translation"][0] = 7; sew("front", 1, "back", 1)'
is 'of two in one plane the smaller comes to lie outside' moved 'not way'
is 'and both are named' grep -q \
    'panels front and pocket overlap in one plane, and are parted by 1 cm each' err
is 'by 2 cm' python3 -c '
from geometry import load
x = load("starts/frames/cloth_0000.ply")[0]
pocket = {round(p[2], 6) for p in x if p[2] > 0.141}
assert pocket == {0.15} and {round(p[2], 6) for p in x} == {0.15, 0.13, -0.3}'
