# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Obstacles that deform and that move are where their files and keys say.
# Read by tests/app.sh, whose functions it calls.

# Frames of a deforming obstacle
# series NAME...: an obstacle of two of these files, the second 1/30 s behind
series() {
    sed "s/{\"mesh\".*}\]/{\"frames\": {$1, \"count\": 2, \"dt\": 0.0$(
        )333333333333333333}, \"scale\": 2, \"at\": [0, -3, 1]}]/" mesh.json >frames.json
}
ply turn_0.ply '3 0 1 2'
ply turn_1.ply '3 1 0 2'
series '"files": "turn_%d.ply"'
refused 'frames of other triangles' \
    '$.obstacles[0]: turn_1.ply: other triangles' run frames.json --out refused
ply turn_1.ply '3 0 1 2
3 0 2 1' 'face 1' 'face 2'
refused 'frames of more triangles' \
    '$.obstacles[0]: turn_1.ply: another number' run frames.json --out refused
cp five.ply turn_1.ply
refused 'frames of more vertices' \
    '$.obstacles[0]: turn_1.ply: another number' run frames.json --out refused
cp turn_0.ply turn_1.ply
exits 'frames of the same' 0 plan frames.json
for k in 007 008 009; do
    ply turn_$k.ply '3 0 1 2' '^1 0 0$' "1 0.${k}5 -1"
done
series '"files": "turn_%03d.ply", "first": 7'
sed -i 's/"frames": 1/"frames": 3, "precision": 64/' frames.json
exits 'frames from number 7 on' 0 run frames.json --out series --quiet
is 'are met at their times, and where they are placed' python3 -c '
from geometry import load
for k in range(4):
    x = sum(load("series/frames/obstacles_%04d.ply" % k, "d")[0], ())
    assert len(x) == 9
    y = 0.0075 + min(k / 2, 1) * 0.001
    for a, b in zip(x, [0, -3, 1, 2, 2 * y - 3, -1, 0, -1, 1]):
        assert abs(a - b) < 1e-12, (k, x)'

# Motions
# motion FILE KEYS [PIVOT]: a box that moves by these keys, far from a cloth.
motion() {
    cat >"$1" <<EOT
{"frames": 6, "cloths": [{"particles": [3, 3], "size": [0.1, 0.1],
  "start": {"at": [0, 9, 0]}}],
 "obstacles": [{"shape": "box", "extent": [0.4, 0.6, 1], "motion": "s"}],
 "motions": [{"name": "s", "pivot": ${3-[0, 0, 0]}, "keys": [$2]}]}
EOT
}
# turns NAME KEYS [PIVOT MOVE]: from one key to the other each of six frames rotates
# by the same angle about one axis: 0, 1/6 … 6/6 of the rotation, degrees AXIS…; it
# goes about the pivot, and 0, 1/6 … 6/6 of the way.
turns() {
    exits "$1" 0 run motion.json --out turn --force
    is "$1: evenly" python3 - "$2" "${3-[0, 0, 0]}" "${4-[0, 0, 0]}" <<'EOT'
import math, sys
from geometry import load
def turned(q, x):
    w, u = q[0], q[1:]
    c = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                      a[0] * b[1] - a[1] * b[0]]
    t = [2 * v for v in c(u, x)]
    return [x[i] + w * t[i] + c(u, t)[i] for i in range(3)]
def quaternion(axis, degrees):
    n, h = math.hypot(*axis), math.radians(degrees) / 2
    return [math.cos(h)] + [math.sin(h) * a / n for a in axis]
keys, pivot, move = map(eval, sys.argv[1:])
box = [[(.2, -.2)[not k & 1], (.3, -.3)[not k & 2], (.5, -.5)[not k & 4]]
       for k in range(8)]
for k in range(7):
    t = k / 6
    if len(keys) == 1: # one axis, from an angle to another
        axis, a, b = keys[0]
        q = quaternion(axis, a + t * (b - a))
    else: # along the great circle between two orientations
        p, r = (quaternion(*key) for key in keys)
        d = sum(x * y for x, y in zip(p, r))
        r, d = ([-x for x in r], -d) if d < 0 else (r, d)
        o = math.acos(d)
        q = [(math.sin((1 - t) * o) * x + math.sin(t * o) * y) / math.sin(o)
             for x, y in zip(p, r)]
    for x, y in zip(box, load("turn/frames/obstacles_%04d.ply" % k)[0]):
        x = turned(q, [a - p for a, p in zip(x, pivot)])
        x = [a + p + t * m for a, p, m in zip(x, pivot, move)]
        assert math.dist(x, y) < 1e-3, (k, x, y)
EOT
}
motion motion.json '{"time": 0}, {"time": 0.1, "angle": 90, "axis": [1, 0, 0]}'
turns 'turn from angle 0 of the default axis' '[([1, 0, 0], 0, 90)]'
motion motion.json '{"time": 0, "angle": 30, "axis": [1, 0, 0]},
    {"time": 0.1, "angle": 100, "axis": [0, 1, 1]}'
turns 'turn between two axes' '[([1, 0, 0], 30), ([0, 1, 1], 100)]'
motion motion.json '{"time": 0, "angle": 350, "axis": [1, 0, 0]},
    {"time": 0.1, "angle": 100, "axis": [0, 0, 2]}'
turns 'turn between two axes, the shorter way' \
    '[([1, 0, 0], 350), ([0, 0, 1], 100)]'
motion motion.json '{"time": 0, "angle": 20, "axis": [0, 0, 1]},
    {"time": 0.1, "angle": 40, "axis": [0, 0, -3]}'
turns 'turn between opposite axes' '[([0, 0, 1], 20, -40)]'
motion motion.json '{"time": 0, "axis": [0, 0, 1]},
    {"time": 0.1, "angle": 500, "axis": [0, 3, 0]}'
turns 'more than a turn about one axis' '[([0, 1, 0], 0, 500)]'
motion motion.json '{"time": 0, "axis": [0, 0, 1]},
    {"time": 0.1, "angle": 90, "axis": [0, 0, 1], "move": [1, 2, -3]}' '[4, 5, 6]'
turns 'a turn about a pivot, on the way' '[([0, 0, 1], 0, 90)]' '[4, 5, 6]' '[1, 2, -3]'
keys=$(awk 'BEGIN { for (k = 0; k < 4000; k++)
    printf "{\"time\": %d, \"angle\": %d},", k, k % 2 ? 36000 : -36000 }')
motion motion.json "${keys%,}"
refused 'turns without end' '$.motions: the turns come to' plan motion.json

# Animated meshes
is 'meshes whose motion is known' python3 "$root/tests/app/mesh.py" write
# moving NAME KIND OBSTACLE: a run in which the obstacle moves as this kind does.
moving() {
    printf '{"frames": 80, "cloths": [{"particles": [3, 3], "size": [0.1, 0.1],
 "start": {"at": [0, 900, 0]}}], "obstacles": [{%s}]}\n' "$3" >moving.json
    rm -rf moving
    exits "$1" 0 run moving.json --out moving
    is "$1, as it should" python3 "$root/tests/app/mesh.py" check "$2" moving
}
moving 'nodes of glTF' nodes '"mesh": "nodes.gltf"'
cp moving.json animated.json
moving 'bones of glTF' bones '"mesh": "bones.gltf"'
moving 'morph targets of glTF' morph '"mesh": "morph.gltf"'
moving 'a node of FBX, in centimetres' slide '"mesh": "slide.fbx"'
moving 'bones of FBX' bones '"mesh": "bones.fbx"'
moving 'at rest, if that is asked for' still '"mesh": "nodes.gltf", "animation": false'
moving 'the first of two animations' nodes '"mesh": "two.gltf"'
is 'which is said, with both names' grep -qF \
    'several animations, of which the first is taken: "swing", "lift";' err
moving 'another, by name' lift '"mesh": "two.gltf", "animation": "lift"'
is 'of which nothing is said' sh -c '! grep -q several err'
moved() {
    printf '{"cloths": [{"particles": [3, 3]}], "motions": [{"name": "m", "keys": [
 {"time": 0}]}], "obstacles": [{%s}]}\n' "$2" >moving.json
    refused "animation: $1" "$3" plan moving.json
}
moved 'a motion beside it' '"mesh": "bones.gltf", "motion": "m"' \
    '$.obstacles[0]: bones.gltf is animated, and a body has a motion or an animation'
moved 'no such name' '"mesh": "two.gltf", "animation": "walk"' \
    'two.gltf: cannot be read as a mesh: has no animation of this name'
moved 'of a mesh that has none' '"mesh": "cube.fbx", "animation": "walk"' \
    'cube.fbx: cannot be read as a mesh: has no animation'
moved 'of a mesh of another format' '"mesh": "wide.off", "animation": "walk"' 'wide.off'
moved 'of a shape' '"shape": "box", "animation": "walk"' \
    '$.obstacles[0]: animation: expected a mesh beside it'
moved 'a number' '"mesh": "two.gltf", "animation": 1' \
    'animation: expected the name of an animation, or false'
# A body of several files is placed as its first file would be.
python3 - <<'EOF'
for k in range(2):
    with open("rise_%d.off" % k, "w") as file:
        file.write("OFF\n4 4 0\n%s\n3 0 1 2\n3 0 2 3\n3 0 3 1\n3 1 3 2\n" % "\n".join(
            "%g %g %g" % (x * (1 + k), y + 3 * k, z) for x, y, z in
            [(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)]))
EOF
printf '{"frames": 1, "dt": 0.5, "cloths": [{"particles": [3, 3], "size": [0.1, 0.1],
 "start": {"at": [0, 90, 0]}}], "obstacles": [{"size": 1, "stand": true,
 "frames": {"files": "rise_%%d.off", "count": 2, "dt": 0.5}}]}\n' >rise.json
exits 'a body of files that grows and rises' 0 run rise.json --out rise
is 'does not stand on the ground in each' python3 -c '
from geometry import load
a, b = (load("rise/frames/obstacles_000%d.ply" % k, "f")[0] for k in range(2))
assert sorted(a) == sorted([(-.5, 0, -.5), (.5, 0, -.5), (-.5, 1, -.5), (-.5, 0, .5)])
assert sorted(b) == sorted([(-.5, 1.5, -.5), (1.5, 1.5, -.5), (-.5, 2.5, -.5),
                            (-.5, 1.5, .5)])'
# Units of FBX
exits 'a cube of 100 cm' 0 convert cube.fbx cube.ply
is 'is 1 m high' python3 -c '
from geometry import load
v, _ = load("cube.ply", "f")
assert len(v) == 8 and {c for p in v for c in p} == {0, 1, -0.5, 0.5}'
exits 'written as FBX' 0 convert cube.ply again.fbx
exits 'and read again' 0 convert again.fbx again.ply
is 'it is the same' cmp cube.ply again.ply
