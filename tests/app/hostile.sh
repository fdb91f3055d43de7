# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh disable=SC2154
# Damaged and malicious meshes and scenes are refused with one line.
# Read by tests/app.sh, whose functions it calls.

# no_mesh NAME TEXT FILE: every command refuses the file as a mesh, with TEXT.
no_mesh() {
    refused "$1" "$3: $2" convert "$3" refused.ply
}

# Formats that assimp reads in a child process
# collada FILE COUNT: two triangles with five vertices; the file claims COUNT
# numbers for them.
collada() {
    cat >"$1" <<EOT
<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"
 version="1.4.1"><library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" $2>0 0 0 1 0 0 1 1 0 0 1 0 .5 .5 1
</float_array><technique_common><accessor source="#a" count="5" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 1 4 1 2 4</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n">
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
EOT
}
collada good.dae 'count="15"'
exits 'good COLLADA' 0 convert good.dae good_dae.ply
is 'its triangles' grep -q '2 triangles' out
# One that waits for ever is ended by the alarm that it set.
cat >clock.c <<'EOF'
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
unsigned alarm(unsigned seconds)
{
    const char *end = getenv("END"); /* a signal, or less an exit status */
    if (end && atoi(end) < 0)
        _exit(-atoi(end));
    if (end)
        raise(atoi(end));
    FILE *told = fopen("alarm", "a");
    if (told && fprintf(told, "%u\n", seconds) > 0)
        fclose(told);
    return 0;
}
EOF
if ldd "$drape" | grep -q 'lib[a-z]*san' ||
    ! "${CC:-cc}" -shared -fPIC clock.c -o clock.so 2>/dev/null; then
    skip 'the alarm of a reader: no library can stand before this tool'
else
    is 'a reader sets its alarm' env LD_PRELOAD="$PWD/clock.so" "$drape" \
        convert good.dae alarm.ply
    is 'to four times its 10 s of CPU time' test "$(cat alarm)" = 40
    # ends HOW WORDS: a reader that ends so is said to
    ends() {
        env END="$1" LD_PRELOAD="$PWD/clock.so" "$drape" convert good.dae late.ply \
            >out 2>err
        is "a reader that ends by $1" test $? -eq 2 -a ! -e late.ply
        is "is told of, $1" grep -qx "drape: good.dae: cannot be read as a mesh: $(
            )its reader $2" err
    }
    ends 14 'took more than 40 s' # SIGALRM
    ends 24 'took more than 10 s' # SIGXCPU
    ends 11 'crashed (signal 11, Segmentation fault)'
    ends -7 'ended with exit status 7 and no mesh'
fi
collada many.dae 'count="9999999999"'
why=' needs more than 1000 MB'
ldd "$drape" | grep -q 'lib[a-z]*san' && why= # the sanitizer ends it itself
no_mesh 'COLLADA that wants all memory' \
    "cannot be read as a mesh: its reader$why" many.dae
# Here assimp 5.2 reads beyond the end of an array.
collada crash.dae 'coqnt="15"'
no_mesh 'COLLADA that crashes its reader' 'cannot be read as a mesh' crash.dae
obstacle crash.dae
refused 'the same as an obstacle' 'crash.dae: cannot' run mesh.json \
    --out refused
cp good.dae good.x3d
no_mesh 'ending that is not known' 'expected a mesh file that ends in' good.x3d

# Indices of OBJ count from 1, or from the last vertex backwards.
corners='v 0 0 0\nv 1 0 0\nv 0 1 0\n'
printf '%bf -3 -2 -1\n' "$corners" >back.obj
exits 'OBJ that counts backwards' 0 convert back.obj back.ply
is 'its triangle' grep -q '3 vertices, 1 triangles' out
for face in '1 2 9' '1 2 0' '1 2 -7' '1 2 99999999999'; do
    printf '%bf 1 2 3\nf %s\n' "$corners" "$face" >index.obj
    no_mesh "OBJ, face $face" 'cannot be read' index.obj
done
# gltf FILE TAIL COUNT: three vertices and COUNT indices, of which TAIL, in
# base 64, has the last.
gltf() {
    base=AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA
    cat >"$1" <<EOT
{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
 "nodes": [{"mesh": 0}], "meshes": [{"primitives": [
  {"attributes": {"POSITION": 0}, "indices": 1}]}],
 "accessors": [
  {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
  {"bufferView": 1, "componentType": 5121, "count": $3, "type": "SCALAR"}],
 "bufferViews": [{"buffer": 0, "byteLength": 36},
  {"buffer": 0, "byteOffset": 36, "byteLength": $3}],
 "buffers": [{"byteLength": $((36 + $3)),
  "uri": "data:application/octet-stream;base64,$base$2"}]}
EOT
}
gltf good.gltf AAEC 3
exits 'good glTF' 0 convert good.gltf good_gltf.ply
gltf index.gltf AAECAAEJ 6
no_mesh 'glTF, index out of range' 'cannot be read as a mesh' index.gltf
is 'what assimp says of it is said' grep -Eqi 'as a mesh: [^:]*out.of.range' err
# nodes COUNT: glTF of a triangle in a node, which lies in COUNT others
nodes() {
    gltf nodes.gltf AAEC 3
    sed "s/.\"nodes\": \[{\"mesh\": 0}\]/ \"nodes\": [$(awk -v n="$1" 'BEGIN {
        for (k = 1; k <= n; k++) printf "{\"children\": [%d]}, ", k
        print "{\"mesh\": 0}]" }')/" nodes.gltf >deep.gltf
}
nodes 200
exits 'glTF, a node in 200 others' 0 convert deep.gltf deep.ply
nodes 300
no_mesh 'glTF, a node in 300 others' \
    'cannot be read as a mesh: its nodes lie in more than 256 others' deep.gltf
printf 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n' >cut.stl
no_mesh 'STL that ends early' 'cannot be read as a mesh' cut.stl

# OFF
# off FILE HEAD FACES...: four vertices and these faces.
off() {
    file=$1
    printf '%s\n' "$2" '0 0 0' '1 0 0' '# aside' '' '0 1 0' '0 0 1' >"$file"
    shift 2
    [ $# -eq 0 ] || printf '%s\n' "$@" >>"$file"
}
off good.off 'OFF 4 2 0' '3 0 1 2' '4 0 1 2 3 0.5 0.5 0.5'
exits 'good OFF' 0 convert good.off good_off.ply
is 'a quad is two triangles' grep -q '4 vertices, 3 triangles' out
off good.off 'COFF
4 1' '3 0 1 2'
exits 'OFF of colours, without its number of edges' 0 \
    convert good.off good_off.ply
off bad.off 'OFF 4 2 0' '3 0 1 2' '3 0 1 9'
no_mesh 'OFF, index out of range' \
    'line 9: expected a face of 3 vertices, each a whole number from 0 to 3' \
    bad.off
off bad.off 'OFF 4 1 0' '3 0 1 -1'
no_mesh 'OFF, negative index' 'line 8: expected a face' bad.off
off bad.off 'OFF 4 1 0' '3 0 1.5 2'
no_mesh 'OFF, fractional index' 'line 8: expected a face' bad.off
off bad.off 'OFF 4 1 0' '3 0 1'
no_mesh 'OFF, face too short' 'line 8: expected a face' bad.off
off bad.off 'OFF 4 2 0' '3 0 1 2'
no_mesh 'OFF, face missing' 'line 8: the file ends' bad.off
obstacle bad.off
refused 'the same as an obstacle' 'bad.off: line 8' run mesh.json --out refused
off bad.off 'OFF 5 0 0'
no_mesh 'OFF, vertex missing' 'line 7: the file ends' bad.off
off bad.off 'OFF 4 0 0'
no_mesh 'OFF without faces' 'no triangles' bad.off
off bad.off 'OFF 4 1 0' '3 0 1 2' '3 0 1 3'
no_mesh 'OFF, more faces than counted' 'line 9: more lines' bad.off
off bad.off 'OFF 2147483647 1 0' '3 0 1 2'
no_mesh 'OFF of far too many vertices' 'line 1: more vertices and faces' bad.off
off bad.off 'OFF 99999999999999999999 1 0' '3 0 1 2'
no_mesh 'OFF of more than can be counted' 'line 1: expected the num' bad.off
off bad.off 'OFF BINARY'
no_mesh 'binary OFF' 'line 1: expected the numbers of' bad.off

# PLY
# A polygon is a fan of triangles.
printf '%s\n' ply 'format ascii 1.0' 'element vertex 5' 'property float x' \
    'property float y' 'property float z' 'element face 1' \
    'property list uchar int vertex_indices' end_header \
    '0 0 0' '1 0 0' '2 1 0' '1 2 0' '0 1 0' >five.ply
sed -e 's/face 1/face 3/' five.ply >fan.ply
echo '5 0 1 2 3 4' >>five.ply
printf '%s\n' '3 0 1 2' '3 0 2 3' '3 0 3 4' >>fan.ply
exits 'PLY with a pentagon' 0 convert five.ply five_3.ply
exits 'PLY with its three triangles' 0 convert fan.ply fan_3.ply
is 'the same mesh' cmp five_3.ply fan_3.ply
# ply FILE FACE [FROM TO]: three vertices and a face; TO replaces FROM in the
# file.
ply() {
    printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' \
        'property double x' 'property double y' 'property double z' \
        'element face 1' 'property list uchar int vertex_indices' end_header \
        '0 0 0' '1 0 0' '0 1 0' "$2" | sed "s/${3-^$}/${4-}/" >"$1"
}
ply bad.ply '3 0 1.9 2'
no_mesh 'PLY, fractional index' 'face 0: vertex 1.9: expected a whole' bad.ply
ply bad.ply '3 0 1 3'
no_mesh 'PLY, index out of range' 'face 0: vertex 3: expected a whole' bad.ply
ply bad.ply '3 0 1 -1'
no_mesh 'PLY, negative index' 'face 0: vertex -1' bad.ply
ply bad.ply '300 0 1 2'
no_mesh 'PLY, list longer than its type' 'face 0: 300: expected' bad.ply
ply bad.ply '2.5 0 1 2'
no_mesh 'PLY, fractional list' 'face 0: 2.5: expected' bad.ply
ply bad.ply '3 0 1'
no_mesh 'PLY, face cut off' 'face 0: the file ends' bad.ply
ply bad.ply '3 0 1 2' '^0 1 0$' '0 1 z'
no_mesh 'PLY, letter as a coordinate' 'vertex 2: the file ends, or' bad.ply
for axis in x y z; do
    ply bad.ply '3 0 1 2' "double $axis" "double p$axis"
    no_mesh "PLY without $axis" 'expected vertices with properties x' bad.ply
done
ply bad.ply '3 0 1 2' 'double y' 'double x'
no_mesh 'PLY with x twice' 'expected vertices with properties x' bad.ply
ply bad.ply '3 0 1 2' 'double z' 'list uchar double z'
no_mesh 'PLY with a list as z' 'expected vertices with properties x' bad.ply
ply bad.ply '3 0 1 2' '^property double .$' 'comment none'
no_mesh 'PLY, vertices of nothing' 'expected vertices with prop' bad.ply
ply bad.ply '3 0 1 2' '^format.*' 'comment none'
no_mesh 'PLY without format' 'expected a line format' bad.ply
ply bad.ply '3 0 1 2' 'vertex 3' 'corner 3'
no_mesh 'PLY without vertices' 'expected one element vertex' bad.ply
ply bad.ply '3 0 1 2' 'vertex 3' 'vertex 2147483647'
no_mesh 'PLY of far too many vertices' 'ends before its' bad.ply
ply bad.ply '3 0 1 2' 'vertex 3' 'vertex 2147483648'
no_mesh 'PLY of more than can be counted' 'line 3: not a PLY' bad.ply
ply bad.ply '3 0 1 2' 'property list.*' 'comment none'
no_mesh 'PLY, faces of nothing' 'goes on behind what its header' bad.ply
ply bad.ply '3 0 1 2' 'element vertex 3' 'property int a'
no_mesh 'PLY, a property of no element' 'line 3: not a PLY' bad.ply
ply bad.ply '3 0 1 2' 'list uchar' 'list float'
no_mesh 'PLY, a list as long as a float' 'line 8: not a PLY' bad.ply
ply bad.ply '3 0 1 2' 'uchar int' 'uchar word'
no_mesh 'PLY, a list of no type' 'line 8: not a PLY' bad.ply
ply bad.ply '3 0 1 2' 'double y' 'triple y'
no_mesh 'PLY, a coordinate of no type' 'line 5: not a PLY' bad.ply
ply bad.ply '3 0 1 2' 'vertex 3' 'vertex -1'
no_mesh 'PLY of fewer than none' 'line 3: not a PLY' bad.ply
# many TEXT COUNT: that many lines of the header before its end
many() {
    ply bad.ply '3 0 1 2' end_header "$(awk -v text="$1" -v n="$2" 'BEGIN {
        for (k = 0; k < n; k++) printf "%s a%d%s\\n", text, k, " 0"
        print "end_header" }')"
}
many 'element' 14
exits 'PLY of 16 elements' 0 convert bad.ply many.ply
many 'element' 15
no_mesh 'PLY of 17 elements' 'line 23: not a PLY' bad.ply
many 'obj_info' 99
sed -i 's/$/\r/' bad.ply
exits 'PLY with CRLF and obj_info' 0 convert bad.ply many.ply
is 'its triangle' grep -q '3 vertices, 1 triangles' out
ply bad.ply '3 0 1 2
3 0 1 2'
no_mesh 'PLY that goes on' 'goes on behind what its header' bad.ply
ln -s /dev/zero zero.ply
no_mesh 'device as a mesh' 'is a device or a pipe' zero.ply

# Pipes and devices. A scene and queries may come through a pipe.
# hangs NAME TEXT ARGUMENTS...: refused, and within ten seconds.
hangs() {
    name=$1 text=$2
    shift 2
    timeout 10 "$drape" "$@" >out 2>err </dev/null
    got=$?
    if [ $got -eq 2 ] && [ "$(wc -l <err)" -eq 1 ] &&
        grep -qF -- "$text" err; then
        ok "$name"
    else
        bad "$name (exit $got, expected 2 and: $text)"
    fi
}
nobody='is a pipe that no process writes to'
mkfifo pipe pipe.ply
hangs 'a pipe without a writer as a scene' "pipe: $nobody" plan pipe
hangs 'as a checkpoint' "pipe: $nobody" run tiny.json --out refused \
    --resume pipe
hangs 'as queries' "pipe: $nobody" ccd --kind vf pipe
hangs 'as a mesh' 'pipe.ply: is a device or a pipe' audit pipe.ply
hangs 'a device as a scene' '/dev/zero: is a device' plan /dev/zero
hangs 'as a checkpoint' '/dev/zero: is a device' run tiny.json --out refused \
    --resume /dev/zero
hangs 'as queries' '/dev/zero: is a device' ccd --kind vf /dev/zero
# Headers that end early must not be read for ever.
printf 'ply' >bad.ply
hangs 'PLY of half a line' 'bad.ply: line 1: expected ply' convert bad.ply refused.ply
for end in '' '\ncomment' '\nelement face 1'; do
    printf 'ply\nformat ascii 1.0\ncomment the last whole line%b' "$end" >bad.ply
    hangs "PLY whose header ends early:$(printf '%b' "$end" | tail -n 1)" \
        'bad.ply: expected end_header' convert bad.ply refused.ply
done
# through COMMAND: a pipe named pipe, which a process fills by the command.
through() {
    sh -c "$1" >pipe 2>/dev/null &
    filler=$!
}
through 'sleep 1.5; cat tiny.json' # longer than a pipe without a writer waits
"$drape" plan tiny.json >expected.txt
exits 'a scene through a slow pipe' 0 plan pipe
is 'the plan is the same' cmp out expected.txt
wait $filler
(sleep 0.3 && cat tiny.json >pipe) &
exits 'a pipe whose writer is late' 0 plan pipe
wait $!
is 'the plan is the same, late' cmp out expected.txt
through 'printf "\\000"'
hangs 'a zero byte through a pipe' 'pipe: line 1, column 1: ' plan pipe
through 'exit 0'
hangs 'nothing through a pipe' "pipe: $nobody" plan pipe
through "printf 'drape run 2\\000\\000\\000\\000\\000'; exec sleep 2"
hangs 'a checkpoint through a pipe' 'pipe: cannot be read twice' run tiny.json \
    --out refused --resume pipe
kill $filler
wait $filler
is 'a scene on standard input' sh -c \
    'cat tiny.json | "$0" plan /dev/stdin | cmp - expected.txt' "$drape"

awk 'BEGIN { for (k = 0; k < 900; k++)
    printf "%s{\"shape\": \"capsule\", \"detail\": 4096}",
    k ? "," : "{\"memory\": 0.1, \"cloths\": [{}], \"obstacles\": ["
    print "]}" }' >capsules.json
exits 'shapes beyond the limit of memory' 3 plan capsules.json
is 'which is said' grep -q 'vertices: no memory left within' err

# JSON
# json NAME TEXT FILE-CONTENT
json() {
    printf '%b' "$3" >json.json
    refused "$1" "json.json: $2" plan json.json
}
json 'NaN' "line 2, column 9: invalid token near 'NaN'" '{\n"dt": NaN}'
json 'Infinity' 'line 1, column 15: ' '{"dt": Infinity}'
json 'huge number' 'line 1, column 14: real number overflow' '{"dt": 1e99999}'
json 'huge whole number' '$.frames: 1e+300: expected' '{"frames": 1e300}'
json 'fraction' '$.frames: 1.5: expected a whole number' '{"frames": 1.5}'
json 'text behind' 'line 3, column 1: end of file expected' '{}\n\n{}'
json 'zero byte' 'line 1, column 11: control character' '{"name": "a\0000b"}'
json 'comment' 'line 2, column 1: ' '{\n// dt\n"dt": 1}'
json 'unknown key with its path' '$.cloths[0].start: unknown key "att"' \
    '{"cloths": [{"start": {"att": 1}}]}'
json 'and the one that is meant' \
    '$.cloths[0].start: unknown key "att"; did you mean "at"?' \
    '{"cloths": [{"start": {"att": 1}}]}'
json 'key of line ends' '$: unknown key "a?b"' '{"a\\nb": 1}'
deep=$(awk 'BEGIN { for (k = 0; k < 100000; k++) printf "[" }')
json 'nested deeply' 'line 1, column 2059: maximum parsing depth' "{\"cloths\": $deep"
json 'list in a list' '$.cloths[0]: expected an object' '{"cloths": [[]]}'
json 'key twice, where both are right' 'line 1, column 29: duplicate object key' \
    '{"dt": 0.1, "frames": 1, "dt": 0.1}'

# Cloths
# sheet TEXT: a cloth of 21 × 11 particles, 1 m × 0.5 m, with these keys.
sheet() {
    cat >sheet.json <<EOT
{"frames": 1, "cloths": [{"particles": [2, 2]},
 {"particles": [21, 11], "size": [1, 0.5], "start": {"at": [0, 2, 0]}, $1}]}
EOT
}
sheet '"holes": [{"rect": [0, 0, 5, 5]}]'
refused 'nothing but holes' '$.cloths[1]: holes and cuts leave no cell' \
    run sheet.json --out refused
sheet '"cuts": [{"rect": [0, 0, 5, 5]}]'
refused 'nothing but cuts' '$.cloths[1]: holes and cuts leave no cell' \
    run sheet.json --out refused
sheet '"holes": [{"disc": [0.5, 0.25, 0.1]}, {"disc": [0.525, 0.275, 0.02]}]'
refused 'a hole between particles' \
    '$.cloths[1]: holes[1] takes nothing away: it holds no particle' \
    run sheet.json --out refused
sheet '"cuts": [{"rect": [0.98, 0.4, 2, 0.6]}]'
refused 'a cut beside the cloth' \
    '$.cloths[1]: cuts[0] takes nothing away: it holds no middle of a cell' \
    run sheet.json --out refused
held='"pins": [{"at": [0.5, 0.25]}, {"edge": "v0"}]'
missing='$.cloths[1].pins[1]: particle (0, 0) is missing'
sheet "$held"
exits 'an edge that is there is pinned' 0 plan sheet.json
sheet "$held, \"cuts\": [{\"rect\": [0, 0, 0.05, 0.05]}]"
refused 'pin on a particle whose cell is cut' "$missing" plan sheet.json
sheet "$held, \"holes\": [{\"disc\": [0, 0, 0.01]}]"
refused 'pin on a hole' "$missing" plan sheet.json
sheet "$held, \"holes\": [{\"disc\": [0.5, 0.25, 0.01]}]"
refused 'pin at a hole' '$.cloths[1].pins[0]: particle (10, 5)' plan sheet.json
sheet '"pins": [{"at": [0, 0]}, {"at": [1.03, 0]}]'
refused 'pin beside the cloth' '$.cloths[1].pins[1].at: [1.03, 0]: expected' \
    plan sheet.json
sheet '"pins": [{"at": [1e6, 1e6]}]'
refused 'pin far from the cloth' '$.cloths[1].pins[0].at:' plan sheet.json
sheet '"pins": [{"edge": "u0", "every": 1e6}]'
exits 'pins further apart than can be counted' 0 plan sheet.json
for every in 1 1e6; do
    cat >every.json <<EOT
{"frames": 2, "dt": 1e-4, "cloths": [{"particles": [21, 21],
 "size": [0.008, 0.008], "pins": [{"edge": "u0", "every": $every}]}]}
EOT
    exits "pins $every m apart" 0 run every.json --out "every $every"
done
is 'are those of both ends' cmp 'every 1/cloth.pc2' 'every 1e6/cloth.pc2'
sheet '"particles": [11, 11]'
refused 'key twice in a cloth' 'sheet.json: line 2, column 82: duplicate object key' \
    plan sheet.json
sheet '"material": {"thickness": 1e-3, "shear": 400}, "cuts": []'
sed 's/0.5\]/0.3]/' sheet.json >oblong.json
refused 'oblong cells, and which are not' '$.cloths[1]: cells of 0.05 by 0.03' \
    plan oblong.json
is 'the ratio is said' grep -q 'sqrt(stretch / shear) = 1.581$' err
sed 's/0.5\]/0.32]/' sheet.json >oblong.json
exits 'a ratio of 1.5625' 0 plan oblong.json
cloth='{"particles": [900, 900]}'
echo "{\"memory\": 1, \"cloths\": [$cloth, $cloth, $cloth]}" >three.json
refused 'three cloths, of which two fit' '$.cloths[2]: particles: 2430000' \
    plan three.json

# The report of a run, as render reads it
exits 'a run to look at' 0 run tiny.json --frames 0 --out seen
cp seen/report.json seen.json
is 'what may stand in a report, and what not' python3 "$root/tests/app/seen.py" \
    "$drape" seen
# seen NAME PLACE FROM TO: its report has TO for FROM.
seen() {
    sed "s/$3/$4/" seen.json >seen/report.json
    refused "report, $1" "$2: expected" render seen --frame 0 --width 16 \
        --height 16
}
seen 'vertex before the first' '$.bodies[0]' 'vertex": 0' 'vertex": -9999999'
seen 'vertex beyond all' '$.bodies[0]' 'vertex": 0' 'vertex": 1e300'
seen 'one column' '$.bodies[0]' '\[9, 9\]' '[1, 9]'
seen 'no grid' '$.bodies[0]' '\[9, 9\]' '[]'
seen 'columns of text' '$.bodies[0]' '\[9, 9\]' '["9", 9]'
seen 'a camera beyond all' '$.camera' '"dt"' \
    '"camera": {"eye": [1e308, 0, 0], "target": [0, 0, 0], "fov": 35}, "dt"'
ply seen/frames/cloth_0000.ply '3 0 1 2' '^0 1 0$' '0 1e15 0'
cp seen.json seen/report.json
refused 'a frame too large for a picture' 'seen: frame 0: expected coordinates' \
    render seen --frame 0 --width 16 --height 16
seen 'no time' '$.dt' '"dt": [^,]*' '"dt": 0'

# Rows of drape ccd
# rows FILE ROW COUNT
rows() {
    awk -v row="$2" -v n="$3" 'BEGIN { while (n--) print row }' >"$1"
}
zeros=0,1,0,1,0,1
rows at.csv $zeros 8
sed 's/$/\r/' at.csv >crlf.csv
exits 'eight times the same point, CRLF' 0 ccd --kind ee crlf.csv
is 'touch from the start' test "$(cat out)" = '1 0'
# A power of two with a denominator that brings it back.
two=$(python3 -c 'print(2**1100)')
rows pow.csv "$two,$two,0,1,0,1" 8
exits 'numerators beyond binary64' 0 ccd --kind vf pow.csv
is 'whose quotient is not' test "$(cat out)" = '1 0'
# refused_row NAME TEXT ROW
refused_row() {
    rows row.csv "$3" 8
    refused "ccd, $1" "row.csv: line 1: expected $2" ccd --kind vf row.csv
}
refused_row 'five columns' '6 or 7 columns' 0,1,0,1,0
refused_row 'a header' 'whole numbers' xn,xd,yn,yd,zn,zd
refused_row 'no binary64' 'quotients that are binary64' \
    1152921504606846977,1,0,1,0,1
refused_row 'a quotient too large' 'finite quotients' "$two,1,0,1,0,1"
refused_row 'a quotient too small' 'quotients that are binary64' \
    "1,$two,0,1,0,1"
{
    printf '\357\273\277'
    cat at.csv
} >bom.csv
refused 'ccd, a mark of byte order' 'line 1: expected whole numbers' \
    ccd --kind vf bom.csv
rows seven.csv $zeros 7
refused 'ccd, seven rows' 'line 7: expected 8 rows' ccd --kind vf seven.csv

# All of these files, damaged
mkdir damaged
ply turn_0.ply '3 0 1 2'
cp good.dae good.gltf good.off back.obj turn_0.ply damaged
exits 'binary PLY' 0 convert turn_0.ply damaged/binary.ply
printf 'solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0
vertex 0 1 0\nendloop\nendfacet\nendsolid a\n' >damaged/good.stl
cp sheet.json damaged/scene.json
cp at.csv damaged/at.csv
line=$(python3 "$root/tests/damage.py" "$drape" damaged | tail -n 1)
is "damaged files ($line)" test "${line#* }" = 'files, 0 wrong'

# The child that reads a mesh dies after it has sent a part of it: the tool is
# stopped meanwhile, so that the child waits at the full pipe.
awk 'BEGIN {
    for (k = 1; k < 60000; k++)
        printf "v %d 0 0\nv %d 1 0\nv %d 0 1\nf -1 -2 -3\n", k, k, k
}' >sent.obj
"$drape" convert sent.obj sent.ply >out 2>err &
tool=$! reader= waits=0
while [ -z "$reader" ] && kill -0 $tool 2>/dev/null; do
    reader=$(tr -d ' ' <"/proc/$tool/task/$tool/children")
done 2>/dev/null
if [ -n "$reader" ]; then
    kill -STOP $tool
    while [ $waits -lt 3 ]; do
        sleep 0.2
        case $(cut -d ' ' -f 3 "/proc/$reader/stat") in
        S) waits=$((waits + 1)) ;;
        *) waits=0 ;;
        esac
    done
    cat "/proc/$reader/limits" >limits
    for k in 0 1 2; do
        readlink "/proc/$reader/fd/$k"
    done >streams
    held=$(awk '$1 == "VmPeak:" { print $2 }' "/proc/$tool/status")
    kill -9 "$reader"
    kill -CONT $tool
    wait $tool
    is 'a reader that dies while it sends' test $? -eq 2 -a ! -e sent.ply
    is 'is said to have died' grep -q 'sent.obj: .* crashed (signal 9' err
    # its memory comes on top of what the tool holds
    is 'had the limits that the manual states' awk -v size="$(wc -c <sent.obj)" \
        -v held="$held" '
        /^Max cpu time/ { cpu = $4 == int(10 + 1e-5 * size) && $5 == $4 + 1 }
        /^Max core file size/ { core = $5 == 0 && $6 == 0 }
        /^Max address space/ { more = $4 - 1e9 - 100 * size
            room = $4 == $5 && 512 * held < more && more <= 1024 * held }
        END { exit !(cpu && core && room) }' limits
    is 'and could say nothing to anybody' test \
        "$(uniq -c streams | tr -s ' ')" = ' 3 /dev/null'
else
    wait $tool
    skip 'a reader that dies while it sends: its number is not known here'
fi
