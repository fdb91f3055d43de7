# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Bodies that deform by point caches, by numbered files of other formats and at
# times of their own, and limbs. Read by tests/app.sh, whose functions it calls.

# A tetrahedron of four vertices, of which vertex 3 is at (0, 1 + k, 0) in frame k,
# as PLY, as OBJ files and as point caches, right ones and wrong ones.
python3 - <<'EOT'
import struct
x = [(0, 0, 0), (1, 0, 0), (0, 0, 1), (0, 1, 0)]
tri = [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]
def frame(k):
    return [*x[:3], (0, 1 + k, 0)]
def ply(name, points):
    with open(name, "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points))
        file.write("property double x\nproperty double y\nproperty double z\n")
        file.write("element face 4\nproperty list uchar int vertex_indices\nend_header\n")
        for p in points:
            file.write("%g %g %g\n" % p)
        for t in tri:
            file.write("3 %d %d %d\n" % t)
ply("tetra.ply", x)
for k in range(3):
    with open("tetra_%d.obj" % k, "w") as file:
        for p in frame(k):
            file.write("v %g %g %g\n" % p)
        for t in tri:
            file.write("f %d %d %d\n" % tuple(i + 1 for i in t))
# In frame 0 of these vertex 3 is where vertex 0 is: they are two all the same.
for k in range(2):
    with open("meet_%d.off" % k, "w") as file:
        file.write("OFF\n4 4 0\n")
        for p in [*x[:3], (0, float(k), 0)]:
            file.write("%g %g %g\n" % p)
        for t in tri:
            file.write("3 %d %d %d\n" % t)
def cache(name, frames, head=b"POINTCACHE2\0", version=1, points=4, rate=1.0, cut=0):
    data = struct.pack("<12siiffi", head, version, points, 7.0, rate, len(frames))
    for each in frames:
        data += b"".join(struct.pack("<3f", *p) for p in each)
    with open(name, "wb") as file:
        file.write(data[:len(data) - cut])
good = [frame(k) for k in range(3)]
cache("good.pc2", good)
cache("half.pc2", good, rate=0.5)
cache("late.pc2", good[1:])
cache("head.pc2", good, head=b"POINTCACHE3\0")
cache("newer.pc2", good, version=2)
cache("count.pc2", good, points=5)
cache("none.pc2", [])
cache("rate.pc2", good, rate=0.0)
cache("short.pc2", good, cut=1)
cache("nan.pc2", [*good[:2], [(0, 0, 0), (0, float("nan"), 0), (0, 0, 1), (0, 1, 0)]])
open("tiny.pc2", "wb").write(b"POINTCACHE2\0")
EOT
# tells FILE KEYS: a scene of a body with these keys, far from a cloth, 0.5 s a frame.
tells() {
    cat >"$1" <<EOT
{"frames": 4, "dt": 0.5, "precision": 64, "cloths": [{"particles": [3, 3],
  "size": [0.1, 0.1], "start": {"at": [0, 90, 0]}}], "obstacles": [{$2}],
 "motions": [{"name": "m", "keys": [{"time": 0}]}]}
EOT
}
# rises NAME KEYS HEIGHTS: the top of the body is so high in frames 0 to 4.
rises() {
    tells rises.json "$2"
    rm -rf rises
    exits "$1" 0 run rises.json --out rises
    is "$1: where it should be" python3 -c '
import sys
from geometry import load
for k, want in enumerate(eval(sys.argv[1])):
    top = max(p[1] for p in load("rises/frames/obstacles_%04d.ply" % k, "d")[0])
    assert abs(top - want) < 1e-12, (k, top, want)' "$3"
}
mesh='"mesh": "tetra.ply", "frames": {"file": "good.pc2"'
rises 'a point cache' "$mesh, \"dt\": 0.5}" '[1, 2, 3, 3, 3]'
rises 'a point cache, between frames' "$mesh, \"dt\": 1}" '[1, 1.5, 2, 2.5, 3]'
rises 'a point cache of two samples a frame' \
    '"mesh": "tetra.ply", "frames": {"file": "half.pc2", "dt": 1}' '[1, 2, 3, 3, 3]'
rises 'a point cache, placed' "$mesh, \"dt\": 0.5}, \"scale\": 2, \"at\": [0, -1, 0]" \
    '[1, 3, 5, 5, 5]'
rises 'at times' "$mesh, \"times\": [0.5, 1, 2]}" '[1, 1, 2, 2.5, 3]'
# The velocity at the middle frame is (3 - 1) / 2, at the last 2 · 1 / 1.5 - 1.
rises 'a cubic' "$mesh, \"times\": [0, 0.5, 2], \"between\": \"cubic\"}" \
    '[1, 2, 22 / 9, 25 / 9, 3]'
rises 'OBJ files' '"frames": {"files": "tetra_%d.obj", "count": 3, "dt": 0.5}' \
    '[1, 2, 3, 3, 3]'
rises 'OFF files with a place that two vertices share once' \
    '"frames": {"files": "meet_%d.off", "count": 2, "dt": 0.5}' '[0, 1, 1, 1, 1]'
rises 'as many OBJ files as there are' '"frames": {"files": "tetra_%d.obj", "dt": 0.5}' \
    '[1, 2, 3, 3, 3]'
late='"mesh": "tetra.ply", "frames": {"file": "late.pc2", "dt": 0.5'
rises 'a mesh that goes to the first frame' "$late, \"lead\": 1}" '[1, 1.5, 2, 3, 3]'
rises 'at times of their own' "$late, \"times\": [0.5, 0.75], \"lead\": 0.5}" \
    '[1, 1, 2, 3, 3]'
rises 'the same of OBJ files' '"mesh": "tetra_0.obj", "frames": {"files": "tetra_%d.obj",
    "first": 1, "dt": 0.5, "lead": 1}' '[1, 1.5, 2, 3, 3]'
rises 'a mesh that is there' "$mesh, \"dt\": 0.5, \"lead\": 1}" '[1, 2, 3, 3, 3]'
# Two balls, 0.1 in radius, as one mesh, which come 1 cm into each other, or 14 cm.
python3 - <<'EOT'
import math
import struct
around, rings, r = 24, 15, 0.1
def ball(y):
    x = []
    for i in range(1, rings):
        a = math.pi * i / rings
        x += [(r * math.sin(a) * math.cos(2 * math.pi * (k + i / 2) / around),
               y + r * math.cos(a),
               r * math.sin(a) * math.sin(2 * math.pi * (k + i / 2) / around))
              for k in range(around)]
    return x + [(0, y + r, 0), (0, y - r, 0)]
tri, n = [], around * (rings - 1)
for k in range(around):
    for i in range(rings - 2):
        a, b = i * around + k, i * around + (k + 1) % around
        tri += [(a, b, a + around), (b, b + around, a + around)]
    tri.append((n, (k + 1) % around, k))
    tri.append((n + 1, n - around + k, n - around + (k + 1) % around))
tri += [tuple(n + 2 + v for v in t) for t in tri]
def write(name, height, tri=tri):
    x = ball(height) + ball(-height)
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(x)
    head += "".join("property double %s\n" % c for c in "xyz")
    head += "element face %d\nproperty list uchar int vertex_indices\nend_header\n"
    with open(name, "wb") as file:
        file.write((head % len(tri)).encode())
        file.write(b"".join(struct.pack("<3d", *p) for p in x))
        file.write(b"".join(struct.pack("<B3i", 3, *t) for t in tri))
for k in range(13):
    write("press_%02d.ply" % k, max(0.095, 0.12 - 0.0025 * k))
write("deep.ply", 0.03)
write("open.ply", 0.2, tri[1:])
EOT
cat >press.json <<'EOT'
{"frames": 16, "cloths": [{"particles": [11, 11], "size": [0.3, 0.3]}],
 "obstacles": [{"name": "balls", "frames": {"files": "press_%02d.ply"}, "apart": 0.008}]}
EOT
sed 's/, "apart": 0.008//' press.json >trap.json
exits 'a sheet between parts that press on each other is trapped' 1 run trap.json --out trap
is 'in all their steps' grep -q '9 of them intersect at their end' out
exits 'and is not where they make room' 0 run press.json --out press
is 'and what gave way is told' grep -q 'press on each other in 6 of 13 frames' err
exits 'they do not meet' 0 audit press/frames/obstacles_0016.ply
exits 'as they would' 1 audit press_12.ply
is 'they part in the middle and are named' python3 -c '
import json
from geometry import load
rows = json.load(open("press/parted.json"))
assert {row["frame"] for row in rows} == set(range(7, 13)), rows
assert all(row["parted"] and row["body"] == "balls" for row in rows), rows
deep = max(row["depth_m"] for row in rows)
assert 0.008 < deep < 0.0091, deep
x, was = load("press/frames/obstacles_0016.ply")[0], load("press_12.ply", "d")[0]
half = len(x) // 2
gap = min(p[1] for p in x[:half]) - max(p[1] for p in x[half:])
assert 0.0075 < gap < 0.0085, gap  # ways are along normals
moved = sum(max(abs(a - b) for a, b in zip(p, q)) > 1e-6 for p, q in zip(x, was))
assert 0 < moved < half, moved'
tells press.json '"mesh": "deep.ply", "apart": 0.008'
exits 'parts too deep in each other' 0 run press.json --out press --force
is 'stay as they are, and are named' python3 -c '
import json
from geometry import load
rows = json.load(open("press/parted.json"))
assert rows and not any(row["parted"] for row in rows), rows
assert load("press/obstacles.ply", "d")[0] == load("deep.ply", "d")[0]'
# wrong NAME KEYS TEXT
wrong() {
    tells wrong.json "$2"
    refused "$1" "$3" plan wrong.json
}
for name in head newer; do
    wrong "no point cache: $name" "\"mesh\": \"tetra.ply\", \"frames\": {\"file\": \"$name.pc2\"}" \
        "$name.pc2: not a point cache of version 1"
done
wrong 'a head alone' '"mesh": "tetra.ply", "frames": {"file": "tiny.pc2"}' 'not a point cache'
wrong 'a cache of another mesh' '"mesh": "tetra.ply", "frames": {"file": "count.pc2"}' \
    'count.pc2: has 5 vertices, its mesh 4'
wrong 'no frames' '"mesh": "tetra.ply", "frames": {"file": "none.pc2"}' 'has 0 frames'
wrong 'no time between samples' '"mesh": "tetra.ply", "frames": {"file": "rate.pc2"}' \
    'its frames are 0 apart'
wrong 'a cache cut off' '"mesh": "tetra.ply", "frames": {"file": "short.pc2"}' \
    'short.pc2: 143 bytes of frames, expected 144 for 3 frames of 4 vertices'
wrong 'no number' '"mesh": "tetra.ply", "frames": {"file": "nan.pc2"}' \
    'nan.pc2: frame 2, vertex 1: a coordinate is not finite'
wrong 'a cache without a mesh' '"frames": {"file": "good.pc2"}' 'expected the mesh beside it'
wrong 'a cache of a format without an order' \
    '"mesh": "tetra_0.obj", "frames": {"file": "good.pc2"}' \
    'tetra_0.obj: expected .ply or .off'
wrong 'no such cache' '"mesh": "tetra.ply", "frames": {"file": "gone.pc2"}' 'gone.pc2'
wrong 'files and a cache' '"frames": {"file": "good.pc2", "files": "a_%d.ply", "count": 1}' \
    'expected either files with count, or the file'
wrong 'a motion and frames' "$mesh}, \"motion\": \"m\"" 'has both a motion and frames'
wrong 'times that do not ascend' "$mesh, \"times\": [0, 1, 1]}" \
    'frames.times[2]: 1: expected more than 1'
wrong 'too few times' "$mesh, \"times\": [0, 1]}" 'frames.times: 2 times of 3 frames'
wrong 'a lead from no mesh' '"frames": {"files": "tetra_%d.obj", "lead": 1}' \
    'frames.lead: expected the mesh beside it that goes to the first frame'
wrong 'a lead to another mesh' '"mesh": "tetra.ply", "frames": {"file": "count.pc2", "lead": 1}' \
    'count.pc2: has 5 vertices, its mesh 4'
wrong 'parts of an open mesh' '"mesh": "open.ply", "apart": 0.008' \
    'apart: expected a closed mesh'
wrong 'no times' "$mesh, \"times\": []}" 'frames.times: expected a time a frame'
wrong 'another way between' "$mesh, \"between\": \"spline\"}" '"spline"'
limb='"shape": "limb", "radius": 0.1, "length": 0.4, "detail": 16'
wrong 'a limb that folds into itself' "$limb, \"bend\": [{\"time\": 0, \"angle\": 120}]" \
    'bend[0]: 120 degrees: expected less than 114.6'
wrong 'bends that do not ascend' "$limb, \"bend\": [{\"time\": 1}, {\"time\": 1}]" \
    'bend: times must ascend'
wrong 'a limb with a motion' "$limb, \"bend\": [{\"time\": 1}], \"motion\": \"m\"" \
    'has both a motion and frames'
tells limb.json "$limb, \"bend\": [{\"time\": 0}, {\"time\": 2, \"angle\": 90}]"
exits 'a limb' 0 run limb.json --out limb
# Its axis is 0.1 up to the joint, which bends by 90 degrees along 0.2, and 0.1 beyond:
# then come the caps. Radii stay: nothing is nearer to or farther from the axis.
is 'bends as it should' python3 -c '
import math
from geometry import load
frames = [load("limb/frames/obstacles_%04d.ply" % k, "d")[0] for k in range(5)]
for k in range(5):
    angle = math.radians(22.5 * k)
    r = 0.2 / angle if k else 0
    for a, b in zip(frames[0], frames[k]):
        along = min(max((a[1] + 0.1) / 0.2, 0), 1)
        c, s = math.cos(along * angle), math.sin(along * angle)
        rest = a[1] + 0.1 - 0.2 * along
        x = r * (1 - c) + rest * s if k else 0
        y = (r * s if k else 0.2 * along) + rest * c - 0.1
        want = (x + a[0] * c, y - a[0] * s, a[2])
        assert math.dist(b, want) < 1e-5, (k, a, b, want)'
