# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# Garments of a scene: their panels are parted, sewn and worn.
# Read by tests/app.sh, whose functions it calls.

# halves PYTHON: two halves of a front that touch along x = 0 in one plane, after
# a change, as halves.json, and a scene of them.
halves() {
    python3 - "$1" >halves.json <<'EOT'
import json
import sys
square = [[0, 0], [20, 0], [20, 30], [0, 30]]
edges = [{"endpoints": [k, (k + 1) % 4]} for k in range(4)]
left = {"vertices": [[x - 20, y] for x, y in square], "edges": edges}
right = {"vertices": square, "edges": edges}
pattern = {"panels": {"left": left, "right": right}}
exec(sys.argv[1])
json.dump({"pattern": pattern, "properties": {"units_in_meter": 100}}, sys.stdout)
EOT
    echo '{"frames": 0, "gravity": [0, 0, 0], "garments":
        [{"pattern": "halves.json", "cell": 0.01, "at": [0, 1, 0]}]}' >garment.json
}
# starts PYTHON: the condition holds of x, the places at which garment.json starts,
# by panel.
starts() {
    rm -rf halves.out
    "$drape" run garment.json --out halves.out >out 2>err &&
        python3 - "$1" <<'EOT'
import json
import struct
import sys
with open("halves.out/frames/cloth_0000.ply", "rb") as file:
    body = file.read().split(b"end_header\n", 1)[1]
x, at = {}, 0
for cloth in json.load(open("halves.out/report.json"))["bodies"]:
    n = cloth["particles"][0] * cloth["particles"][1]
    x[cloth["name"]] = list(struct.iter_unpack("<3f", body[12 * at:12 * (at + n)]))
    at += n
near = lambda a, b: abs(a - b) < 1e-6
assert eval("(" + sys.argv[1] + ")"), {name: (min(p), max(p)) for name, p in x.items()}
EOT
}
halves ''
is 'panels of one plane that touch are parted' starts '
near(max(p[0] for p in x["left"]), -0.01) and near(min(p[0] for p in x["right"]), 0.01)
and near(min(p[1] for p in x["left"]), 1) and all(p[2] == 0 for p in x["left"])'
is 'and named' grep -q 'panels left and right touch in one plane, and are parted by 1 cm' err
halves 'for p in (left, right): p.update(rotation=[30, 40, 50], translation=[1, 2, 3])'
is 'wherever their plane is' starts '
near(min(sum((a - b) ** 2 for a, b in zip(p, q)) for p in x["left"] for q in x["right"]),
     0.02 ** 2)'
halves 'left["translation"] = [-3, 0, 0]'
is 'panels 3 cm apart stay' starts 'near(max(p[0] for p in x["left"]), -0.03)'
halves 'left["translation"] = [0, 0, 2]'
is 'panels of two planes stay' starts 'near(max(p[0] for p in x["left"]), 0)'
halves 'left["translation"] = [0.5, 5, 0]'
is 'panels that overlap a little are parted' starts '
max(p[0] for p in x["left"]) < min(p[0] for p in x["right"]) - 0.01'
halves 'left["rotation"] = [0, 90, 0]; left["translation"] = [10, 0, -5]'
refused 'panels that cross are named' '(left) triangle' run garment.json --out refused
halves 'for p in (left, right): p["translation"] = [0, 0, 50 * (p is left)]'
sed 's/"cell"/"name": "vest", "cell"/; s/"at".*/"sewn": "placed.ply"}]}/' \
    garment.json >again.json
refused 'a sewn mesh that is not there' 'sewn placed.ply: no such file' run again.json \
    --out refused
"$drape" pattern halves.json --cell 0.02 --out placed >out 2>err
cp placed/placed.ply .
refused 'a sewn mesh of other cells' 'it is of another pattern' run again.json \
    --out refused
"$drape" pattern halves.json --cell 0.01 --out placed >out 2>err
cp placed/placed.ply .
exits 'panels where a mesh has them' 0 run again.json --out worn
is 'have the names of their garment' grep -q '"name": "vest.left"' worn/report.json
sed 's/"halves.json"/"none.json"/' garment.json >again.json
refused 'a garment of no pattern' 'pattern none.json: no such file' run again.json
refused 'a unit of what is no mesh' '--unit is for a MESH.obj' sew again.json --unit 1

# closed PYTHON: the condition holds of sew, the report of a garment that was sewn.
closed() {
    python3 -c "import json
sew = json.load(open('shirt/sew.json'))
assert ($1), sew['seams']"
}
cp "$root/app/patterns/tee.json" .
sed 's/"cell": 0.01/"cell": 0.04/' "$root/app/patterns/worn.json" >worn.json
halves '
pattern["stitches"] = [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}]]
for p in (left, right): p["rotation"] = [90, 0, 0]'
echo '{"frames": 400, "obstacles": [{"shape": "plane"}], "garments":
    [{"pattern": "halves.json", "cell": 0.02, "at": [0, 0.05, 0]}]}' >floor.json
exits 'what is sewn above a floor' 0 sew floor.json --no-picture --out floor
is 'comes to rest on it' grep -q 'at rest; 1 of 1 seams closed; 0 pairs' out
if [ -z "$brief" ]; then
    cp "$root/app/patterns/bag.json" .
    sed 's/"cell": 0.01/"cell": 0.02/' "$root/app/patterns/hung.json" >hung.json
    exits 'a bag hangs on a rail' 0 sew hung.json --no-picture --out rail
    is 'by its handles, at rest' grep -q 'at rest; 7 of 7 seams closed; 0 pairs' out
fi
# a band across the ends of their seam, by which both are gathered to four fifths
halves '
pattern["stitches"] = [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 3}],
                       [{"panel": "left", "edge": 2}, {"panel": "band", "edge": 0}],
                       [{"panel": "right", "edge": 2}, {"panel": "band", "edge": 1}]]
pattern["panels"]["band"] = {
    "vertices": [[-16, 0], [0, 0], [16, 0], [16, 6], [-16, 6]],
    "translation": [0, 33, 0], "rotation": [-40, 0, 0],
    "edges": [{"endpoints": [k, (k + 1) % 5]} for k in range(5)]}'
echo '{"frames": 100, "gravity": [0, 0, 0],
    "garments": [{"pattern": "halves.json", "cell": 0.02}]}' >band.json
exits 'a gathered edge is sewn' 0 sew band.json --no-picture --out shirt
is 'to what is shorter, and closed' closed '
all(s["closed"] and s["gap_cells"] < 0.01 for s in sew["seams"])'
is 'a seam across the end of another comes after it' closed '
[s["stage"] for s in sew["seams"]] == ["seams", "across", "across"]
and 0 < sew["stages"]["across"] < sew["stages"]["worn"]'
# a sleeve around an arm, whose end is sewn to what is 30 cm further down
halves '
def panel(name, width, *at):
    ring = [[0, 0], [width, 0], [width, 16], [0, 16]]
    panels[name] = {"vertices": ring, "edges": edges, "translation": at,
                    "rotation": [0, 0 if at[2] > 0 else 180, 0]}
panels = pattern["panels"] = {}
panel("front", 20, -10, -8, 12)
panel("back", 20, 10, -8, -12)
panel("chest", 8, 12, -38, 12)
panel("spine", 8, 20, -38, -12)
pattern["stitches"] = [[{"panel": a, "edge": i}, {"panel": b, "edge": j}] for a, i, b, j in
    (("front", 2, "back", 2), ("front", 0, "back", 0), ("front", 1, "chest", 3),
     ("back", 3, "spine", 1))]'
echo '{"frames": 110, "gravity": [0, 0, 0],
    "obstacles": [{"shape": "capsule", "radius": 0.04, "length": 0.6, "at": [0, 0, 0],
                   "angle": 90, "axis": [0, 0, 1]}],
    "garments": [{"pattern": "halves.json", "cell": 0.02}]}' >arm.json
exits 'a sleeve is sewn' 0 sew arm.json --no-picture --out shirt --force
is 'around its arm before to anything else' closed '
[s["stage"] for s in sew["seams"]] == ["around", "around", "seams", "seams"]
and 0 == sew["stages"]["around"] < sew["stages"]["seams"]
and all(s["closed"] for s in sew["seams"])'
# two panels that face each other, drawn together at one edge
halves '
left["translation"], right["translation"] = [0, 0, 15], [-20, 0, -15]
pattern["stitches"] = [[{"panel": "left", "edge": 1}, {"panel": "right", "edge": 1},
                        "right_wrong"]]'
echo '{"frames": 70, "gravity": [0, 0, 0],
    "garments": [{"pattern": "halves.json", "cell": 0.02}]}' >wings.json
exits 'wings are sewn' 0 sew wings.json --no-picture --out shirt --force
is 'and swing on slowly after their edges meet' python3 -c '
import struct
data = open("shirt/frames/cloth_0070.ply", "rb").read().split(b"end_header\n", 1)[1]
x = [x for x, y, z in struct.iter_unpack("<3f", data[:12 * 352])]
assert max(x) - min(x) > 0.05, max(x) - min(x)'
sed 's/"frames": 70/&, "wind": {"velocity": [0, 0, 3]}/' wings.json >blown.json
exits 'wings are sewn in a scene with wind' 0 sew blown.json --no-picture --out shirt --force
is 'which comes once they are worn' python3 -c '
import json
import struct
def mean(k):
    name = "shirt/frames/cloth_%04d.ply" % k
    data = open(name, "rb").read().split(b"end_header\n", 1)[1]
    z = [z for x, y, z in struct.iter_unpack("<3f", data[:12 * 352])]
    return sum(z) / len(z)
worn = json.load(open("shirt/sew.json"))["stages"]["worn"]
assert abs(mean(worn)) < 1e-3 and mean(70) > 0.1, (mean(worn), mean(70))'
# bands FRICTION STITCHES: two bands that are closed around a ball, on which they
# slip up and down if nothing holds them; `height` then has the least distance of
# each from the ball's equator when that is done, in m.
bands() {
    halves '
panels = pattern["panels"] = {}
for name, y, z in (("upper", 3, 18), ("above", 3, -18), ("lower", -13, 18), ("below", -13, -18)):
    panels[name] = {"vertices": [[0, 0], [40, 0], [40, 10], [0, 10]], "edges": edges,
                    "translation": [-20 if z > 0 else 20, y, z],
                    "rotation": [0, 0 if z > 0 else 180, 0]}
pattern["stitches"] = [[{"panel": a, "edge": i}, {"panel": b, "edge": j}] for a, i, b, j in
    (("upper", 1, "above", 3), ("upper", 3, "above", 1), ("lower", 1, "below", 3),
     ("lower", 3, "below", 1), ("upper", 0, "lower", 2), ("above", 0, "below", 2))]
del pattern["stitches"]['"$2"':]'
    echo '{"frames": 60, "gravity": [0, 0, 0], "garments": [{"pattern": "halves.json", "cell": 0.02}],
        "obstacles": [{"shape": "sphere", "radius": 0.14, "at": [0, 0, 0], "friction": '"$1"'}]}' \
        >ball.json
    "$drape" sew ball.json --no-picture --out ball --force >out 2>err
    python3 - >height <<'EOT'
import struct
with open("ball/frames/cloth_0059.ply", "rb") as file:
    x = list(struct.iter_unpack("<3f", file.read().split(b"end_header\n", 1)[1][:48 * 126]))
print(*(round(min(abs(y) for _, y, _ in x[126 * k:126 * k + 126]), 3) for k in range(4)))
EOT
}
if [ -z "$brief" ]; then
    bands 0 4
    is 'without friction bands slip on a ball' awk '{ exit !($1 > 0.05 && $3 > 0.05) }' height
    bands 1 4
    is 'which the friction of a body keeps them from' awk '{ exit !($1 < 0.04 && $3 < 0.04) }' height
fi
bands 0 6
is 'nor do they leave what they will be sewn to' awk '{ exit !($1 < 0.04 && $3 < 0.04) }' height
sed 's/0.14/0.15/; s/60/90/; s/"friction": 0/&.3/' ball.json >tight.json
exits 'bands that are too tight creep' 1 sew tight.json --no-picture --out shirt --force
is 'and nothing waits for that' closed '0 < sew["stages"].get("seams", 90) < 86'
sed 's/: 90/: 170/' tight.json >slips.json
exits 'till they may slip' 0 sew slips.json --no-picture --out shirt --force
is 'to where they fit, and need no force' closed '
sew["stages"]["seams"] < sew["stages"]["free"] < sew["stages"]["worn"]
and all(s["closed"] and s["pull_N_per_m"] < 30 for s in sew["seams"])'
halves 'left["translation"] = [-3, 0, 0]'
exits 'a T-shirt is sewn on a body' 0 sew worn.json --frames 120 --no-picture \
    --out shirt --trace --force
is 'a trace counts the steps of all stages' sh -c '
[ "$(tail -n +2 shirt/trace.csv | cut -d, -f1 | uniq | wc -l)" = \
    "$(sed -n "s/.*\"steps\": \([0-9]*\), \"dt.*/\1/p" shirt/sew.json)" ]'
is 'all its seams are closed' closed '
all(s["closed"] and s["gap_cells"] < 0.01 for s in sew["seams"])'
is 'nothing crosses in any frame' closed '
len(sew["frames"]) == sew["steps"] + 1 and not any(f["pairs"] for f in sew["frames"])'
exits 'an audit of its frames' 0 audit shirt
is 'counts apart what a seam joins' grep -qE \
    ' 0 of them with intersecting pairs, 0 pairs; [0-9]+ that a seam joins' out
is 'nothing is stretched' sh -c '! grep -q "is stretched" err'
exits 'and goes on as a scene' 0 run shirt/sewn.json --frames 2 --out on
exits 'an audit of a run by its report' 0 audit on
is 'knows the seams, too' grep -q 'that a seam joins' out
mv tee.json elsewhere.json
exits 'an audit whose pattern is gone' 1 audit on
is 'counts what seams join, and says so' grep -q 'tells no seams' err
mv elsewhere.json tee.json
refused 'a garment that is not sewn' 'is not sewn yet: `drape sew` sews it' \
    run worn.json --out refused
# a body that walks, and one that goes to where its walk begins
cp "$root/app/patterns/skirt.json" .
python3 "$root/app/patterns/walk.py" walk 0.5
exits 'a skirt is sewn on a body that walks' 0 sew skirt.json --body walk/body.ply \
    --motion walk/walk.pc2 --cell 0.06 --frames 130 --no-picture --out shirt --force
is 'the body is where its frames have it' python3 -c '
import json
import struct
from geometry import load
sew = json.load(open("shirt/sew.json"))
worn = sew["stages"]["moving"]
assert worn <= 130 and sew["steps"] == worn + 30, sew["stages"]
assert sum(f["stage"] == "moving" for f in sew["frames"]) == 30
cache = open("walk/walk.pc2", "rb").read()
n = struct.unpack_from("<i", cache, 16)[0]
for k in (0, 1, worn, worn + 1, worn + 30):
    frame = max(k - worn, 0)
    want = list(struct.iter_unpack("<3f", cache[32 + 12 * n * frame:][:12 * n]))
    x = load("shirt/frames/obstacles_%04d.ply" % k)[0]
    assert [tuple(p) for p in x] == want, k'
is 'all seams hold' closed '
all(s["closed"] and s["gap_cells"] < 0.01 for s in sew["seams"])'
exits 'nothing crosses as it walks' 0 audit shirt
is 'the garment that is left is the one before' python3 -c '
from geometry import load
import json
worn = json.load(open("shirt/sew.json"))["stages"]["moving"]
x = load("shirt/sewn_0000.ply")[0]
assert x == load("shirt/frames/cloth_%04d.ply" % worn)[0]
assert x != load("shirt/frames/cloth_%04d.ply" % (worn + 30))[0]'
exits 'and its scene walks' 0 run shirt/sewn.json --frames 5 --out on --force
python3 - <<'EOT'
import json
scene = json.load(open("shirt/sewn.json"))
scene["garments"][0].pop("sewn")
scene["garments"][0]["cell"] = 0.06
json.dump(scene, open("walks.json", "w"))
EOT
exits 'a scene says that bodies move' 1 sew walks.json --frames 20 --no-picture \
    --out shirt --force
is 'which they do not before it is worn' grep -q 'no body moves, as the garment is not' err
exits 'or not at all' 1 sew walks.json --frames 20 --no-motion --no-picture --out shirt \
    --force
is 'without a word' sh -c '! grep -q "moves" err'
refused 'a motion of no body' '--motion: expected --body' sew skirt.json --motion walk/walk.pc2
refused 'a rate of nothing' '--rate: expected --motion' sew skirt.json --rate 30
refused 'no rate' '--rate x: expected a number' sew skirt.json --rate x
refused 'a motion of a scene' '--motion, --rate' sew worn.json --motion walk/walk.pc2
# a plate between front and back, wider than both
python3 - <<'EOT'
import json
scene = json.load(open("worn.json"))
scene["obstacles"] = [{"name": "plate", "shape": "plane", "extent": [0.4, 0.02, 2],
                       "axis": [1, 0, 0], "angle": 90, "at": [0, 1.2, 0.01]}]
json.dump(scene, open("blocked.json", "w"))
EOT
"$drape" sew blocked.json --frames 30 --no-picture --out shirt --force >out 2>err
is 'a seam that cannot close is named' grep -q 'seam front 3 to back 5 is open by' err
is 'pulls no harder than it may' closed '
all(s["pull_N_per_m"] < 30.01 for s in sew["seams"])'
is 'and tears nothing' closed 'not any(f["pairs"] for f in sew["frames"])'
refused 'a garment without a seam' 'there is no seam to sew' sew garment.json --out refused
