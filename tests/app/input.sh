# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154,SC2016
# Faults in scenes and meshes are refused; correct ones are read.
# Read by tests/app.sh, whose functions it calls.

# Scenes
limited() {
    printf '{"frames": 1, "cloths": [{"particles": [9, 9], "size": [0.1, 0.1],
 "material": {"limit": %s}}]}\n' "$1" >limit.json
}
limited 0.05
is 'one limit of strain' "$drape" plan limit.json
limited '[0.05, 0, 0.1]'
is 'three limits of strain' "$drape" plan limit.json
limited 0.001
refused 'limit too small' '$.cloths[0].material.limit: 0.001' run limit.json
limited '[0.05, 0.05]'
refused 'two limits' 'limit: expected a list of 3' run limit.json
limited '[0.05, 0.05, 11]'
refused 'limit too large' 'limit[2]: 11' run limit.json
limited '[0.01, 0.01, 0.01]'
is 'limits as small as may be' "$drape" plan limit.json
for limit in '0.005, 0.05, 0.05' '0.05, 0.005, 0.05' '0.05, 0.05, 0.005'; do
    limited "[$limit]"
    refused "limits $limit" 'limit: 0.005: expected 0, for none, or 0.01 to 10' \
        run limit.json
done
# A heavy sheet that hangs from a corner; a number s is [s, s, 2 s].
for limit in 0.05 '[0.05, 0.05, 0.1]' '[0.05, 0.05, 0.2]' '[0.05, 0.2, 0.1]'; do
    limited "$limit, \"density\": 5"
    sed -i 's/"size"/"pins": [{"at": [0, 0]}], &/' limit.json
    exits "limit $limit" 0 run limit.json --frames 12 --out "limit $limit" --quiet
done
is 'a number limits all directions' cmp 'limit 0.05/cloth.pc2' \
    'limit [0.05, 0.05, 0.1]/cloth.pc2'
for limit in '[0.05, 0.05, 0.2]' '[0.05, 0.2, 0.1]'; do
    is "it is not $limit" sh -c '! cmp -s "limit 0.05/cloth.pc2" "$0/cloth.pc2"' \
        "limit $limit"
done
tabled() {
    printf '{"frames": 1, "cloths": [{"particles": [9, 9], "size": [0.1, 0.1],
 "material": {"stretch": {%s}}}]}\n' "$1" >table.json
}
tabled '"modulus": 1000, "warp": [[0.01, 8], [0.03, 60]]'
is 'a measured tension' "$drape" plan table.json
tabled '"warp": [[0.01, 8], [0.01, 60]]'
refused 'strains that do not ascend' \
    '$.cloths[0]: material.stretch.warp[1]: strain 0.01, expected 0.010001' \
    run table.json
tabled '"bias": [[0.01, 8], [0.02, 7]]'
refused 'forces that fall' 'stretch.bias[1]: 7 N/m, expected at least 8' \
    run table.json
tabled '"weft": [[0.01, 8], [0.02]]'
refused 'half a point' 'stretch.weft[1]: expected [strain, N/m]' run table.json
tabled '"weft": []'
refused 'an empty table' 'stretch.weft: expected at least one point' \
    run table.json
tabled "\"weft\": [$(i=0; while [ $((i += 1)) -le 16 ]; do printf '[0.0%s, %s],' $((i + 10)) $i; done)[1, 99]]"
refused '17 points' 'stretch.weft: expected a list of at most 16' run table.json
tabled '"wrap": [[0.01, 8]]'
refused 'an unknown direction' 'did you mean "warp"' run table.json
tabled '"modulus": 0'
refused 'no modulus' 'material.stretch.modulus: 0' run table.json
tabled '"bias": [[0.01, 1]]'
refused 'a bias softer than shear' \
    '$.cloths[0]: material.stretch.bias[0]: 1 N/m' run table.json
printf '{"frames": 3,\n "cloths": [}\n' >broken.json
refused 'malformed JSON, by line and column' 'broken.json: line 2, column 13:' \
    run broken.json
printf '\357\273\277{"cloths": [{"particles": [3, 3]}]}' >mark.json
is 'a scene that begins with the mark of UTF-8' "$drape" plan mark.json
for code in UTF-16 UTF-16LE UTF-16BE; do
    iconv -f UTF-8 -t $code tiny.json >wide.json
    refused "a scene in $code" 'wide.json: is in UTF-16' plan wide.json
    printf '1,1\n' | iconv -t $code >wide.csv
    refused "queries in $code" 'wide.csv: is in UTF-16' ccd --kind vf wide.csv
    printf 'OFF\n' | iconv -t $code >wide.off
    refused "a mesh in $code" 'wide.off: is in UTF-16' audit wide.off
done
printf '{"pattern": {"panels": {}, "stitches": []}, "parameters": {}}' >garment.json
refused 'a pattern of GarmentCode' \
    'garment.json: is a sewing pattern of GarmentCode, which `drape pattern` cuts' \
    run garment.json
refused 'a scene as a pattern' 'tiny.json: is a scene, which `drape run` takes' \
    pattern tiny.json
printf '#usda 1.0\n' >layer.usda
printf 'PXR-USDC\000' >crate.usdc
refused 'a layer of USD as a scene' 'layer.usda: is a USD file, which drape writes' \
    run layer.usda
refused 'a crate of USD as a scene' 'crate.usdc: is a USD file' plan crate.usdc
refused 'a layer of USD as a mesh' 'layer.usda: the Python package reads USD' \
    convert layer.usda out.ply
printf '{"asset": {"version": "2.0"}, "scenes": []}' >model.gltf
refused 'a glTF file as a scene' 'model.gltf: is a glTF file' run model.gltf
# hint WHERE TEXT ANSWER
hint() {
    printf '{"cloths": [{"particles": [5, 5]%s}]%s}\n' "$1" "$2" >hint.json
    refused "the answer to $1$2" "$3" plan hint.json
}
hint '' ', "obstacles": [{"file": "a.ply"}]' '"file"; did you mean "mesh"?'
hint ', "material": {"mass": 1}' '' '"mass"; did you mean "density"?'
hint ', "mass": 1' '' '"mass"; did you mean "density" in "material"?'
hint ', "position": [0, 1, 0]' '' 'did you mean "at" in "start"?'
hint '' ', "Frames": 3' '"Frames"; did you mean "frames"?'
hint '' ', "integrator": "BDF2"' '"BDF2": did you mean "bdf2"?'
hint '' ', "integrator": "newmark"' '"newmark": expected one of "euler"'
hint '' ', "backend": "cpu"' '"cpu": did you mean "ref"?'
hint '' ', "backend": "CUDA"' '"CUDA": did you mean "gpu"?'
hint '' ', "gpu": 0' '"gpu"; did you mean "backend"?'
hint '' ', "mesh": "a.ply"' '"mesh"; did you mean "mesh" in "obstacles"?'
hint '' ', "obstacles": [{"vertices": []}]' '"vertices"; did you mean "mesh"?'
hint '' ', "obstacles": [{"type": "box"}]' '"type"; did you mean "shape"?'
hint '' ', "obstacles": [{"velocity": [1, 0, 0]}]' '"velocity"; did you mean "motion"?'
hint ', "color": [1, 0, 0]' '' '"color"; did you mean "colour" in "look"?'
hint '' ', "Seams": []' '"Seams"; did you mean "garments"?'
hint '' ', "stitches": []' '"stitches"; did you mean "garments"?'
hint ', "mesh": "a.obj"' '' 'drape cannot simulate a mesh of triangles as cloth yet'
hint ', "file": "a.obj"' '' 'drape cannot simulate a mesh of triangles as cloth yet'
hint ', "material": {"tear": 1}' '' 'drape cannot tear cloth yet'
hint ', "pressure": 1' '' 'drape cannot inflate cloth yet'
hint '' ', "device": 1' 'drape cannot choose a device by its number yet'
refused 'the option -o' '-o: unknown option; did you mean --out?' run tiny.json -o refused
refused 'the option --device' '--device: unknown option: drape cannot choose a device' \
    run tiny.json --device 1
refused 'the command simulate' 'simulate: no such command; did you mean run?' simulate tiny.json
: >empty.json
refused 'empty scene' 'empty.json: empty' run empty.json
printf '[1]' >list.json
refused 'scene is a list' 'expected an object' run list.json
printf '{}' >bare.json
refused 'no cloth' 'cloths' run bare.json
refused 'missing scene' 'nowhere.json' run nowhere.json
refused 'scene is a directory' 'directory' run .
scene key.json ', "gravityy": [0, 0, 0]}'
refused 'unknown key, by name' '"gravityy"' run key.json --out refused
scene key.json ', "wind": {"speed": 3}}'
refused 'unknown key, by path' '$.wind' run key.json --out refused
scene key.json ', "frames": 5}'
refused 'key twice' 'key.json: line 13, column 10: duplicate object key' run key.json --out refused
scene key.json ', "dt": "fast"}'
refused 'wrong type' '$.dt: expected a number' run key.json --out refused
scene key.json ', "dt": -1}'
refused 'out of range' '$.dt: -1: expected a number from 1e-07 to 1' run key.json --out refused
scene key.json ', "dt": 1e999}'
refused 'number overflows' 'column 13: real number overflow' run key.json --out refused
scene key.json ', "gravity": [0, 1]}'
refused 'short vector' '$.gravity: expected a list of 3' run key.json
scene key.json ', "gravity": [0, 1, null]}'
refused 'vector of null' '$.gravity[2]' run key.json
scene key.json ', "integrator": "magic"}'
refused 'unknown choice' '"choi-ko"' run key.json
scene key.json ', "precision": 48}'
refused 'precision 48' 'precision' run key.json
scene key.json ', "motions": [{"name": "a", "keys": []}]}'
refused 'motion without keys' '$.motions[0]' run key.json
sed 's/\[9, 9\]/[40000, 9]/' tiny.json >big.json
refused 'cloth beyond 32768' '$.cloths[0].particles[0]' run big.json
sed 's/\[9, 9\]/[32768, 32768]/' tiny.json >big.json
refused 'cloth beyond the memory' 'memory' run big.json --out refused
scene key.json ', "memory": 0.001}'
sed 's/\[9, 9\]/[900, 900]/' key.json >big.json
refused 'memory limit' 'memory limit' run big.json --out refused
sed 's/\[9, 9\]/[26, 26]/' key.json >big.json
exits 'no memory for a step' 3 run big.json --out short
is 'what was done is reported' grep -q '"end": "failed"' short/report.json
is 'and its frames are there' test -s short/cloth.pc2
sed 's/\[9, 9\]/[9.5, 9]/' tiny.json >key.json
refused 'half a particle' 'whole' run key.json
sed 's/"at": \[0, 0.36, 0\]/"at": [0, 0.2, 0]/' tiny.json >start.json
refused 'start that intersects, with its count' 'intersect' \
    run start.json --out refused
is 'the count is there' grep -q '[1-9][0-9]*' err
exits 'start that intersects, allowed' 0 plan start.json --allow-intersecting
# Who is refused is told by the place in the file.
cat >places.json <<'EOF'
{"cloths": [{"particles": [3, 3], "pins": [{"at": [0, 0], "motion": "a"},
   {"at": [1, 0], "motion": "short"}]}, {"name": "b", "particles": [3, 3],
   "start": {"at": [0, 1, 0]}},
  {"name": "c", "particles": [3, 3], "start": {"at": [0.1, 1, 0.1], "v": [0, 1, 1]}}],
 "motions": [{"name": "a", "keys": [{}]}, {"name": "short", "keys": [{"time": 999999},
   {"time": 999999.0000000002, "angle": 100}]}],
 "obstacles": [{"shape": "box", "at": [0, -3, 0]}, {"shape": "box",
   "at": [0, -6, 0], "name": "d"}]}
EOF
refused 'a motion that the library refuses' '$.motions[1]: time ' plan places.json
sed 's/0000002/01/' places.json >crossing.json
refused 'two cloths that cross' 'crossing.json: the start state is intersecting: cloth 1 (b) triangle ' \
    plan crossing.json
is 'both by name' grep -Eq 'cloth 1 \(b\) triangle [0-7] and cloth 2 \(c\) triangle [0-7] \(first of [0-9]+ pairs\); move them apart' err
sed 's/-6, 0/1, 0/; s/"v": \[0, 1, 1\]/"v": [0, 0, 1]/; s/0.1, 1, 0.1/0, 9, 0/' \
    crossing.json >crossing2.json
refused 'a cloth that crosses an obstacle' \
    'intersecting: cloth 1 (b) triangle ' plan crossing2.json
is 'both by name, too' grep -Eq 'and obstacle 1 \(d\) triangle [0-9]+' err
printf 'OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >still_0.off
python3 - <<'EOT'
import json
scene = json.load(open("places.json"))
scene["motions"].pop()
scene["cloths"][0]["pins"].pop()
scene["cloths"].pop()
other = json.loads(json.dumps(scene))
scene["obstacles"][1] = {"frames": {"files": "still_%d.off", "count": 1}, "motion": "a",
                         "at": [0, -6, 0]}
json.dump(scene, open("twice.json", "w"))
other.update(integrator="euler", dt=1, max_substeps=1)
json.dump(other, open("stable.json", "w"))
EOT
refused 'an obstacle that moves in two ways' \
    'twice.json: $.obstacles[1]: has both a motion and frames' plan twice.json
refused 'a cloth that needs more steps' 'stable.json: $.cloths[0]: stable from' \
    plan stable.json
sed 's/"thickness": 0.01/"thickness": 0/' tiny.json >key.json
refused 'thickness 0' 'thickness' run key.json --out refused

# Fabrics
fabric() { # FILE MATERIAL: a small sheet of it that falls
    printf '{"frames": 2, "cloths": [{"particles": [9, 9],
        "size": [0.4, 0.4], "pins": [{"at": [0, 0]}], "material": %s}]}\n' \
        "$2" >"$1"
}
exits 'fabrics are listed' 0 materials
is 'as a table and, apart from it, what each is' awk 'BEGIN { RS = "" }
    NR == 1 && !/^name .*friction/ { bad = 1 } END { exit bad || NR != 2 }' out
is 'denim is' grep -q '^denim  *0.324 ' out
is 'with its source' grep -q 'Wang' out
is 'all have the numbers and the words of their list' python3 -c '
import re, sys
text = re.sub(r"\bWANG\b", "\"Wang\"", open(sys.argv[1]).read())
rows = [re.split(r",\s*", body, 7) for body in re.findall(
    r"^FABRIC\((.*?)\)$", text, re.S | re.M)]
table, words = open("out").read().split("\n\n")
told = [line.split() for line in table.splitlines()[2:]]
assert len(told) == len(rows) == 14
for row, line in zip(rows, told):
    assert line[0] == row[0].strip("\"") and len(line) == 7, line
    assert all(abs(float(a) / float(b) - 1) < 0.005
               for a, b in zip(line[1:], row[1:7])), (line, row)
said = words.splitlines()
assert [line.split()[0] for line in said[::2]] == [line[0] for line in told]
for row, line in zip(rows, said[::2]):
    assert row[7].startswith("\"" + line[12:]), (line, row)
assert all(line[:12] == 12 * " " and line[12:].strip() for line in said[1::2])' \
    "$root/app/scene/fabrics.def"
refused 'materials takes no argument' 'no argument' materials denim
fabric named.json '"denim"'
fabric same.json '{"density": 0.324, "stretch": 641.8, "shear": 26.7,
    "bend": 7.7e-5, "thickness": 0.002, "friction": 0.3}'
fabric other.json '{"bend": 1e-3, "name": "denim"}'
for f in named same other; do
    exits "a sheet: $f" 0 run $f.json --out $f --no-obj
done
is 'a fabric is its numbers' cmp named/cloth.pc2 same/cloth.pc2
is 'a key overrides it' sh -c '! cmp -s named/cloth.pc2 other/cloth.pc2'
for name in denm Denim DENIM; do
    fabric bad.json "\"$name\""
    refused "the fabric $name" \
        "\$.cloths[0].material: unknown fabric \"$name\"; did you mean \"denim\"?" \
        run bad.json --out refused
done
fabric bad.json '"paper"'
refused 'unknown fabric, by path' '$.cloths[0].material: unknown fabric "paper"' \
    run bad.json --out refused
is 'the fabrics are named' grep -q 'denim, interlock.*leather' err
fabric bad.json '{"name": "felt"}'
refused 'unknown name of a fabric' '$.cloths[0].material.name: unknown' \
    run bad.json --out refused
fabric bad.json '{"name": 3}'
refused 'a number as a fabric' '.material.name: expected the name' run bad.json
fabric bad.json '["denim"]'
refused 'a list as a fabric' '.material: expected' run bad.json

# Meshes
obstacle nowhere.obj
refused 'missing mesh' 'mesh.json: $.obstacles[0]: mesh nowhere.obj: found' \
    run mesh.json --out refused
for end in ply obj off stl gltf; do
    : >empty.$end
    obstacle empty.$end
    refused "empty $end" "empty.$end" run mesh.json --out refused
done
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' >points.obj
obstacle points.obj
refused 'points only' 'points.obj' run mesh.json --out refused
printf 'v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n' >nan.obj
obstacle nan.obj
refused 'NaN in OBJ' 'not finite' run mesh.json --out refused
head='ply\nformat ascii 1.0\nelement vertex 3\nproperty double x
property double y\nproperty double z\nelement face 1
property list uchar int vertex_indices\nend_header\n'
# shellcheck disable=SC2059
{
    printf "${head}0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n" >inf.ply
    printf "${head}0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n" >index.ply
    printf "${head}0 0 0\n1 0 0\n0 1\n" >short.ply
    printf "${head}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n" >good.ply
}
obstacle inf.ply
refused 'infinity in PLY' 'not finite' run mesh.json --out refused
obstacle index.ply
refused 'index out of range' 'vertex 7' run mesh.json --out refused
obstacle short.ply
refused 'PLY that ends early' 'short.ply' run mesh.json --out refused
printf 'ply\nformat martian 1.0\nend_header\n' >format.ply
obstacle format.ply
refused 'PLY of no format, by line' 'line 2' run mesh.json --out refused
obstacle good.ply
exits 'good PLY' 0 run mesh.json --out good
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n' >flat.obj
obstacle flat.obj
exits 'degenerate faces are accepted' 0 run mesh.json --out flat
is 'and reported' grep -q '1 triangles without area' err
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n' \
    >fins.obj
obstacle fins.obj
exits 'non-manifold obstacle is accepted' 0 run mesh.json --out fins

# What has no effect is said, and no more than that.
# idle WHERE TEXT KEY WHY
idle() {
    printf '{"cloths": [{"particles": [5, 5]%s}]%s}\n' "$1" "$2" >idle.json
    exits "idle: $1$2" 0 plan idle.json
    is "it is said of $3" grep -qxF "drape: idle.json: $3: note: has no effect: $4" err
    is "and of nothing else, $3" test "$(wc -l <err)" -eq 1
}
for key in '"velocity": [1, 0, 0]' '"drag": 2' '"lift": 2'; do
    name=${key%%:*} name=${name#?}
    idle '' ", \"wind\": {$key, \"density\": 0}" "\$.wind.${name%?}" 'there is no density'
done
for key in '"velocity": [1, 0, 0]' '"density": 2'; do
    name=${key%%:*} name=${name#?}
    idle '' ", \"wind\": {$key, \"drag\": 0, \"lift\": 0}" "\$.wind.${name%?}" \
        'there is neither drag nor lift'
done
idle '' ', "camera": {"sun": [0, 1, 0], "light": 0}' '$.camera.sun' 'it has no light'
idle '' ', "block": 64' '$.block' 'backend ref computes'
idle '' ', "integrator": "verlet", "response": "solve"' '$.response' \
    'the integrator is explicit'
idle '' ', "integrator": "verlet", "tolerance": 0.01' '$.tolerance' \
    'the integrator is explicit'
idle '' ', "max_substeps": 9' '$.max_substeps' 'the integrator is implicit'
idle ', "start": {"folds": 3}' '' '$.cloths[0].start.folds' 'the cloth is not hung'
idle ', "start": {"shape": "hung", "gap": 0.1}' '' '$.cloths[0].start.gap' \
    'the cloth is not rolled'
idle ', "start": {"shape": "hung", "folds": 2}' '' '$.cloths[0].start.folds' \
    'they have no depth'
idle ', "start": {"shape": "hung", "depth": 0.1}' '' '$.cloths[0].start.depth' \
    'there are no folds'
idle ', "pins": [{"at": [0, 0], "every": 1}]' '' '$.cloths[0].pins[0].every' \
    'the pin is a single particle'
low='"at": [0, -2, 0]'
idle '' ", \"obstacles\": [{\"shape\": \"sphere\", \"extent\": [1, 1, 1], $low}]" \
    '$.obstacles[0].extent' 'it is of other shapes'
idle '' ", \"obstacles\": [{\"shape\": \"box\", \"axis\": [1, 0, 0], $low}]" \
    '$.obstacles[0].axis' 'there is no angle'
idle '' ", \"obstacles\": [{\"shape\": \"box\", \"look\": {\"check\": true}, $low}]" \
    '$.obstacles[0].look.check' 'it is of cloths'
idle '' ", \"obstacles\": [{\"shape\": \"box\", \"friction\": 0.1, $low}]" \
    '$.obstacles[0].friction' "a pair takes the larger, which is a cloth's"
up='"motions": [{"name": "up", "keys": [{"time": 0}, {"time": 1, "move": [0, 1, 0]}]}]'
idle '' ", $up" '$.motions[0]' 'neither an obstacle nor a pin names it'
led=', "pins": [{"edge": "u0", "motion": "up"}]'
idle "$led" ", ${up%'}]'}, \"pivot\": [1, 0, 0]}]" '$.motions[0].pivot' 'no key has an angle'
idle "$led" ", ${up%'}]}]'}, \"axis\": [1, 0, 0]}]}]" '$.motions[0].keys[1].axis' \
    'no key has an angle'
printf '{"cloths": [{"particles": [33, 9], "size": [1, 0.25], "pins": [{"edge": "u0", "every": 1}],
 "start": {"shape": "hung", "folds": 2, "depth": 0.05, "at": [0, 3, 0]}}],
 "wind": {"velocity": [0, 0, 0], "drag": 0}, "obstacles": [{"shape": "funnel",
 "radius": 1, "throat": 0.1, "length": 1, "height": 1, "detail": 8, "axis": [1, 0, 0],
 "angle": 1, "at": [0, -9, 0]}]}\n' >busy.json
exits 'all that has an effect' 0 plan busy.json
is 'of which nothing is said' test ! -s err
# A body in millimetres, and one in kilometres
python3 - <<'EOF'
for name, size in ("mm", 3000), ("km", 0.0005), ("m", 3):
    with open("%s.off" % name, "w") as file:
        file.write("OFF\n3 1 0\n0 -9 0\n%g -9 0\n0 -9 %g\n3 0 1 2\n" % (size, size))
EOF
for unit in mm:3e+03 km:0.0005; do
    printf '{"cloths": [{"particles": [5, 5]}], "obstacles": [{"mesh": "%s.off"}]}\n' \
        "${unit%:*}" >unit.json
    exits "a body in ${unit%:*}" 0 plan unit.json
    is "its size is said, in ${unit%:*}" grep -qF \
        "unit.json: \$.obstacles[0]: note: the mesh is ${unit#*:} m across, the largest cloth 1 m" \
        err
done
printf '{"cloths": [{"particles": [5, 5]}], "obstacles": [{"mesh": "m.off"},
 {"mesh": "mm.off", "size": 2000}]}\n' >unit.json
exits 'a body in metres, and one of a size that is asked for' 0 plan unit.json
is 'of which no size is said' test ! -s err
