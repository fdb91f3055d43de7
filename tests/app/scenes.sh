# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# What a scene may say and what it may not: lists, regions, pins, starts, motions,
# frames of an obstacle, and names.
# Read by tests/app.sh, whose functions it calls.

# with KEYS: scene.json, a tiny cloth with these keys beside it
with() {
    printf '{"frames": 0, "cloths": [{"particles": [2, 2]}]%s}\n' \
        "${1:+, $1}" >scene.json
}
# denied TEXT KEYS: a scene with these keys is refused with this text
denied() {
    with "$2"
    refused "scene: $1" "$1" plan scene.json
}

# Lists as long as they may be, and one longer
is 'scenes of long lists' python3 - <<'EOT'
import json
key = lambda k: {"time": k}
most = {"cloths": (1000, lambda k: {"particles": [2, 2], "start": {"at": [0, k, 0]}}),
        "obstacles": (1000, lambda k: {"shape": "plane", "at": [0, -1 - k, 0]}),
        "motions": (1000, lambda k: {"name": "m%d" % k, "keys": [{}]}),
        "motions[0].keys": (10000, key),
        "cloths[0].holes": (10000, lambda k: {"disc": [0.5, 0.5, 0.1]}),
        "cloths[0].cuts": (10000, lambda k: {"disc": [0.6, 0.6, 0.1]}),
        "cloths[0].pins": (10000, lambda k: {"at": [0, 0]})}
for name, (count, item) in most.items():
    for more in (0, 1):
        scene = {"frames": 0, "cloths": [{"particles": [5, 5]}]}
        body, _, part = name.partition("[0].")
        items = [item(k) for k in range(count + more)]
        if not part:
            scene[body] = items
        elif body == "cloths":
            scene["cloths"][0][part] = items
        else:
            scene[body] = [{"name": "m", part: items}]
        with open("list_%s_%d.json" % (part or body, more), "w") as file:
            json.dump(scene, file)
EOT
for list in cloths obstacles motions keys holes cuts pins; do
    exits "a list of as many $list as may be" 0 plan list_${list}_0.json
    case $list in
    cloths | obstacles | motions) most=1000 ;;
    *) most=10000 ;;
    esac
    refused "a longer list of $list" "$list: expected a list of at most $most" \
        plan list_${list}_1.json
done
points=$(awk 'BEGIN { for (k = 1; k <= 16; k++) printf "%s[%g, %d]",
    (k > 1 ? "," : ""), k / 100, 20 * k }')
printf '{"frames": 0, "cloths": [{"particles": [5, 5],
    "material": {"stretch": {"warp": [%s]}}}]}' "$points" >scene.json
exits 'a table of 16 points' 0 plan scene.json

# Values and keys
denied '$.integrator: "magic": expected one of "euler", "midpoint", "verlet", "rk4", "baraff-witkin", "choi-ko", "bdf2"' '"integrator": "magic"'
denied '$.matrix: expected one of "cdf", "compact"' '"matrix": 1'
denied '$.sleep: expected true or false' '"sleep": 1'
denied '$.name: expected a text that is not empty' '"name": ""'
denied '$.name: expected a text that is not empty' '"name": 5'
denied '$.wind: unknown key "color"; expected one of velocity, density, drag, lift' \
    '"wind": {"color": 1}'
letters=abcdefghijklmnopqrstuvwxyzabcdefghijklmnopqrstuvwxyzabcdefgh
denied "$: unknown key \"$letters\"; expected one of name, memory, frames, steps_" \
    "\"${letters}ij\": 1"
denied '$: unknown key "a?b?c"' '"a\u007fb\u001fc": 1'
denied '$: precision: expected 32 or 64' '"precision": 33'

# Names
with
cp scene.json a.b.json
cp scene.json .hidden
is 'a scene is called as its file without its ending' sh -c \
    '"$0" plan a.b.json | grep -q "^a.b: 4 vertices, 2 triangles$"' "$drape"
is 'a name that is an ending is a name' sh -c \
    '"$0" plan .hidden | grep -q "^.hidden: "' "$drape"
is 'a scene from a pipe is called so' sh -c \
    'cat scene.json | "$0" plan - | grep -q "^scene: "' "$drape"
with '"name": "a/b\u007f\n\u0020c"'
exits 'a run without --out' 0 run scene.json --quiet
is 'goes into a folder of its name' test -s 'a_b__ c.out/report.json'
is 'may have four fifths of the memory' python3 -c '
import json, os
told = json.load(open("a_b__ c.out/report.json"))["settings"]["memory"]
has = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 1e9
assert abs(told - 0.8 * has) < 1e-9 * has, (told, has)'
is 'bodies without a name have that of their kind' python3 -c '
import json
assert [b["name"] for b in json.load(open("a_b__ c.out/report.json"))["bodies"]] == [
    "cloth"]'
long=$(printf '%05000d' 0)
refused 'a scene with a long name' '…: the path is too long' plan "$long"
refused 'a folder with a long name' '--out: the path is too long' \
    run scene.json --out "$long"
refused 'a mesh with a long name' 'too long' convert good.ply "$long/a.ply"

# Regions. The particle in the corner, which no region names, is there.
# patch KEYS: a cloth of 11 × 9 particles, 1 m × 0.8 m, pinned in its corner
patch() {
    printf '{"frames": 0, "cloths": [{"particles": [11, 9], "size": [1, 0.8],
  "pins": [{"at": [0, 0]}], %s}]}\n' "$1" >patch.json
}
patch '"holes": [{"disc": [0.5, 0.4, 0.11]}, {"rect": [0.7, 0.1, 0.8, 0.2]}],
  "cuts": [{"rect": [0.2, 0.1, 0.3, 0.2]}, {"disc": [0.25, 0.65, 0.01]}]'
exits 'regions by disc alone and by rect alone' 0 plan patch.json
patch '"holes": [{}]'
refused 'a region of nothing' 'holes[0]: expected disc or rect' plan patch.json
patch '"cuts": [{"disc": [0, 0, 0.01]}]'
refused 'a cut around a corner' 'cells are 0.1 m × 0.1 m' plan patch.json
patch '"holes": [{"disc": [0.9999, 0.8, 0]}]'
refused 'a hole beside a particle' 'takes nothing away' plan patch.json
patch '"holes": [{"disc": [1, 0.8, 0]}]'
exits 'a hole of one particle' 0 plan patch.json
patch '"particles": 3'
refused 'a key twice' 'duplicate object key' plan patch.json
sed 's/\[11, 9\]/[11, 9.5]/; s/, "particles": 3//' patch.json >half.json
refused 'half a row' 'particles: expected whole numbers' plan half.json

# Pins
# pinned PINS: the same cloth with these pins
pinned() {
    patch '"look": {}'
    sed -i "s/\"pins\": .*\], /\"pins\": [$1], /" patch.json
}
for pin in '{}' '{"edge": "u0", "at": [0, 0]}' '{"every": 0.1}'; do
    pinned "$pin"
    refused "a pin $pin" 'pins[0]: expected either edge or at' plan patch.json
done
pinned '{"at": [1.04, 0.84]}'
exits 'a pin half a cell beside the cloth' 0 plan patch.json
for at in '1.06, 0.4' '0.5, 0.86'; do
    pinned "{\"at\": [$at]}"
    refused "a pin at $at" "pins[0].at: [$at]: expected a place" plan patch.json
done
pinned '{"at": [0, 0], "motion": "up"}'
refused 'a pin of no motion' 'pins[0].motion: "up": no motion of this name' \
    plan patch.json
pinned '{"at": [0, 0], "motion": 0}'
refused 'a pin of a number' 'pins[0].motion: expected the name of a motion' \
    plan patch.json

# Starts
for start in '"u": [0, 0, 0]' '"v": [2, 0, 0]' '"v": [0, 0, 0]' \
    '"u": [1, 2, 3], "v": [1, 2, 3.000001]'; do
    patch "\"start\": {$start}"
    refused "start $start" '$.cloths[0]: start: u and v must be two directions' \
        plan patch.json
done
for start in '"hung", "folds": 2, "depth": 0.12' '"rolled", "radius": 0.1'; do
    patch "\"start\": {\"shape\": $start}"
    refused "start $start" 'start: the cloth is too coarse or too narrow' \
        plan patch.json
done
patch '"start": {"shape": "hung", "folds": 2, "depth": 0.11}'
exits 'folds that are just not too deep' 0 plan patch.json
patch '"start": {"shape": "rolled", "radius": 0.11, "gap": 0.05}'
exits 'a roll that is just not too narrow' 0 plan patch.json

# Motions
denied '$.motions[0]: expected a name and at least one key' \
    '"motions": [{"keys": [{}]}]'
denied '$.motions[1]: expected a name and at least one key' \
    '"motions": [{"name": "a", "keys": [{}]}, {"name": "b"}]'
for times in '1, 1' '2, 1'; do
    denied 'keys: times must ascend' "\"motions\": [{\"name\": \"a\", \"keys\": [
        {\"time\": ${times%,*}}, {\"time\": ${times#*,}}]}]"
done
denied 'keys[0]: axis: expected a direction, not zero' \
    '"motions": [{"name": "a", "keys": [{"axis": [0, 0, 0]}]}]'

# Obstacles
box='"shape": "box", "at": [0, 5, 0]'
denied '$.obstacles[0]: expected one of mesh, shape and frames' '"obstacles": [{}]'
denied '$.obstacles[1]: expected one of mesh, shape and frames' \
    "\"obstacles\": [{$box}, {$box, \"mesh\": \"good.ply\"}]"
for files in wave wave_%d_%d.ply wave_%0004d.ply wave_%s.ply wave_%4; do
    denied 'frames: expected files with one %d or %04d in the name' \
        "\"obstacles\": [{\"frames\": {\"files\": \"$files\", \"count\": 2}}]"
done
denied 'mesh wave_1.ply: found neither' \
    '"obstacles": [{"frames": {"files": "wave_%d.ply"}}]'
denied 'frames: expected files with one' '"obstacles": [{"frames": {"count": 2}}]'
denied '$.obstacles[0].frames.count: 0: expected' \
    '"obstacles": [{"frames": {"files": "wave_%d.ply", "count": 0}}]'
with "\"obstacles\": [{\"mesh\": \"$work/flat.obj\"}, {\"mesh\": \"flat.obj\",
    \"at\": [0, 0, 9]}], \"allow_intersecting\": true"
exits 'a mesh by its whole path' 0 run scene.json --out flats
is 'triangles without area of all meshes' grep -q 'obstacles have 2 triangles' err
with "\"obstacles\": [{$box}]"
exits 'a box, whose triangles look in all directions' 0 run scene.json --out flats \
    --force
is 'all its triangles have areas' sh -c '! grep "without area" err'
denied "$work/none.obj: no such mesh file" \
    "\"obstacles\": [{\"mesh\": \"$work/none.obj\"}]"
